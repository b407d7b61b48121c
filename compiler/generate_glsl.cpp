#include "compiler/generate_glsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <optional>
#include <set>

#include "compiler/code_plan.h"
#include "compiler/families.h"
#include "compiler/glsl_text.h"
#include "compiler/stage_plan.h"

namespace dmvv::compiler {

bool cube_maps_into(const Affine& affine, const LocalBox& box) {
  const glm::dvec3 half = glm::abs(affine.linear[0]) + glm::abs(affine.linear[1]) + glm::abs(affine.linear[2]);
  const bool exact = affine == Affine{};  // the identity is not even computed
  const glm::dvec3 reach = half + (exact ? glm::dvec3(0.0) : float_error(affine, glm::dvec3(1.0)));
  return glm::all(glm::greaterThanEqual(affine.translation - reach, box.lo)) &&
         glm::all(glm::lessThanEqual(affine.translation + reach, box.hi));
}

namespace {

constexpr std::uint32_t nesting_of_tape_walker = 3;

constexpr std::size_t most_constant_regions = 24;
constexpr std::uint32_t lines_of_trilinear = 16;  // of a filter in the shader, in place of one texture lookup
constexpr std::uint32_t lines_of_tricubic = 90;

/// How groups are written that stages divide.
struct Continuation {
  std::size_t first = 0;   ///< the groups before it have been asked
  bool asks_first = true;  ///< in this stage
  const Way* way = nullptr;
  std::string last;        ///< what is called for the last group's one candidate; "": its usual function
  std::optional<std::uint32_t> stage_of(const StagePlan& plan, std::size_t group) const {
    return way == nullptr || (asks_first && group == first) ? std::nullopt : plan.stage_at(*way, group);
  }
};

class Generator : GlslWriter {
 public:
  Generator(const Module& module, const Records& records, const Atlas& grid_atlas, const GlslOptions& options)
      : module_(module), records_(records), grid_atlas_(grid_atlas), options_(options) {}

  Evaluation run() {
    measure_sources();
    find_guarded();
    std::vector<Id<Object>> alike = each_by_itself();
    if (options_.unite_shapes) {  // objects of one shape count once; writing them tells which they are
      write(plan_code(module_, sizes_, alike, {Codegen::specialised, no_budget, {}}));
      alike = by_shape();
    }
    write(plan_code(module_, sizes_, alike, {options_.codegen, options_.inlined_line_budget, options_.costs}));
    emit_stages();
    return finish();
  }

 private:
  static constexpr std::uint32_t no_budget = ~0u;

  /// The functions of the scene, as the plan says.
  void write(CodePlan plan) {
    plan_ = std::move(plan);
    out_ = {};
    out_.uses.reach = reaches();
    out_.codegen = options_.codegen;
    out_.filter = grid_atlas_.filter;
    families_ = {};
    united_names_.clear();
    united_objects_.clear();
    emitted_.clear();
    emit_functions();
    if (plan_.walks()) use_walker();
    // Objects stand parents first; GLSL wants callees first.
    for (std::size_t i = module_.objects.size(); i-- > 0;) {
      if (plan_.needed[i] && !plan_.cut[i]) emit_object(Id<Object>{static_cast<std::uint32_t>(i)});
    }
    emit_colors();
    if (reaches()) emit_bitmap_test();
    line("void evaluate(vec3 p) { {}; }", call(module_.root, "p", "0u"));
    add("evaluate");
  }

  /// What a kernel calls, and before it the root object with all that it calls.
  std::vector<std::string> scene_functions() const {
    std::vector<std::string> names{"color_of", "evaluate"};
    if (reaches()) names.emplace_back("has_bitmap");
    if (!plan_.cut[module_.root.index]) names.insert(names.begin(), object_name(module_.root));
    return names;
  }

  Evaluation finish() {
    families_.settle();
    out_.united_functions = static_cast<std::uint32_t>(united_names_.size());
    out_.parameters = families_.parameters();
    out_.uses.parameters = !out_.parameters.empty();
    for (const auto& [object, family] : united_objects_) {
      out_.united.emplace(object, families_.row(listed_name(object)) << DMVV_FAMILY_BITS | family);
    }
    out_.uses.tapes = !tape_walker_.empty();
    out_.functions = tape_walker_;
    if (plan_.walks()) out_.functions += families_.take(walker_functions());
    for (std::uint32_t i = 0; i < out_.stages.size(); ++i) {
      std::string text = families_.copy({"color_of", stage_name(i)});
      const bool has_next = text.find("next_stage = ") != std::string::npos;
      out_.stages[i] = {std::move(text), has_next};
    }
    out_.glsl = families_.take(scene_functions());
    out_.inlined_lines = plan_.inlined_lines;
    out_.object_codegen = std::move(plan_.object_codegen);
    return std::move(out_);
  }

  /// What was written since the last time, as a function.
  void add(const std::string& name) { families_.add(name, take()); }

  // ---- snippets ----

  std::string function_name(Id<Function> id) const { return fmt::format("function_{}", id.index); }

  bool is_tape(Id<Function> id) const { return !tape_walker_.empty() && options_.tapes->functions[id.index].is_tape; }

  void measure_sources() {
    if (options_.tapes != nullptr && options_.tapes->any()) tape_walker_ = tape_walker(*options_.tapes);
    for (std::uint32_t i = 0; i < module_.functions.size(); ++i) {
      const snippet::Snippet& snippet = module_.functions[i].snippet;
      sizes_.function_lines.push_back(code_lines(is_tape({i}) ? tape_walker_ : snippet.glsl("f", 0)));
      sizes_.function_nesting = std::max(sizes_.function_nesting, is_tape({i}) ? nesting_of_tape_walker : snippet.nesting());
    }
    sizes_.filter_lines = filter_lines();
  }

