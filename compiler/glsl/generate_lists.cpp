// Embedded objects as GLSL: a run of candidates is one loop, with one call for each different shape.
#include "compiler/glsl/generator.h"

namespace dmvv::compiler {

void Generator::emit_candidates(Id<Region> id, bool one_region, const Continuation& continued) {
  const Region& region = at(module_.regions, id);
  for (std::size_t g = continued.first; g < region.groups.size(); ++g) {
    const CandidateGroup& group = region.groups[g];
    const std::uint32_t record = records_.regions[id.index].first_group + static_cast<std::uint32_t>(g);
    line("// {}: {} candidates", region.name, fmt::format("{}", group.candidates.size()));
    const std::string here = guarded(one_region ? "" : fmt::format("region == {}u", id.index));
    const std::string nobody_yet = g == continued.first ? "" : nobody();  // nobody is asked once there is an answer
    const std::string asked = here.empty() || nobody_yet.empty() ? here + nobody_yet : here + " && " + nobody_yet;
    if (group.candidates.size() == 1) {
      emit_one_candidate(id, group, asked, g + 1 == region.groups.size() ? continued.last : "");
    } else {
      emit_group(id, g, records_.groups[record], asked, continued.stage_of(stages_, g));
    }
  }
}

void Generator::emit_group(Id<Region> region, std::size_t g, const gpu::GroupRecord& record, const std::string& asked,
                           std::optional<std::uint32_t> later) {
  const CandidateGroup& group = at(module_.regions, region).groups[g];
  open(asked.empty() ? "" : fmt::format("if ({})", asked));
  if (group.box_from_object) {
    line("vec3 b = {};", affine_expression(*group.box_from_object, "p", options_.fold_affine));
    if (reaches() && !cube_maps_into(*group.box_from_object, {})) line("{};", limit_group_box(*group.box_from_object));
    open("if (in_cube(b))");
  }
  emit_candidate_loop(region, g, record, later);
  if (group.box_from_object) close();
  close();
}

std::string Generator::limit_group_box(const Affine& box_from_object) const {
  return fmt::format("limit_cube(b, {}, {})", bound(largest_stretch(box_from_object.linear)),
                     bound(2.0 * rounding_of(box_from_object)));
}

void Generator::emit_one_candidate(Id<Region> region, const CandidateGroup& group, const std::string& asked,
                                   const std::string& called) {
  const Candidate& candidate = group.candidates.front();
  const LocalBox& content = at(module_.objects, candidate.object).content;
  open("");
  std::string enter = asked;
  const auto also = [&](const std::string& condition) { enter += (enter.empty() ? "" : " && ") + condition; };
  const auto asked_here = [&] { return enter.empty() ? std::string("true") : enter; };
  if (group.box_from_object) {
    line("vec3 b = {};", affine_expression(*group.box_from_object, "p", options_.fold_affine));
    if (reaches() && !cube_maps_into(*group.box_from_object, {}))
      line("if ({}) {};", asked_here(), limit_group_box(*group.box_from_object));
    also("in_cube(b)");
  }
  // What is asked wherever its parent is, ends with it.
  const bool has_walls = !candidate.tiled && !cube_maps_into(candidate.local_from_parent, content);
  const std::string q = affine_expression(candidate.local_from_parent, "p", options_.fold_affine);
  line(candidate.tiled ? "vec3 q = wrap_cube({});" : "vec3 q = {};", q);
  if (reaches()) {
    line("Local outer = local;");
    line("local = {};", scaled_frame(candidate.local_from_parent));
    if (candidate.tiled) line("if ({}) limit_tile(q);", asked_here());
    if (has_walls)
      line("if (({}) && !{}) {};", asked_here(), box_test(content, "q"), limit_box(content, "q", 1.0, 0.0));
  }
  if (!candidate.tiled) also(box_test(content, "q"));
  line("bool enter = {};", asked_here());
  const std::string answered = asks_whether_ ? "occupied" : "hit_number != 0u";
  if (asks_whether_) {
    line("bool found = {}(q, enter);", occupied_name(candidate.object));
    line("occupied = occupied || found;");
  } else {
    line("{};",
         called.empty() ? call(candidate.object, "q", "level + 1u", "enter") : called + "(q, level + 1u, enter)");
  }
  if (reaches()) {
    if (has_walls) line("if (enter && {}) {};", answered, limit_box(content, "q", 1.0, 0.0));
    line("local = outer;");
  }
  if (!asks_whether_)
    line("if (enter && hit_number != 0u) came_through({}u, {}u, level);", fmt::format("{}", region.index),
         fmt::format("{}", group.first_number));
  close();
}

Generator::CubeTest Generator::cube_test(const std::set<Id<Object>>& objects, const std::string& tags) const {
  const LocalBox& first = at(module_.objects, *objects.begin()).content;
  const bool alike =
      std::ranges::all_of(objects, [&](Id<Object> object) { return at(module_.objects, object).content == first; });
  if (alike) return {box_test(first, "q"), limit_box(first, "q", 1.0, 0.0)};
  const std::string extent = fmt::format("extent_of({}.z)", tags);
  return {fmt::format("in_extent(q, {})", extent), fmt::format("limit_box(q, -{0}, {0}, 1.0, 0.0)", extent)};
}

void Generator::emit_candidate_loop(Id<Region> region, std::size_t g, const gpu::GroupRecord& record,
                                    std::optional<std::uint32_t> later) {
  const CandidateGroup& group = at(module_.regions, region).groups[g];
  out_.uses.placements = true;
  const bool any_tiled = std::any_of(group.candidates.begin(), group.candidates.end(),
                                     [](const Candidate& candidate) { return candidate.tiled; });
  if (reaches()) line("Local outer = local;");
  if (reaches() && group.box_from_object) line("local = {};", scaled_frame(*group.box_from_object));
  if (asks_whether_) line("const uint level = 0u;");
  emit_range(record.lookup, group.box_from_object ? "b" : "p");
  Placements candidates;
  std::set<Id<Object>> objects;
  for (const Candidate& candidate : group.candidates) {
    candidates.add(candidate.local_from_parent);
    objects.insert(candidate.object);
  }
  CubeTest cube = cube_test(objects, fmt::format("placement_tags({}u + c)", record.first_placement));
  line("uint i = range.x;");
  line("uint asked = 0u;");
  line("uint c = 0u;");
  line("vec3 q = p;");
  if (later) {
    line("bool held = false;");
    emit_search(record, any_tiled, candidates, cube);
    line("if (held) next_stage = {}u;", fmt::format("{}", *later));
    line("hit_unfinished = hit_unfinished || (!held && asked != range.y - range.x);");
    return;
  }
  const Calls calls = calls_of(plan_.calls[region.index][g], record);
  const auto emit_way = [&](const std::string& condition) {
    if (reaches()) line("{}{};", condition, cube.limit);
    if (asks_whether_) return;
    line("{}came_through({}u, {}, level);", condition, fmt::format("{}", region.index),
         group.first_number == 0 ? std::string("c") : fmt::format("{}u + c", group.first_number));
  };
  std::string nobody_yet = calls.answers_at_once() ? "hit_number == 0u" : "";
  if (calls.sinks()) nobody_yet += nobody_yet.empty() ? "!found" : " && !found";
  if (calls.sinks()) line("bool found = false;");
  open("while (i < range.y && " + nobody_yet + ")");
  line("bool held = false;");
  emit_search(record, any_tiled, candidates, cube);
  open("if (held)");
  emit_calls(calls, false);
  if (calls.answers_at_once()) emit_way("if (hit_number != 0u) ");
  close();
  close();
  line("hit_unfinished = hit_unfinished || (" + nobody_yet + " && asked != range.y - range.x);");
  if (calls.sinks()) {
    open("if (found)");
    if (!asks_whether_) emit_calls(calls, true);
    emit_way("");
    close();
  }
  if (asks_whether_ && calls.sinks()) line("occupied = occupied || found;");
  if (asks_whether_ && calls.answers_at_once()) line("occupied = occupied || hit_number != 0u;");
  if (reaches()) line("local = outer;");
}

void Generator::emit_search(const gpu::GroupRecord& record, bool any_tiled, const Placements& candidates,
                            const CubeTest& cube) {
  const std::string placement = fmt::format("{}u + c", record.first_placement);
  open("for (; i < range.y && !held; ++i)");
  line("++asked;");
  line("c = list_at(i);");
  line("q = apply(placement_affine({}), p);", placement);
  if (any_tiled) line("bool tiled = placement_tags({}).y != 0u;", placement);
  if (any_tiled) line("if (tiled) q = wrap_cube(q);");
  line(any_tiled ? "held = tiled || {};" : "held = {};", cube.holds);
  if (reaches()) {
    line("local = {};", candidates.frame("placement_affine(" + placement + ")"));
    if (any_tiled) line("if (tiled) limit_tile(q);");
    line("if (!held) {};", cube.limit);
  }
  close();
}

Generator::Calls Generator::calls_of(const std::vector<Id<Object>>& called, const gpu::GroupRecord& record) {
  Calls result{.placement = fmt::format("{}u + c", record.first_placement)};
  for (const Id<Object> object : called) out_.listed.emplace(object, sinks(object));
  for (const std::vector<Id<Object>>& alike : shapes_of(called)) {
    const Id<Object> first = alike.front();
    if (plan_.cut[first.index]) {
      result.walked = first;
      continue;
    }
    const std::string guard = !sinks(first) && guarded_[first.index] ? ", true" : "";
    if (alike.size() == 1) {
      result.by_object = true;
      result.calls.push_back(
          {fmt::format("object == {}u", first.index), listed_name(first) + "(q, level + 1u", guard, sinks(first)});
    } else {
      result.by_family = true;
      const std::uint32_t family = unite(alike);
      result.calls.push_back({fmt::format("family == {}u", family), united_names_[family - 1] + "(row, q, level + 1u",
                              guard, sinks(first)});
    }
  }
  return result;
}

void Generator::emit_calls(const Calls& calls, bool inside) {
  if (calls.by_family) {
    line("uint united = placement_tags({}).w;", calls.placement);
    line("uint row = united >> DMVV_FAMILY_BITS;");
  }
  if (calls.chooses() && calls.by_family) line("uint family = united & (1u << DMVV_FAMILY_BITS) - 1u;");
  if (calls.by_object ? calls.chooses() : calls.walked.has_value())
    line("uint object = placement_tags({}).x;", calls.placement);
  std::string others;  // holds for no object that has a call of its own
  // One after the other, not nested in each other's else.
  for (const Calls::Call& call : calls.calls) {
    const std::string made = call.sinks ? fmt::format("{}{}, {})", inside ? "" : "found = ", call.called, inside)
                                        : call.called + call.guard + ")";
    if (call.sinks || !inside) line("{}{};", calls.chooses() ? fmt::format("if ({}) ", call.condition) : "", made);
    others += fmt::format("{}!({})", others.empty() ? "" : " && ", call.condition);
  }
  if (calls.walked && !inside)
    line("{}walk(object, q, level + 1u);", others.empty() ? "" : fmt::format("if ({}) ", others));
}

std::vector<std::vector<Id<Object>>> Generator::shapes_of(const std::vector<Id<Object>>& called) {
  std::vector<std::vector<Id<Object>>> shapes;
  std::map<std::uint64_t, std::size_t> places;
  for (const Id<Object> object : called) {
    std::uint64_t shape = std::uint64_t{object.index} << 32;
    if (plan_.cut[object.index])
      shape = ~std::uint64_t{0};
    else if (options_.unite_shapes)
      shape = families_.shape(listed_name(object));
    const auto [place, is_new] = places.try_emplace(shape, shapes.size());
    if (is_new) shapes.emplace_back();
    shapes[place->second].push_back(object);
  }
  return shapes;
}

std::uint32_t Generator::unite(const std::vector<Id<Object>>& alike) {
  std::vector<std::string> names;
  for (const Id<Object> object : alike) names.push_back(listed_name(object));
  const std::string name = families_.unite(names);
  const auto known = std::ranges::find(united_names_, name);
  const auto family = static_cast<std::uint32_t>(known - united_names_.begin()) + 1;
  if (known == united_names_.end()) united_names_.push_back(name);
  for (const Id<Object> object : alike) united_objects_.emplace(object, family);
  return family;
}

}  // namespace dmvv::compiler
