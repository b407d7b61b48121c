// Distance functions as GLSL, and how far what they tell holds (shaders/reach.glsl).
#include "compiler/glsl/generator.h"
#include "compiler/grids/storage.h"
#include "compiler/ir/placements.h"
#include "compiler/passes/seed_chains.h"
#include "compiler/snippet/glsl_literal.h"

namespace dmvv::compiler {

std::string Generator::source_test(Id<Sdf> id, const Affine* constant, const std::string& q) {
  const Sdf& sdf = at(module_.sdfs, id);
  if (const auto* function = std::get_if<Id<Function>>(&sdf.source)) {
    const std::string local = constant ? affine_expression(*constant, q, options_.fold_affine) : q;
    return comparison(id, fmt::format("{}({})", function_name(*function), local), 1.0, constant, q);
  }
  const auto grid_id = std::get<Id<voml::Grid>>(sdf.source);
  const voml::Grid& grid = at(module_.grids, grid_id);
  out_.uses.grid_atlas = true;
  const Affine atlas = lookup_from_local(grid, grid_id, grid_atlas_);
  const std::string at = affine_expression(constant ? atlas * *constant : atlas, q, options_.fold_affine);
  const std::string value = grid_atlas_.filter == Filter::hardware
                                ? fmt::format("textureLod(grid_atlas, {}, 0.0).r", at)
                                : fmt::format("sample_grid({})", at);
  return comparison(id, value, grid_atlas_.scales[grid_id.index], constant, q);
}

std::string Generator::comparison(Id<Sdf> id, const std::string& value, double scale, const Affine* constant,
                                  const std::string& q) const {
  const std::string iso = glsl_float(static_cast<float>(at(module_.sdfs, id).iso / scale));
  if (!reaches()) return fmt::format("{} <= {}", value, iso);
  Steepness source = (*options_.steepness)[id.index];
  if (constant != nullptr) {
    source.error += *std::ranges::max_element(source.slopes) * rounding_of(*constant);
    for (double& slope : source.slopes) slope *= largest_stretch(constant->linear);
  }
  const auto& [near, middle, far] = source.slopes;
  // Both points that are compared are off.
  return fmt::format("below({}, {}, vec2({}, {}), vec3({}, {}, {}), {}, {}u{}, {})", value, iso,
                     glsl_float(static_cast<float>(source.widths[0] / scale)),
                     glsl_float(static_cast<float>(source.widths[1] / scale)), glsl_float(flatness(near / scale)),
                     glsl_float(flatness(middle / scale)), glsl_float(flatness(far / scale)),
                     bound(2.0 * source.error / scale), id.index, constant == nullptr ? " | DMVV_AT_SOURCE" : "", q);
}

std::string Generator::bound(double value) { return glsl_float(value < 1e30 ? static_cast<float>(value) : 1e30f); }

/// Nine numbers, even if some are equal: the shape does not depend on the values.
std::string Generator::mat3_literal(const glm::dmat3& m) {
  const auto column = [&](int i) { return components(glm::vec4(glm::vec3(m[i]), 0.0f)); };
  return fmt::format("mat3({}, {}, {})", column(0), column(1), column(2));
}

std::string Generator::scaled_frame(const Affine& affine) {
  const double stretch = largest_stretch(affine.linear);
  return fmt::format("scaled(outer, {}, {}, {})", bound(stretch), bound(rounding_of(affine) / stretch),
                     mat3_literal(affine.linear));
}

std::string Generator::limit_box(const LocalBox& box, const std::string& q, double slope, double error) const {
  if (box.lo == glm::dvec3(-1.0) && box.hi == glm::dvec3(1.0)) {
    return fmt::format("limit_cube({}, {}, {})", q, bound(slope), bound(error));
  }
  return fmt::format("limit_box({}, {}, {}, {}, {})", q, vec3_literal(box.lo), vec3_literal(box.hi), bound(slope),
                     bound(error));
}

void Generator::emit_region_test(const std::string& name, const std::function<bool(const Region&)>& holds) {
  open(fmt::format("bool {}(uint region)", name));
  std::string test = "false";
  for (std::size_t i = 0; i < module_.regions.size(); ++i) {
    if (holds(module_.regions[i])) test += fmt::format(" || region == {}u", i);
  }
  line("return {};", test);
  close();
  line("");
  add(name);
}

std::string Generator::box_test(const LocalBox& box, const std::string& q) const {
  if (box.lo == glm::dvec3(-1.0) && box.hi == glm::dvec3(1.0)) return fmt::format("in_cube({})", q);
  return fmt::format("in_box({}, {}, {})", q, vec3_literal(box.lo), vec3_literal(box.hi));
}

void Generator::emit_sdf(Id<Sdf> id) {
  if (const Link* link = link_of(id)) return emit_chain(*link->chain);
  if (!emitted_.insert(id).second) return;
  const Sdf& sdf = at(module_.sdfs, id);
  line("// {}", sdf.name);
  open(fmt::format("bool {}(vec3 p)", sdf_name(id)));
  switch (sdf.placement) {
    case voml::Placement::single:
      emit_single(id, sdf);
      break;
    case voml::Placement::tiled:
      emit_tiled(id, sdf);
      break;
    case voml::Placement::seeded:
      emit_seeded(id, sdf);
      break;
  }
  close();
  line("");
  add(sdf_name(id));
}

void Generator::emit_single(Id<Sdf> id, const Sdf& sdf) {
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

void Generator::emit_boxed_test(const std::string& result, const LocalBox& box, Id<Sdf> id) {
  if (!reaches()) return line("{}{} && {};", result, box_test(box, "q"), source_test(id, nullptr, "q"));
  line("bool inside = {};", box_test(box, "q"));
  line("{}inside && {};", result, source_test(id, nullptr, "q"));
  line("if (inside == negative) {};", limit_box(box, "q", 1.0, 0.0));
}

void Generator::emit_tiled(Id<Sdf> id, const Sdf& sdf) {
  const Affine& affine = sdf.local_from_object.front();
  line("vec3 q = wrap_cube({});", affine_expression(affine, "p", options_.fold_affine));
  if (!reaches()) {
    line("return {} && {};", box_test(local_box(sdf, module_), "q"), source_test(id, nullptr, "q"));
    return;
  }
  line("Local outer = local;");
  line("local = {};", scaled_frame(affine));
  line("limit_tile(q);");
  emit_boxed_test("bool negative = ", local_box(sdf, module_), id);
  line("local = outer;");
  line("return negative;");
}

std::string Generator::components(const glm::vec4& v) {
  return fmt::format("vec3({}, {}, {})", glsl_float(v.x), glsl_float(v.y), glsl_float(v.z));
}

std::string Generator::find_cell(const gpu::LookupRecord& lookup, const std::string& p) {
  out_.uses.lists = true;
  return fmt::format("find_cell({}, {}, {}, uvec3({}u, {}u, {}u), {}u)", p, components(lookup.lo),
                     components(lookup.cells_per_unit), lookup.size_x, lookup.size_y, lookup.size_z, lookup.first_cell);
}

void Generator::emit_range(const gpu::LookupRecord& lookup, const std::string& p) {
  line("uvec2 range = {};", find_cell(lookup, p));
  if (!reaches()) return;
  line("limit_cell({}, {}, {}, uvec3({}u, {}u, {}u), {}u);", p, components(lookup.lo),
       components(lookup.cells_per_unit), fmt::format("{}", lookup.size_x), fmt::format("{}", lookup.size_y),
       fmt::format("{}", lookup.size_z), fmt::format("{}", lookup.first_cell));
}

void Generator::emit_seeded(Id<Sdf> id, const Sdf&) {
  emit_seed_search(std::span(&id, 1));
  line("return negative;");
}

void Generator::emit_chain(const SeedChain& chain) {
  if (!emitted_.insert(chain.front()).second) return;
  for (const Id<Sdf> sdf : chain) line("// {}", at(module_.sdfs, sdf).name);
  open(fmt::format("uint {}(vec3 p)", chain_name(chain)));
  emit_seed_search(chain);
  line("uint first = 0u;");
  for (std::uint32_t i = 1; i < chain.size(); ++i) {
    line("if (seed >= {}u) first = {}u;", fmt::format("{}", records_.first_seed[chain[i].index]), fmt::format("{}", i));
  }
  line("return negative ? first : {}u;", fmt::format("{}", chain.size()));
  close();
  line("");
  add(chain_name(chain));
}

void Generator::emit_seed_search(std::span<const Id<Sdf>> sdfs) {
  const gpu::SdfRecord& record = records_.sdfs[sdfs.front().index];
  emit_range(record.lookup, "p");
  line("uint asked = 0u;");
  line("uint seed = 0u;");
  line("bool negative = false;");
  if (reaches()) line("Local outer = local;");
  open("for (uint i = range.x; i < range.y && !negative; ++i)");
  line("++asked;");
  line("seed = list_at(i);");
  Placements seeds;
  for (const Id<Sdf> sdf : sdfs) {
    for (const Affine& affine : at(module_.sdfs, sdf).local_from_object) seeds.add(affine);
  }
  const bool scales =
      std::ranges::all_of(sdfs, [&](Id<Sdf> sdf) { return records_.first_scaling[sdf.index] != no_scaling; });
  if (scales && options_.fold_affine) {
    out_.uses.scalings = true;
    line("vec4 scaling = scaling_at({} + seed);", fmt::format("{}u", records_.first_scaling[sdfs.front().index]));
    line("vec3 q = p * scaling.w + scaling.xyz;");
    if (reaches()) line("local = scaled(outer, abs(scaling.w), {}, mat3(scaling.w));", bound(seeds.error));
  } else {
    out_.uses.placements = true;
    const std::string placement = fmt::format("placement_affine({}u + seed)", record.first_placement);
    line("vec3 q = apply({}, p);", placement);
    if (reaches()) line("local = {};", seeds.frame(placement));
  }
  emit_boxed_test("negative = ", asked_box(at(module_.sdfs, sdfs.front()), module_), sdfs.front());
  close();
  if (reaches()) line("local = outer;");
  line("hit_unfinished = hit_unfinished || (!negative && asked != range.y - range.x);");
}

std::string Generator::decision_test(Id<Sdf> id, bool asks) const {
  const Link* const link = link_of(id);
  if (link == nullptr) return sdf_name(id) + "(p)";
  if (!asks) return fmt::format("(first_negative == {}u)", link->number);
  return fmt::format("((first_negative = {}(p)) == {}u)", chain_name(*link->chain), link->number);
}

std::string Generator::decision_test(Id<Sdf> id) {
  const Link* const link = link_of(id);
  const std::string test = decision_test(id, link == nullptr || link->chain != asked_chain_);
  if (link != nullptr) asked_chain_ = link->chain;
  return test;
}

}  // namespace dmvv::compiler