  void emit_functions() {
    std::size_t next_time_value = 0;
    for (std::uint32_t i = 0; i < module_.functions.size(); ++i) {
      const Function& function = module_.functions[i];
      const std::string name = function_name({i});
      const std::string text = is_tape({i}) ? tape_call(name, options_.tapes->functions[i], next_time_value)
                                            : function.snippet.glsl(name, next_time_value);
      families_.add(name, fmt::format("// {}\n{}\n", function.name, text));
      const std::size_t values = function.snippet.time_value_count();
      if (values == 0) continue;
      out_.time_functions.push_back({function.snippet, next_time_value});
      next_time_value += values;
    }
    out_.uses.time = next_time_value != 0;
  }

  void use_walker() {
    out_.uses.walker = out_.uses.placements = out_.uses.lists = true;
    out_.uses.grid_atlas = !module_.grids.empty();
    if (!module_.functions.empty()) emit_function_switch();
  }

  /// What the walker calls.
  std::vector<std::string> walker_functions() const {
    return module_.functions.empty() ? std::vector<std::string>{} : std::vector<std::string>{"call_function"};
  }

  /// The thesis' stitching: one function that the walker calls with the number of a snippet.
  void emit_function_switch() {
    open("float call_function(uint function, vec3 q)");
    line("float value = 0.0;");
    emit_function_choice(0, static_cast<std::uint32_t>(module_.functions.size()));
    line("return value;");
    close();
    line("");
    add("call_function");
  }

  /// By halves: drivers make nested conditions of a switch, as many as it has cases.
  void emit_function_choice(std::uint32_t first, std::uint32_t end) {
    if (end - first == 1) {
      line("value = {}(q);", function_name({first}));
      return;
    }
    const std::uint32_t middle = first + (end - first) / 2;
    open(fmt::format("if (function < {}u)", middle));
    emit_function_choice(first, middle);
    otherwise();
    emit_function_choice(middle, end);
    close();
  }

  std::uint32_t filter_lines() const {
    if (module_.grids.empty() || grid_atlas_.filter == Filter::hardware) return 0;
    return grid_atlas_.filter == Filter::shader ? lines_of_trilinear : lines_of_tricubic;
  }

  // ---- what calls what ----

  std::vector<Id<Object>> each_by_itself() const {
    std::vector<Id<Object>> objects(module_.objects.size());
    for (std::uint32_t i = 0; i < objects.size(); ++i) objects[i] = {i};
    return objects;
  }

  /// Of each object the first one of its shape, among those that are written.
  std::vector<Id<Object>> by_shape() const {
    std::vector<Id<Object>> objects = each_by_itself();
    std::map<std::uint32_t, Id<Object>> first;
    for (Id<Object>& object : objects) {
      if (families_.knows(object_name(object))) {
        object = first.try_emplace(families_.shape(object_name(object)), object).first->second;
      }
    }
    return objects;
  }

  /// A group of one candidate calls its object unconditionally, with a guard: so embedding does not nest.
  void find_guarded() {
    guarded_.assign(module_.objects.size(), false);
    for (const Region& region : module_.regions) {
      for (const CandidateGroup& group : region.groups) {
        if (group.candidates.size() == 1) guarded_[group.candidates.front().object.index] = true;
      }
    }
  }

  // ---- distance functions ----

  std::string sdf_name(Id<Sdf> id) const { return fmt::format("negative_{}", id.index); }

  /// `f(local) <= iso` as one expression, the local point being q, or constant(q) if that is given.
  std::string source_test(Id<Sdf> id, const Affine* constant, const std::string& q) {
    const Sdf& sdf = at(module_.sdfs, id);
    if (const auto* function = std::get_if<Id<Function>>(&sdf.source)) {
      const std::string local = constant ? affine_expression(*constant, q, options_.fold_affine) : q;
      return comparison(id, fmt::format("{}({})", function_name(*function), local), 1.0, constant);
    }
    const auto grid_id = std::get<Id<voml::Grid>>(sdf.source);
    const voml::Grid& grid = at(module_.grids, grid_id);
    out_.uses.grid_atlas = true;
    const Affine atlas = lookup_from_local(grid, grid_id, grid_atlas_);
    const std::string at = affine_expression(constant ? atlas * *constant : atlas, q, options_.fold_affine);
    const std::string value = grid_atlas_.filter == Filter::hardware ? fmt::format("textureLod(grid_atlas, {}, 0.0).r", at)
                                                                     : fmt::format("sample_grid({})", at);
    return comparison(id, value, grid_atlas_.scales[grid_id.index], constant);
  }

  /// `value <= iso`, the value being that of the source over `scale`.
  std::string comparison(Id<Sdf> id, const std::string& value, double scale, const Affine* constant) const {
    const std::string iso = glsl_float(static_cast<float>(at(module_.sdfs, id).iso / scale));
    if (!reaches()) return fmt::format("{} <= {}", value, iso);
    snippet::Steepness source = (*options_.steepness)[id.index];
    if (constant != nullptr) {
      source.error += source.slope * rounding_of(*constant);
      source.slope *= largest_stretch(constant->linear);
    }
    // Both points that are compared are off.
    return fmt::format("below({}, {}, {}, {})", value, iso, bound(source.slope / scale), bound(2.0 * source.error / scale));
  }

  // ---- how far answers hold (shaders/reach.glsl) ----

  bool reaches() const { return options_.steepness != nullptr && !stage_; }

