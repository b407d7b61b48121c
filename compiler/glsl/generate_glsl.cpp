#include "compiler/glsl/generate_glsl.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "compiler/glsl/generator.h"
#include "compiler/grids/storage.h"
#include "compiler/ir/opacity.h"
#include "compiler/ir/rounding.h"
#include "compiler/plan/codegen.h"

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
constexpr std::uint32_t lines_of_trilinear = 16;  // of a filter in the shader, in place of one texture lookup
constexpr std::uint32_t lines_of_tricubic = 90;

}  // namespace

Evaluation Generator::run() {
  measure_sources();
  find_guarded();
  std::vector<Id<Object>> alike = each_by_itself();
  if (options_.unite_shapes) {  // objects of one shape count once; writing them tells which they are
    write(plan_code(module_, sizes_, alike, {Codegen::specialised, no_budget, {}}));
    alike = by_shape();
  }
  write(plan_code(module_, sizes_, alike, {options_.codegen, options_.inlined_line_budget, options_.costs}));
  emit_stages();
  if (options_.rays) emit_occupancy();
  return finish();
}

void Generator::write(CodePlan plan) {
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
  if (options_.rays) use_rays();
  // Objects stand parents first; GLSL wants callees first.
  for (std::size_t i = module_.objects.size(); i-- > 0;) {
    if (plan_.needed[i] && !plan_.cut[i]) emit_object(Id<Object>{static_cast<std::uint32_t>(i)});
  }
  emit_colors();
  if (reaches()) {
    emit_region_test("has_bitmap", [](const Region& region) { return region.kind == voml::RegionKind::bitmap; });
  }
  if (options_.media) {
    emit_region_test("is_medium", [&](const Region& region) { return is_medium(module_, region); });
    emit_medium_step();
  }
  line("void evaluate(vec3 p) { {}; }", call(module_.root, "p", "0u"));
  add("evaluate");
}

std::vector<std::string> Generator::scene_functions() const {
  std::vector<std::string> names{"color_of", "evaluate"};
  if (reaches()) names.emplace_back("has_bitmap");
  if (options_.media) names.insert(names.end(), {"is_medium", "medium_step"});
  if (!plan_.cut[module_.root.index]) names.insert(names.begin(), object_name(module_.root));
  return names;
}

Evaluation Generator::finish() {
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
  if (options_.rays) {
    std::vector<std::string> names = walker_functions();
    names.emplace_back("occupancy");
    out_.occupancy = families_.copy(names);
  }
  out_.has_function_switch = (options_.rays || plan_.walks()) && !module_.functions.empty();
  out_.glsl = families_.take(scene_functions());
  if (options_.rays) out_.function_switch = families_.take(walker_functions());
  out_.inlined_lines = plan_.inlined_lines;
  out_.object_forms = std::move(plan_.object_forms);
  return std::move(out_);
}

void Generator::measure_sources() {
  if (options_.tapes != nullptr && options_.tapes->any()) tape_walker_ = tape_walker(*options_.tapes);
  for (std::uint32_t i = 0; i < module_.functions.size(); ++i) {
    const snippet::Snippet& snippet = module_.functions[i].snippet;
    sizes_.function_lines.push_back(code_lines(is_tape({i}) ? tape_walker_ : snippet.glsl("f", 0)));
    sizes_.function_nesting =
        std::max(sizes_.function_nesting, is_tape({i}) ? nesting_of_tape_walker : snippet.nesting());
  }
  sizes_.filter_lines = filter_lines();
}

void Generator::emit_functions() {
  for (std::uint32_t i = 0; i < module_.functions.size(); ++i) {
    const Function& function = module_.functions[i];
    const std::size_t next_time_value = out_.time_slots.size();
    const std::string name = function_name({i});
    const std::string text = is_tape({i}) ? tape_call(name, options_.tapes->functions[i], next_time_value)
                                          : function.snippet.glsl(name, next_time_value);
    families_.add(name, fmt::format("// {}\n{}\n", function.name, text));
    const std::vector<snippet::TimeSlot>& slots = function.snippet.time_split().slots;
    out_.time_slots.insert(out_.time_slots.end(), slots.begin(), slots.end());
  }
  out_.uses.time = !out_.time_slots.empty();
}

void Generator::use_walker() {
  out_.uses.walker = out_.uses.placements = out_.uses.lists = true;
  out_.uses.grid_atlas = !module_.grids.empty();
  if (!module_.functions.empty()) emit_function_switch();
}

void Generator::use_rays() {
  out_.uses.rays = out_.uses.placements = true;
  out_.uses.media = options_.media;
  if (!plan_.walks() && !module_.functions.empty()) emit_function_switch();
}

std::vector<std::string> Generator::walker_functions() const {
  return module_.functions.empty() ? std::vector<std::string>{} : std::vector<std::string>{"call_function"};
}

void Generator::emit_function_switch() {
  open("float call_function(uint function, vec3 q)");
  line("float value = 0.0;");
  emit_function_choice(0, static_cast<std::uint32_t>(module_.functions.size()));
  line("return value;");
  close();
  line("");
  add("call_function");
}

void Generator::emit_function_choice(std::uint32_t first, std::uint32_t end) {
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

std::uint32_t Generator::filter_lines() const {
  if (module_.grids.empty() || grid_atlas_.filter == Filter::hardware) return 0;
  return grid_atlas_.filter == Filter::shader ? lines_of_trilinear : lines_of_tricubic;
}

std::vector<Id<Object>> Generator::each_by_itself() const {
  std::vector<Id<Object>> objects(module_.objects.size());
  for (std::uint32_t i = 0; i < objects.size(); ++i) objects[i] = {i};
  return objects;
}

std::vector<Id<Object>> Generator::by_shape() const {
  std::vector<Id<Object>> objects = each_by_itself();
  std::map<std::uint32_t, Id<Object>> first;
  for (Id<Object>& object : objects) {
    if (families_.knows(object_name(object))) {
      object = first.try_emplace(families_.shape(object_name(object)), object).first->second;
    }
  }
  return objects;
}

void Generator::find_guarded() {
  guarded_.assign(module_.objects.size(), false);
  for (const Region& region : module_.regions) {
    for (const CandidateGroup& group : region.groups) {
      if (group.candidates.size() == 1) guarded_[group.candidates.front().object.index] = true;
    }
  }
}

Evaluation generate_evaluation(const Module& module, const Records& records, const Atlas& grid_atlas,
                               const GlslOptions& options) {
  return Generator(module, records, grid_atlas, options).run();
}

}  // namespace dmvv::compiler