  /// A literal; what is infinite, or nearly, as a number that leaves no reach.
  static std::string bound(double value) {
    return glsl_float(value < 1e30 ? static_cast<float>(value) : 1e30f);
  }

  /// How far off a point of the standard cube is after the map, in units of its result.
  static double rounding_of(const Affine& affine) { return glm::length(float_error(affine, glm::dvec3(1.0))); }

  /// Of a point that `affine` took into a frame: the factor and the error of steps.
  static std::string scaled_frame(const Affine& affine) {
    const double stretch = largest_stretch(affine.linear);
    return fmt::format("scaled(outer, {}, {})", bound(stretch), bound(rounding_of(affine) / stretch));
  }

  /// Of placements that are read from records: what their frames have in common.
  struct Placements {
    double skew = 1.0;   ///< the largest stretch over the longest row
    double error = 0.0;  ///< of a point, as a step in the outer frame
    void add(const Affine& affine) {
      const glm::dmat3 rows = glm::transpose(affine.linear);
      const double longest = std::max({glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2])});
      const double stretch = largest_stretch(affine.linear);
      skew = std::max(skew, stretch / longest);
      error = std::max(error, rounding_of(affine) / stretch);
    }
    std::string frame(const std::string& affine) const {
      return fmt::format("placed(outer, {}, {}, {})", affine, bound(skew), bound(error));
    }
  };

  std::string limit_box(const LocalBox& box, const std::string& q, double slope, double error) const {
    if (box.lo == glm::dvec3(-1.0) && box.hi == glm::dvec3(1.0)) {
      return fmt::format("limit_cube({}, {}, {})", q, bound(slope), bound(error));
    }
    return fmt::format("limit_box({}, {}, {}, {}, {})", q, vec3_literal(box.lo), vec3_literal(box.hi), bound(slope), bound(error));
  }

  void emit_bitmap_test() {
    open("bool has_bitmap(uint region)");
    std::string test = "false";
    for (std::size_t i = 0; i < module_.regions.size(); ++i) {
      if (module_.regions[i].kind == voml::RegionKind::bitmap) test += fmt::format(" || region == {}u", i);
    }
    line("return {};", test);
    close();
    line("");
    add("has_bitmap");
  }

  std::string box_test(const LocalBox& box, const std::string& q) const {
    if (box.lo == glm::dvec3(-1.0) && box.hi == glm::dvec3(1.0)) return fmt::format("in_cube({})", q);
    return fmt::format("in_box({}, {}, {})", q, vec3_literal(box.lo), vec3_literal(box.hi));
  }

  void emit_sdf(Id<Sdf> id) {
    if (!emitted_.insert(id).second) return;
    const Sdf& sdf = at(module_.sdfs, id);
    line("// {}", sdf.name);
    open(fmt::format("bool {}(vec3 p)", sdf_name(id)));
    switch (sdf.placement) {
      case voml::Placement::single: emit_single(id, sdf); break;
      case voml::Placement::tiled: emit_tiled(id, sdf); break;
      case voml::Placement::seeded: emit_seeded(id, sdf); break;
    }
    close();
    line("");
    add(sdf_name(id));
  }

  void emit_single(Id<Sdf> id, const Sdf& sdf) {
    const Affine& affine = sdf.local_from_object.front();
    const LocalBox box = local_box(sdf, module_);
    if (options_.box_tests && cube_maps_into(affine, box)) {
      line("return {};", source_test(id, &affine, "p"));
      return;
    }
    line("vec3 q = {};", affine_expression(affine, "p", options_.fold_affine));
    if (!reaches()) {
      line("return {} && {};", box_test(box, "q"), source_test(id, nullptr, "q"));
      return;
    }
    line("Local outer = local;");
    line("local = {};", scaled_frame(affine));
    emit_boxed_test("bool negative = ", box, id);
    line("local = outer;");
    line("return negative;");
  }

  /// Whether q lies in the box and is negative. Outside of it nothing is, so a positive point may cross its walls.
  void emit_boxed_test(const std::string& result, const LocalBox& box, Id<Sdf> id) {
    if (!reaches()) return line("{}{} && {};", result, box_test(box, "q"), source_test(id, nullptr, "q"));
    line("bool inside = {};", box_test(box, "q"));
    line("{}inside && {};", result, source_test(id, nullptr, "q"));
    line("if (inside == negative) {};", limit_box(box, "q", 1.0, 0.0));
  }

  void emit_tiled(Id<Sdf> id, const Sdf& sdf) {
    line("vec3 q = wrap_cube({});", affine_expression(sdf.local_from_object.front(), "p", options_.fold_affine));
    if (reaches()) line("limit(0.0, 1.0);");
    line("return {} && {};", box_test(local_box(sdf, module_), "q"), source_test(id, nullptr, "q"));
  }

  /// Three, even if they are equal: the shape does not depend on the values.
  static std::string components(const glm::vec4& v) {
    return fmt::format("vec3({}, {}, {})", glsl_float(v.x), glsl_float(v.y), glsl_float(v.z));
  }

  std::string find_cell(const gpu::LookupRecord& lookup, const std::string& p) {
    out_.uses.lists = true;
    return fmt::format("find_cell({}, {}, {}, uvec3({}u, {}u, {}u), {}u)", p, components(lookup.lo),
                       components(lookup.cells_per_unit), lookup.size_x, lookup.size_y, lookup.size_z,
                       lookup.first_cell);
  }

  /// The range of p's cell in the lists.
  void emit_range(const gpu::LookupRecord& lookup, const std::string& p) {
    line("uvec2 range = {};", find_cell(lookup, p));
    if (!reaches()) return;
    line("limit_cell({}, {}, {}, uvec3({}u, {}u, {}u));", p, components(lookup.lo), components(lookup.cells_per_unit),
         fmt::format("{}", lookup.size_x), fmt::format("{}", lookup.size_y), fmt::format("{}", lookup.size_z));
  }

  void emit_seeded(Id<Sdf> id, const Sdf& sdf) {
    const gpu::SdfRecord& record = records_.sdfs[id.index];
    emit_range(record.lookup, "p");
    line("uint asked = 0u;");
    line("bool negative = false;");
    if (reaches()) line("Local outer = local;");
    open("for (uint i = range.x; i < range.y && !negative; ++i)");
    line("++asked;");
    Placements seeds;
    for (const Affine& affine : sdf.local_from_object) seeds.add(affine);
    if (const std::uint32_t first = records_.first_scaling[id.index]; first != no_scaling && options_.fold_affine) {
      out_.uses.scalings = true;
      line("vec4 scaling = scaling_at({} + list_at(i));", fmt::format("{}u", first));
      line("vec3 q = p * scaling.w + scaling.xyz;");
      if (reaches()) line("local = scaled(outer, abs(scaling.w), {});", bound(seeds.error));
    } else {
      out_.uses.placements = true;
      const std::string placement = fmt::format("placement_affine({}u + list_at(i))", record.first_placement);
      line("vec3 q = apply({}, p);", placement);
      if (reaches()) line("local = {};", seeds.frame(placement));
    }
    emit_boxed_test("negative = ", asked_box(sdf, module_), id);
    close();
    if (reaches()) line("local = outer;");
    line("hit_unfinished = hit_unfinished || (!negative && asked != range.y - range.x);");
    line("return negative;");
  }

  // ---- objects ----

  static std::string object_name(Id<Object> id) { return fmt::format("object_{}", id.index); }

  std::string call(Id<Object> object, const std::string& p, const std::string& level,
                   const std::string& guard = "true") const {
    if (plan_.cut[object.index]) {
      return fmt::format("{}walk({}u, {}, {})", guard == "true" ? "" : "if (" + guard + ") ", object.index, p, level);
    }
    if (guarded_[object.index]) return fmt::format("{}({}, {}, {})", object_name(object), p, level, guard);
    return fmt::format("{}({}, {})", object_name(object), p, level);
  }

  void emit_object(Id<Object> id) {
    const ObjectParts& parts = plan_.parts[id.index];
    for (const Id<Sdf> sdf : parts.sdfs) emit_sdf(sdf);
    line("// {}", at(module_.objects, id).name);
    guard_ = guarded_[id.index] ? "entered" : "";
    open(fmt::format("void {}(vec3 p, uint level{})", object_name(id), guard_.empty() ? "" : ", bool entered"));
    const bool one_region = parts.regions.size() == 1;
    if (!one_region) emit_decisions(at(module_.objects, id).root, parts.has_flat_tree);
    for (const Id<Region> region : parts.regions) emit_candidates(region, one_region);
    emit_own_answer(parts.regions, one_region);
    close();
    line("");
    add(object_name(id));
    if (sinks(id)) emit_in_two_steps(id);
  }

  // ---- objects in two steps: whether they answer, and what ----

  /// What becomes of a point at a node or below it, as far as the decisions tell.
  enum class Outcome : std::uint8_t { misses, answers, either };

  Outcome outcome_of(Id<Node> id) {
    if (const auto known = outcomes_.find(id); known != outcomes_.end()) return known->second;
    const auto& content = at(module_.nodes, id).content;
    Outcome outcome = Outcome::either;
    if (const auto* leaf = std::get_if<Id<Region>>(&content)) {
      const Region& region = at(module_.regions, *leaf);
      if (region.number != 0) outcome = Outcome::answers;  // its own colour at least
      else if (region.groups.empty()) outcome = Outcome::misses;
    } else {
      const auto& decision = std::get<Decision>(content);
      const Outcome negative = outcome_of(decision.negative), positive = outcome_of(decision.positive);
      if (negative == positive) outcome = negative;
    }
    outcomes_.emplace(id, outcome);
    return outcome;
  }

  /// Do the object's decisions tell, before what it embeds is asked, whether it answers?
  bool sinks(Id<Object> id) {
    const ObjectParts& parts = plan_.parts[id.index];
    if (!options_.sink_answers || plan_.cut[id.index] || parts.has_flat_tree) return false;
    const Outcome outcome = outcome_of(at(module_.objects, id).root);
    const bool is_told = std::ranges::all_of(parts.regions, [&](Id<Region> region) {
      return at(module_.regions, region).number != 0 || at(module_.regions, region).groups.empty();
    });
    return is_told && outcome != Outcome::misses;
  }

  /// With `inside` false, whether it answers; then, with `inside` true, it does.
  void emit_in_two_steps(Id<Object> id) {
    const ObjectParts& parts = plan_.parts[id.index];
    const Id<Node> root = at(module_.objects, id).root;
    const bool one_region = parts.regions.size() == 1;
    guard_.clear();
    line("// {}", at(module_.objects, id).name);
    open(fmt::format("bool {}(vec3 p, uint level, bool inside)", listed_name(id)));
    line("bool answers = inside || {};", entrance(root));
    open("if (inside)");
    is_inside_ = true;
    if (!one_region) emit_decisions(root, false);
    is_inside_ = false;
    for (const Id<Region> region : parts.regions) emit_candidates(region, one_region);
    emit_own_answer(parts.regions, one_region);
    close();
    line("return answers;");
    close();
    line("");
    add(listed_name(id));
  }

  /// Whether a point answers, as one expression.
  std::string entrance(Id<Node> id) {
    const Outcome outcome = outcome_of(id);
    if (outcome != Outcome::either) return outcome == Outcome::answers ? "true" : "false";
    const auto& decision = std::get<Decision>(at(module_.nodes, id).content);
    const std::string test = sdf_name(decision.sdf) + "(p)";
    const std::string negative = entrance(decision.negative), positive = entrance(decision.positive);
    if (negative == "true") return positive == "false" ? test : fmt::format("({} || {})", test, positive);
    if (negative == "false") return positive == "true" ? "!" + test : fmt::format("(!{} && {})", test, positive);
    if (positive == "true") return fmt::format("(!{} || {})", test, negative);
    if (positive == "false") return fmt::format("({} && {})", test, negative);
    return fmt::format("({} ? {} : {})", test, negative, positive);
  }

  /// The function that a list calls for an object.
  std::string listed_name(Id<Object> id) { return object_name(id) + (sinks(id) ? "_listed" : ""); }

  /// `condition` where the object's code is guarded also that it is asked; "" is no condition.
  std::string guarded(const std::string& condition) const {
    if (guard_.empty() || condition.empty()) return guard_ + condition;
    return guard_ + " && " + condition;
  }

  void emit_decisions(Id<Node> root, bool flat) {
    if (flat) {
      emit_flat_tree(root);
      return;
    }
    line("uint region{};", guard_.empty() ? "" : " = DMVV_NO_REGION");
    if (!guard_.empty()) open(fmt::format("if ({})", guard_));
    emit_tree(root);
    if (!guard_.empty()) close();
  }

  /// One decision after the other, parents first; `at` is the decision or region that the point has come to.
  void emit_flat_tree(Id<Node> root) {
    std::vector<Id<Node>> order;
    std::map<Id<Node>, std::uint32_t> parents;  // that are not yet in order
    std::vector<Id<Node>> pending{root};
    const auto children = [&](Id<Node> node) -> std::vector<Id<Node>> {
      const auto* decision = std::get_if<Decision>(&at(module_.nodes, node).content);
      return decision ? std::vector<Id<Node>>{decision->negative, decision->positive} : std::vector<Id<Node>>{};
    };
    for (std::set<Id<Node>> seen{root}; !pending.empty();) {
      const Id<Node> node = pending.back();
      pending.pop_back();
      for (const Id<Node> child : children(node)) {
        ++parents[child];
        if (seen.insert(child).second) pending.push_back(child);
      }
    }
    pending = {root};
    while (!pending.empty()) {
      const Id<Node> node = pending.back();
      pending.pop_back();
      if (!children(node).empty()) order.push_back(node);
      for (const Id<Node> child : children(node)) {
        if (--parents[child] == 0) pending.push_back(child);
      }
    }

    std::map<Id<Node>, std::uint32_t> number;
    for (const Id<Node> node : order) number.emplace(node, static_cast<std::uint32_t>(number.size()));
    const auto reference = [&](Id<Node> node) {
      const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, node).content);
      return region ? fmt::format("DMVV_REGION_BIT | {}u", region->index) : fmt::format("{}u", number.at(node));
    };
    line("uint at = {};", guard_.empty() ? "0u" : guard_ + " ? 0u : DMVV_NO_REGION");
    for (const Id<Node> node : order) {
      const auto& decision = std::get<Decision>(at(module_.nodes, node).content);
      line("if (at == {}u) at = {}(p) ? {} : {};", fmt::format("{}", number.at(node)), sdf_name(decision.sdf),
           reference(decision.negative), reference(decision.positive));
    }
    line("uint region = at & ~DMVV_REGION_BIT;");
  }

  void emit_tree(Id<Node> id) {
    if (const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, id).content)) {
      line("region = {};  // {}", fmt::format("{}u", region->index), at(module_.regions, *region).name);
      return;
    }
    const auto& decision = std::get<Decision>(at(module_.nodes, id).content);
    if (is_inside_ && outcome_of(decision.positive) == Outcome::misses) return emit_tree(decision.negative);
    if (is_inside_ && outcome_of(decision.negative) == Outcome::misses) return emit_tree(decision.positive);
    open(fmt::format("if ({}(p))", sdf_name(decision.sdf)));
    emit_tree(decision.negative);
    otherwise();
    emit_tree(decision.positive);
    close();
  }

  void emit_candidates(Id<Region> id, bool one_region, const Continuation& continued = {}) {
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

  void emit_group(Id<Region> region, std::size_t g, const gpu::GroupRecord& record, const std::string& asked,
                  std::optional<std::uint32_t> later) {
    const CandidateGroup& group = at(module_.regions, region).groups[g];
    open(asked.empty() ? "" : fmt::format("if ({})", asked));
    if (group.box_from_object) {
      line("vec3 b = {};", affine_expression(*group.box_from_object, "p", options_.fold_affine));
      if (reaches()) line("{};", limit_group_box(*group.box_from_object));
      open("if (in_cube(b))");
    }
    emit_candidate_loop(region, g, record, later);
    if (group.box_from_object) close();
    close();
  }

  /// Of point b in the frame of a group's box.
  std::string limit_group_box(const Affine& box_from_object) const {
    return fmt::format("limit_cube(b, {}, {})", bound(largest_stretch(box_from_object.linear)),
                       bound(2.0 * rounding_of(box_from_object)));
  }

  /// The call stands in no condition: a chain of objects, each in the one before, is as deep as one.
  /// `called`: the object's function, if it is not its usual one.
  void emit_one_candidate(Id<Region> region, const CandidateGroup& group, const std::string& asked, const std::string& called) {
    const Candidate& candidate = group.candidates.front();
    const LocalBox& content = at(module_.objects, candidate.object).content;
    open("");
    std::string enter = asked;
    const auto also = [&](const std::string& condition) { enter += (enter.empty() ? "" : " && ") + condition; };
    const auto asked_here = [&] { return enter.empty() ? std::string("true") : enter; };
    if (group.box_from_object) {
      line("vec3 b = {};", affine_expression(*group.box_from_object, "p", options_.fold_affine));
      if (reaches()) line("if ({}) {};", asked_here(), limit_group_box(*group.box_from_object));
      also("in_cube(b)");
    }
    const std::string q = affine_expression(candidate.local_from_parent, "p", options_.fold_affine);
    line(candidate.tiled ? "vec3 q = wrap_cube({});" : "vec3 q = {};", q);
    if (reaches()) {
      line("Local outer = local;");
      line("local = {};", scaled_frame(candidate.local_from_parent));
      line(candidate.tiled ? "if ({}) limit(0.0, 1.0);" : "if (({}) && !{}) {};", asked_here(), box_test(content, "q"),
           limit_box(content, "q", 1.0, 0.0));
    }
    if (!candidate.tiled) also(box_test(content, "q"));
    line("bool enter = {};", asked_here());
    line("{};", called.empty() ? call(candidate.object, "q", "level + 1u", "enter") : called + "(q, level + 1u, enter)");
    if (reaches()) {
      if (!candidate.tiled) line("if (enter && hit_number != 0u) {};", limit_box(content, "q", 1.0, 0.0));
      line("local = outer;");
    }
    line("if (enter && hit_number != 0u) came_through({}u, {}u, level);", fmt::format("{}", region.index),
         fmt::format("{}", group.first_number));
    close();
  }

  /// Where a group's candidates are asked, q being a point in the frame of one.
  struct CubeTest {
    std::string holds;  ///< is q there?
    std::string limit;  ///< how far q's answer holds, by that
  };

  /// In one box if all objects have it; else each where its record says.
  CubeTest cube_test(const std::set<Id<Object>>& objects, const std::string& tags) const {
    const LocalBox& first = at(module_.objects, *objects.begin()).content;
    const bool alike = std::ranges::all_of(objects, [&](Id<Object> object) { return at(module_.objects, object).content == first; });
    if (alike) return {box_test(first, "q"), limit_box(first, "q", 1.0, 0.0)};
    const std::string extent = fmt::format("extent_of({}.z)", tags);
    return {fmt::format("in_extent(q, {})", extent), fmt::format("limit_box(q, -{0}, {0}, 1.0, 0.0)", extent)};
  }

  /// With a `later` stage only the search for a candidate, which that stage then asks.
  void emit_candidate_loop(Id<Region> region, std::size_t g, const gpu::GroupRecord& record, std::optional<std::uint32_t> later) {
    const CandidateGroup& group = at(module_.regions, region).groups[g];
    out_.uses.placements = true;
    const bool any_tiled = std::any_of(group.candidates.begin(), group.candidates.end(),
                                       [](const Candidate& candidate) { return candidate.tiled; });
    if (reaches()) line("Local outer = local;");
    if (reaches() && group.box_from_object) line("local = {};", scaled_frame(*group.box_from_object));
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
      emit_calls(calls, true);
      emit_way("");
      close();
    }
    if (reaches()) line("local = outer;");
  }

  /// To the next candidate whose cube holds the point. A loop of its own: all points search, then all that have found one
  /// evaluate it (Aila and Laine 2009, while-while), and the evaluation's rounds are no more than a point's finds.
  void emit_search(const gpu::GroupRecord& record, bool any_tiled, const Placements& candidates, const CubeTest& cube) {
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
      if (any_tiled) line("if (tiled) limit(0.0, 1.0);");
      line("if (!held) {};", cube.limit);
    }
    close();
  }

  /// How the objects of a list are called: one call for each different shape, one walker for all objects that are cut.
  struct Calls {
    struct Call {
      std::string condition;  ///< "object == 3u"
      std::string called;     ///< up to what follows the point's level
      std::string guard;      ///< the arguments after it
      bool sinks;             ///< in two steps
    };
    std::string placement;
    std::vector<Call> calls{};
    std::optional<Id<Object>> walked{};  ///< one of those that are walked, if any are
    bool by_object = false, by_family = false;

    bool chooses() const { return calls.size() + (walked ? 1u : 0u) > 1; }
    bool sinks() const { return std::ranges::any_of(calls, &Call::sinks); }
    bool answers_at_once() const { return walked || !std::ranges::all_of(calls, &Call::sinks); }
  };

  Calls calls_of(const std::vector<Id<Object>>& called, const gpu::GroupRecord& record) {
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
        result.calls.push_back({fmt::format("object == {}u", first.index), listed_name(first) + "(q, level + 1u", guard, sinks(first)});
      } else {
        result.by_family = true;
        const std::uint32_t family = unite(alike);
        result.calls.push_back({fmt::format("family == {}u", family), united_names_[family - 1] + "(row, q, level + 1u", guard, sinks(first)});
      }
    }
    return result;
  }

  /// Of candidate c. In two steps: `inside` calls those for their answer, that have been found to have one.
  void emit_calls(const Calls& calls, bool inside) {
    if (calls.by_family) {
      line("uint united = placement_tags({}).w;", calls.placement);
      line("uint row = united >> DMVV_FAMILY_BITS;");
    }
    if (calls.chooses() && calls.by_family) line("uint family = united & (1u << DMVV_FAMILY_BITS) - 1u;");
    if (calls.by_object ? calls.chooses() : calls.walked.has_value()) line("uint object = placement_tags({}).x;", calls.placement);
    std::string others;  // holds for no object that has a call of its own
    // One after the other, not nested in each other's else.
    for (const Calls::Call& call : calls.calls) {
      const std::string made = call.sinks ? fmt::format("{}{}, {})", inside ? "" : "found = ", call.called, inside)
                                          : call.called + call.guard + ")";
      if (call.sinks || !inside) line("{}{};", calls.chooses() ? fmt::format("if ({}) ", call.condition) : "", made);
      others += fmt::format("{}!({})", others.empty() ? "" : " && ", call.condition);
    }
    if (calls.walked && !inside) line("{}walk(object, q, level + 1u);", others.empty() ? "" : fmt::format("if ({}) ", others));
  }

  /// Objects by shape, in the order of the first of each; those that are cut all together.
  std::vector<std::vector<Id<Object>>> shapes_of(const std::vector<Id<Object>>& called) {
    std::vector<std::vector<Id<Object>>> shapes;
    std::map<std::uint64_t, std::size_t> places;
    for (const Id<Object> object : called) {
      std::uint64_t shape = std::uint64_t{object.index} << 32;
      if (plan_.cut[object.index]) shape = ~std::uint64_t{0};
      else if (options_.unite_shapes) shape = families_.shape(listed_name(object));
      const auto [place, is_new] = places.try_emplace(shape, shapes.size());
      if (is_new) shapes.emplace_back();
      shapes[place->second].push_back(object);
    }
    return shapes;
  }

  /// The number of the family that the objects belong to, from 1: 0 is that of objects without.
  std::uint32_t unite(const std::vector<Id<Object>>& alike) {
    std::vector<std::string> names;
    for (const Id<Object> object : alike) names.push_back(listed_name(object));
    const std::string name = families_.unite(names);
    const auto known = std::ranges::find(united_names_, name);
    const auto family = static_cast<std::uint32_t>(known - united_names_.begin()) + 1;
    if (known == united_names_.end()) united_names_.push_back(name);
    for (const Id<Object> object : alike) united_objects_.emplace(object, family);
    return family;
  }

  /// Nobody inside answered: the region's own colour counts, unless it is empty.
  void emit_own_answer(const std::vector<Id<Region>>& regions, bool one_region) {
    const bool may_be_found = std::any_of(regions.begin(), regions.end(), [&](Id<Region> region) {
      return !at(module_.regions, region).groups.empty();
    });
    if (one_region) {
      const Region& region = at(module_.regions, regions.front());
      if (region.number == 0) return;
      const std::string condition = guarded(may_be_found ? nobody() : "");
      line("{}answer({}u, {}u, p, level);", condition.empty() ? "" : "if (" + condition + ") ",
           fmt::format("{}", regions.front().index), fmt::format("{}", region.number));
      return;
    }
    line("uint number = 0u;");  // numbers need not follow the order of the regions; choices within choices would nest
    for (const Id<Region> region : regions) {
      const std::uint32_t n = at(module_.regions, region).number;
      if (n != 0) line("if (region == {}u) number = {}u;", fmt::format("{}", region.index), fmt::format("{}", n));
    }
    line("if ({}) answer(region, number, p, level);",
         guarded(may_be_found ? nobody() + " && number != 0u" : "number != 0u"));
  }

  // ---- stages (compiler/stage_plan.h) ----

  static std::string stage_name(std::uint32_t stage) { return fmt::format("stage_{}", stage); }

  std::string nobody() const { return stage_ ? "hit_number == 0u && next_stage == 0u" : "hit_number == 0u"; }

  void emit_stages() {
    if (options_.stages) stages_ = plan_stages(module_, plan_, *options_.stages);
    out_.stage_count = stages_.numbers.empty() ? 0 : static_cast<std::uint32_t>(stages_.numbers.size() + 1);
    if (stages_.numbers.empty() || !options_.write_stages) return;
    emit_stage(0, [&] {
      const std::string root = emit_divided({}, module_.root);
      open("void stage_0(vec3 p)");
      line("{}(p, 0u);", root);
      close();
    });
    for (const auto& [begin, number] : stages_.numbers) {
      emit_stage(number, [&] { emit_stage_from(number, begin.first, begin.second); });
    }
    stage_.reset();
  }

  void emit_stage(std::uint32_t number, const auto& emit) {
    stage_ = number;
    divided_ = 0;
    emit();
    line("");
    add(stage_name(number));
    out_.stages.emplace_back();
  }

  /// From a group of a region on: the way to there is entered already.
  void emit_stage_from(std::uint32_t number, const Way& way, std::size_t group) {
    Continuation continued{.first = group, .way = &way, .last = emit_last(way)};
    guard_.clear();
    open(fmt::format("void {}(vec3 p)", stage_name(number)));
    line("uint level = {}u;", fmt::format("{}", way.size() - 1));
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
      line("vec3 p_{} = p;", fmt::format("{}", i));
      const Affine& affine = at(module_.regions, way[i]).groups.back().candidates.front().local_from_parent;
      line("p = {};", affine_expression(affine, "p", options_.fold_affine));
    }
    emit_candidates(way.back(), true, continued);
    for (std::size_t i = way.size(); i-- > 0;) {
      const std::uint32_t answered = at(module_.regions, way[i]).number;
      const std::string p = i + 1 == way.size() ? "p" : fmt::format("p_{}", i);
      if (answered != 0) line("if ({}) answer({}u, {}u, {}, {}u);", nobody(), fmt::format("{}", way[i].index), fmt::format("{}", answered), p, fmt::format("{}", i));
    }
    close();
  }

  /// What is called for the one candidate of a region's last group, if that may be divided.
  std::string emit_last(const Way& way) {
    const auto object = last_object(module_, plan_, way.back());
    return object ? emit_divided(way, *object) : "";
  }

  /// An object as a stage has it: where its regions' groups are divided off, the stages are told that hold them.
  std::string emit_divided(const Way& way, Id<Object> id) {
    const ObjectParts& parts = plan_.parts[id.index];
    const bool one_region = parts.regions.size() == 1;
    std::vector<Way> ways(parts.regions.size(), way);
    for (std::size_t r = 0; r < ways.size(); ++r) ways[r].push_back(parts.regions[r]);
    const std::string last = one_region ? emit_last(ways.front()) : "";
    const std::string name = fmt::format("divided_{}_{}", *stage_, divided_++);
    guard_ = way.empty() ? "" : "entered";
    line("// {}", at(module_.objects, id).name);
    open(fmt::format("void {}(vec3 p, uint level{})", name, guard_.empty() ? "" : ", bool entered"));
    if (!one_region) emit_decisions(at(module_.objects, id).root, parts.has_flat_tree);
    for (std::size_t r = 0; r < ways.size(); ++r) {
      const Id<Region> region = parts.regions[r];
      const auto later = one_region ? std::nullopt : stages_.stage_at(ways[r], 0);
      if (later) {
        line("if ({}) next_stage = {}u;", guarded(fmt::format("region == {}u", region.index)), fmt::format("{}", *later));
      } else {
        emit_candidates(region, one_region, {.asks_first = false, .way = one_region ? &ways[r] : nullptr, .last = last});
      }
    }
    emit_own_answer(parts.regions, one_region);
    close();
    line("");
    add(name);
    return name;
  }

  // ---- colours ----

  void emit_colors() {
    const bool constants = !out_.uses.walker && module_.regions.size() <= most_constant_regions;
    out_.uses.bitmap_atlas = !module_.bitmaps.empty();
    out_.uses.region_colors = !constants;
    open("vec4 color_of(uint region, vec3 p)");
    if (constants) {
      emit_constant_colors();
    } else {
      emit_record_colors();
    }
    close();
    line("");
    add("color_of");
  }

  void emit_constant_colors() {
    line("vec4 color = vec4(0.0);");
    if (out_.uses.bitmap_atlas) {
      line("vec3 u = vec3(0.0);");
      line("vec3 slot_scale = vec3(0.0);");
      line("vec3 slot_offset = vec3(0.0);");
      line("bool bitmap = false;");
    }
    for (std::size_t i = 0; i < module_.regions.size(); ++i) {
      const Region& region = module_.regions[i];
      if (region.number == 0) continue;
      const std::string is_region = fmt::format("if (region == {}u)", i);
      if (region.kind == voml::RegionKind::color) {
        line("{} color = vec4({}, {}, {}, {});  // {}", is_region, glsl_float(static_cast<float>(region.rgb.x)),
             glsl_float(static_cast<float>(region.rgb.y)), glsl_float(static_cast<float>(region.rgb.z)),
             glsl_float(static_cast<float>(region.opacity)), region.name);
        continue;
      }
      open(fmt::format("{}", is_region));
      line("// {}", region.name);
      line("u = {};", affine_expression(region.texture_from_object, "p", options_.fold_affine));
      line("slot_scale = {};", vec3_literal(glm::dvec3(records_.regions[i].slot_scale)));
      line("slot_offset = {};", vec3_literal(glm::dvec3(records_.regions[i].slot_offset)));
      line("color = vec4(1.0, 1.0, 1.0, {});", glsl_float(static_cast<float>(region.opacity)));
      line("bitmap = true;");
      close();
    }
    if (out_.uses.bitmap_atlas) {
      line("vec4 texel = textureLod(bitmap_atlas, fract((u + 1.0) * 0.5) * slot_scale + slot_offset, 0.0);");
      line("if (bitmap) color *= texel;");
    }
    line("return color;");
  }

  void emit_record_colors() {
    line("vec4 color = regions[region].color;");
    if (out_.uses.bitmap_atlas) {
      line("vec3 u = fract((apply(regions[region].texture_from_object, p) + 1.0) * 0.5);");
      line("vec3 slot = u * regions[region].slot_scale.xyz + regions[region].slot_offset.xyz;");
      line("vec4 texel = textureLod(bitmap_atlas, slot, 0.0);");
      line("if (regions[region].slot_scale.w != 0.0) color = vec4(texel.rgb, texel.a * color.a);");
    }
    line("return color;");
  }

  const Module& module_;
  const Records& records_;
  const Atlas& grid_atlas_;
  const GlslOptions& options_;
  Evaluation out_;
  SourceSizes sizes_;
  CodePlan plan_;
  std::vector<bool> guarded_;  // objects whose function has a guard
  std::string guard_;          // of the function that is being written; "" if it has none
  std::string tape_walker_;      // empty if no function is a tape
  std::map<Id<Node>, Outcome> outcomes_;
  bool is_inside_ = false;  ///< what is written is reached only by points that get an answer
  StagePlan stages_;
  std::optional<std::uint32_t> stage_;  ///< that is being written
  std::uint32_t divided_ = 0;          ///< objects of it
  std::set<Id<Sdf>> emitted_;
  Families families_;
  std::vector<std::string> united_names_;               // of each family of objects
  std::map<Id<Object>, std::uint32_t> united_objects_;  // their families
};

}  // namespace

Evaluation generate_evaluation(const Module& module, const Records& records, const Atlas& grid_atlas,
                               const GlslOptions& options) {
  return Generator(module, records, grid_atlas, options).run();
}

}  // namespace dmvv::compiler
