#include "compiler/generate_glsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "compiler/shader_text.h"

namespace dmvv::compiler {

std::string glsl_float(float value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

bool is_diagonal(const Affine& a) {
  const glm::dmat3& m = a.linear;
  return m[0].y == 0 && m[0].z == 0 && m[1].x == 0 && m[1].z == 0 && m[2].x == 0 && m[2].y == 0;
}

bool cube_maps_into(const Affine& affine, const LocalBox& box) {
  const glm::dvec3 half = glm::abs(affine.linear[0]) + glm::abs(affine.linear[1]) + glm::abs(affine.linear[2]);
  const bool exact = affine == Affine{};  // the identity is not even computed
  const glm::dvec3 reach = half + (exact ? glm::dvec3(0.0) : float_error(affine, glm::dvec3(1.0)));
  return glm::all(glm::greaterThanEqual(affine.translation - reach, box.lo)) &&
         glm::all(glm::lessThanEqual(affine.translation + reach, box.hi));
}

namespace {

// Lines that the parts of a shader take after inlining; counted on generated text.
constexpr std::uint32_t lines_of_decision = 8;
constexpr std::uint32_t lines_of_seeded_decision = 22;
constexpr std::uint32_t lines_of_group = 26;
constexpr std::uint32_t lines_of_walker = 110;
constexpr std::uint32_t lines_of_trilinear = 16;  // of a filter in the shader, in place of one texture lookup
constexpr std::uint32_t lines_of_tricubic = 90;
constexpr std::uint32_t most_lines = 1u << 24;  // sums saturate here: shared subtrees can count exponentially
constexpr std::size_t most_constant_regions = 24;
// lavapipe ignores, in silence, conditions that stand inside more than 80 others, after inlining; lowering early exits
// adds some.
constexpr std::uint32_t most_nested = 48;
constexpr std::uint32_t deep_tree = 16;  // decisions on a way; deeper trees are written without nesting
constexpr std::uint32_t nesting_of_flat_tree = 2;
constexpr std::uint32_t nesting_of_group = 6;  // of a loop over candidates
constexpr std::uint32_t nesting_of_walker = 8;
constexpr std::uint32_t nesting_of_tape_walker = 3;

std::uint32_t saturating_add(std::uint32_t a, std::uint64_t b) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(a + b, most_lines));
}

std::string vec3_literal(const glm::dvec3& v) {
  const glm::vec3 f(v);
  if (f.x == f.y && f.y == f.z) return fmt::format("vec3({})", glsl_float(f.x));
  return fmt::format("vec3({}, {}, {})", glsl_float(f.x), glsl_float(f.y), glsl_float(f.z));
}

glm::dvec3 diagonal(const Affine& a) { return {a.linear[0].x, a.linear[1].y, a.linear[2].z}; }

/// affine(p) as an expression.
std::string affine_expression(const Affine& affine, const std::string& p, bool fold) {
  const bool diagonal_only = fold && is_diagonal(affine);
  const bool scales = !diagonal_only || diagonal(affine) != glm::dvec3(1.0);
  const bool moves = !fold || affine.translation != glm::dvec3(0.0);
  std::string text = p;
  if (scales && diagonal_only) text = fmt::format("{} * {}", p, vec3_literal(diagonal(affine)));
  if (scales && !diagonal_only) {
    const glm::mat3 m(affine.linear);
    std::string entries;
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row) entries += (entries.empty() ? "" : ", ") + glsl_float(m[column][row]);
    }
    text = fmt::format("mat3({}) * {}", entries, p);
  }
  if (moves) text += fmt::format(" + {}", vec3_literal(affine.translation));
  return text;
}

/// Lines that are not blank or comments.
std::uint32_t code_lines(std::string_view text) {
  std::uint32_t lines = 0;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string_view::npos && !line.substr(first).starts_with("//")) ++lines;
  }
  return lines;
}

class Generator {
 public:
  Generator(const Module& module, const Records& records, const Atlas& grid_atlas, const GlslOptions& options)
      : module_(module), records_(records), grid_atlas_(grid_atlas), options_(options) {}

  Evaluation run() {
    out_.codegen = options_.codegen;
    out_.filter = grid_atlas_.filter;
    emit_functions();
    collect_objects();
    find_guarded();
    choose_cuts();
    const bool any_cut = std::find(cut_.begin(), cut_.end(), true) != cut_.end();
    out_.uses.walker = any_cut;
    if (any_cut) emit_function_switch();
    // Objects stand parents first; GLSL wants callees first.
    for (std::size_t i = module_.objects.size(); i-- > 0;) {
      if (needed_[i] && !cut_[i]) emit_object(Id<Object>{static_cast<std::uint32_t>(i)});
    }
    emit_colors();
    line("void evaluate(vec3 p) { {}; }", call(module_.root, "p", "0u"));
    if (any_cut) {
      out_.uses.placements = out_.uses.lists = true;
      out_.uses.grid_atlas = out_.uses.grid_atlas || !module_.grids.empty();
    }
    out_.glsl = std::move(body_);
    out_.inlined_lines = inlined_lines(module_.root);
    describe();
    return std::move(out_);
  }

 private:
  template <class... Args>
  void line(std::string_view format, Args&&... args) {
    if constexpr (sizeof...(Args) == 0) {
      if (!format.empty()) body_ += std::string(indent_, ' ') + std::string(format);
      body_ += '\n';
    } else {
      body_ += std::string(indent_, ' ') + substitute(format, {std::string(args)...}) + "\n";
    }
  }

  /// Replaces each "{}" in turn; GLSL's own braces need no escaping.
  static std::string substitute(std::string_view format, const std::vector<std::string>& args) {
    std::string text;
    std::size_t next = 0;
    for (std::size_t i = 0; i < format.size(); ++i) {
      if (format.substr(i, 2) == "{}") {
        text += args[next++];
        ++i;
      } else {
        text += format[i];
      }
    }
    return text;
  }

  void open(const std::string& head) {
    line(head.empty() ? "{" : "{} {", head);
    indent_ += 2;
  }
  void close() {
    indent_ -= 2;
    line("}");
  }

  // ---- snippets ----

  std::string function_name(Id<Function> id) const { return fmt::format("function_{}", id.index); }

  void emit_functions() {
    std::size_t next_time_value = 0;
    const bool any_tape = options_.tapes != nullptr && options_.tapes->any();
    out_.uses.tapes = any_tape;
    if (any_tape) out_.functions += tape_walker(*options_.tapes);
    const std::uint32_t lines_of_tape_walker = any_tape ? code_lines(out_.functions) : 0;
    for (std::uint32_t i = 0; i < module_.functions.size(); ++i) {
      const Function& function = module_.functions[i];
      const bool is_tape = any_tape && options_.tapes->functions[i].is_tape;
      const std::string text = is_tape ? tape_call(function_name({i}), options_.tapes->functions[i], next_time_value)
                                       : function.snippet.glsl(function_name({i}), next_time_value);
      function_lines_.push_back(is_tape ? lines_of_tape_walker : code_lines(text));
      function_nesting_ = std::max(function_nesting_, is_tape ? nesting_of_tape_walker : function.snippet.nesting());
      out_.functions += fmt::format("// {}\n{}\n", function.name, text);
      const std::size_t values = function.snippet.time_value_count();
      if (values == 0) continue;
      out_.time_functions.push_back({function.snippet, next_time_value});
      next_time_value += values;
    }
    out_.uses.time = next_time_value != 0;
  }

  /// The thesis' stitching: one function that the walker calls with the number of a snippet.
  void emit_function_switch() {
    if (module_.functions.empty()) return;
    out_.functions += "float call_function(uint function, vec3 q) {\n  float value = 0.0;\n";
    emit_function_choice(0, static_cast<std::uint32_t>(module_.functions.size()), "  ");
    out_.functions += "  return value;\n}\n\n";
  }

  /// By halves: drivers make nested conditions of a switch, as many as it has cases.
  void emit_function_choice(std::uint32_t first, std::uint32_t end, const std::string& indentation) {
    if (end - first == 1) {
      out_.functions += fmt::format("{}value = {}(q);\n", indentation, function_name({first}));
      return;
    }
    const std::uint32_t middle = first + (end - first) / 2;
    out_.functions += fmt::format("{}if (function < {}u) {{\n", indentation, middle);
    emit_function_choice(first, middle, indentation + "  ");
    out_.functions += fmt::format("{}}} else {{\n", indentation);
    emit_function_choice(middle, end, indentation + "  ");
    out_.functions += fmt::format("{}}}\n", indentation);
  }

  // ---- what an object consists of ----

  struct ObjectParts {
    std::vector<Id<Sdf>> sdfs;        ///< different ones, in the order of the tree
    std::vector<Id<Region>> regions;  ///< different ones, in the order of the tree
    std::uint32_t decisions = 0;      ///< of the tree written out, shared subtrees repeated
    std::uint32_t depth = 0;          ///< most decisions on a way through the tree
    bool has_flat_tree = false;       ///< then decisions are written once each, none within another
    std::uint32_t seeded = 0;         ///< of these
    std::uint32_t source_lines = 0;   ///< of snippets and filters
  };

  void collect_objects() {
    parts_.resize(module_.objects.size());
    for (std::size_t i = 0; i < module_.objects.size(); ++i) parts_[i] = collect(module_.objects[i].root);
    for (const Region& region : module_.regions) {
      calls_.emplace_back();
      for (const CandidateGroup& group : region.groups) calls_.back().push_back(called_objects(group));
    }
  }

  /// Visits the tree as it will be written out: a shared subtree counts as often as it is reached.
  ObjectParts collect(Id<Node> root) const {
    ObjectParts parts;
    parts.has_flat_tree = is_deep(root);
    std::set<Id<Node>> visited;
    std::vector<std::pair<Id<Node>, std::uint32_t>> pending{{root, 0}};
    std::set<Id<Sdf>> sdfs;
    std::set<Id<Region>> regions;
    while (!pending.empty() && parts.decisions < most_lines) {
      const auto [node, depth] = pending.back();
      pending.pop_back();
      parts.depth = std::max(parts.depth, depth);
      if (parts.has_flat_tree && !visited.insert(node).second) continue;
      if (const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, node).content)) {
        if (regions.insert(*region).second) parts.regions.push_back(*region);
        continue;
      }
      const auto& decision = std::get<Decision>(at(module_.nodes, node).content);
      ++parts.decisions;
      if (at(module_.sdfs, decision.sdf).placement == voml::Placement::seeded) ++parts.seeded;
      parts.source_lines = saturating_add(parts.source_lines, source_lines(decision.sdf));
      if (sdfs.insert(decision.sdf).second) parts.sdfs.push_back(decision.sdf);
      pending.push_back({decision.negative, depth + 1});
      pending.push_back({decision.positive, depth + 1});
    }
    return parts;
  }

  /// Is there a way of more than deep_tree decisions?
  bool is_deep(Id<Node> root) const {
    std::map<Id<Node>, std::uint32_t> longest;  // ways down to each node reached
    std::vector<std::pair<Id<Node>, std::uint32_t>> pending{{root, 0}};
    while (!pending.empty()) {
      const auto [node, depth] = pending.back();
      pending.pop_back();
      const auto* decision = std::get_if<Decision>(&at(module_.nodes, node).content);
      if (decision == nullptr) continue;
      if (depth + 1 > deep_tree) return true;
      const auto [known, is_new] = longest.try_emplace(node, depth);
      if (!is_new && known->second >= depth) continue;
      known->second = depth;
      pending.push_back({decision->negative, depth + 1});
      pending.push_back({decision->positive, depth + 1});
    }
    return false;
  }

  /// Of an SDF's source, beyond one texture lookup.
  std::uint32_t source_lines(Id<Sdf> sdf) const {
    const auto* function = std::get_if<Id<Function>>(&at(module_.sdfs, sdf).source);
    return function ? function_lines_[function->index] : filter_lines();
  }

  std::uint32_t filter_lines() const {
    if (module_.grids.empty() || grid_atlas_.filter == Filter::hardware) return 0;
    return grid_atlas_.filter == Filter::shader ? lines_of_trilinear : lines_of_tricubic;
  }

  static std::vector<Id<Object>> called_objects(const CandidateGroup& group) {
    std::vector<Id<Object>> called;
    for (const Candidate& candidate : group.candidates) called.push_back(candidate.object);
    std::sort(called.begin(), called.end());
    called.erase(std::unique(called.begin(), called.end()), called.end());
    return called;
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

  // ---- which objects are cut ----

  std::uint32_t own_lines(std::size_t object) const {
    const ObjectParts& parts = parts_[object];
    std::uint64_t lines = 4 + std::uint64_t{parts.source_lines};
    lines += std::uint64_t{parts.decisions - parts.seeded} * lines_of_decision;
    lines += std::uint64_t{parts.seeded} * lines_of_seeded_decision;
    for (const Id<Region> region : parts.regions) lines += at(module_.regions, region).groups.size() * lines_of_group;
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(lines, most_lines));
  }

  /// Lines of each object with everything that it calls inlined, given the cuts.
  std::vector<std::uint32_t> all_inlined_lines(const std::vector<bool>& cut) const {
    std::vector<std::uint32_t> lines(module_.objects.size());
    const std::uint32_t walker_lines = saturating_add(
        lines_of_walker + filter_lines(), std::accumulate(function_lines_.begin(), function_lines_.end(), std::uint64_t{0}));
    for (std::size_t i = module_.objects.size(); i-- > 0;) {
      if (cut[i]) {
        lines[i] = walker_lines;
        continue;
      }
      lines[i] = own_lines(i);
      for (const Id<Region> region : parts_[i].regions) {
        for (const auto& called : calls_[region.index]) {
          bool walks = false;
          for (const Id<Object> child : called) {
            if (!cut[child.index]) lines[i] = saturating_add(lines[i], lines[child.index]);
            walks = walks || cut[child.index];
          }
          if (walks) lines[i] = saturating_add(lines[i], walker_lines);
        }
      }
    }
    return lines;
  }

  std::uint32_t inlined_lines(Id<Object> object) const { return all_inlined_lines(cut_)[object.index]; }

  /// Cuts as little as meets the budget: among the cuts that suffice the one that keeps most specialised code, else the
  /// one that saves most, and so on; at last the root.
  void choose_cuts() {
    cut_.assign(module_.objects.size(), options_.codegen != Codegen::specialised);
    cut_too_deep();
    const std::size_t root = module_.root.index;
    while (!cut_[root]) {
      const std::uint32_t now = all_inlined_lines(cut_)[root];
      if (now <= options_.inlined_line_budget) break;
      std::size_t best = root;
      std::uint32_t best_lines = now;
      for (std::size_t i = 0; i < cut_.size(); ++i) {
        if (cut_[i] || i == root) continue;
        std::vector<bool> with = cut_;
        with[i] = true;
        const std::uint32_t then = all_inlined_lines(with)[root];
        const bool fits = then <= options_.inlined_line_budget;
        const bool best_fits = best_lines <= options_.inlined_line_budget;
        if (fits ? (!best_fits || then > best_lines) : (!best_fits && then < best_lines)) {
          best = i;
          best_lines = then;
        }
      }
      cut_[best] = true;
    }
    mark_needed();
  }

  /// Objects that would be nested too deeply with what they call are cut, the innermost first.
  void cut_too_deep() {
    std::uint32_t halvings = 0;
    while ((std::size_t{1} << halvings) < module_.functions.size()) ++halvings;
    const std::uint32_t walker = nesting_of_walker + halvings + function_nesting_;
    std::vector<std::uint32_t> nested(module_.objects.size());
    for (std::size_t i = nested.size(); i-- > 0;) {
      nested[i] = (parts_[i].has_flat_tree ? nesting_of_flat_tree : parts_[i].depth) + function_nesting_ + 3;
      for (const Id<Region> region : parts_[i].regions) {
        for (const CandidateGroup& group : at(module_.regions, region).groups) {
          const std::uint32_t around = group.candidates.size() > 1 ? nesting_of_group : 0;
          for (const Candidate& candidate : group.candidates)
            nested[i] = std::max(nested[i], around + nested[candidate.object.index]);
        }
      }
      too_deep_.push_back(nested[i] > most_nested);
      if (too_deep_.back()) cut_[i] = true;
      if (cut_[i]) nested[i] = walker;
    }
    std::reverse(too_deep_.begin(), too_deep_.end());
  }

  void mark_needed() {
    needed_.assign(module_.objects.size(), false);
    needed_[module_.root.index] = true;
    for (std::size_t i = 0; i < needed_.size(); ++i) {
      if (!needed_[i] || cut_[i]) continue;
      for (const Id<Region> region : parts_[i].regions) {
        for (const auto& called : calls_[region.index]) {
          for (const Id<Object> child : called) needed_[child.index] = true;
        }
      }
    }
  }

  void describe() {
    for (std::size_t i = 0; i < module_.objects.size(); ++i) {
      const std::string& name = module_.objects[i].name;
      if (options_.codegen == Codegen::table) {
        out_.object_codegen.push_back(name + ": table");
      } else if (options_.codegen == Codegen::thesis) {
        out_.object_codegen.push_back(name + ": thesis");
      } else if (too_deep_[i]) {
        out_.object_codegen.push_back(
            fmt::format("{}: table, specialised code would nest more than {} conditions", name, most_nested));
      } else if (cut_[i]) {
        out_.object_codegen.push_back(
            fmt::format("{}: table, specialised code would exceed {} lines", name, options_.inlined_line_budget));
      } else if (needed_[i]) {
        out_.object_codegen.push_back(name + ": specialised");
      } else {
        out_.object_codegen.push_back(name + ": table, below an object that was cut");
      }
    }
  }

  // ---- distance functions ----

  std::string sdf_name(Id<Sdf> id) const { return fmt::format("negative_{}", id.index); }

  /// `f(local) <= iso` as one expression, the local point being q, or constant(q) if that is given.
  std::string source_test(const Sdf& sdf, const Affine* constant, const std::string& q) {
    if (const auto* function = std::get_if<Id<Function>>(&sdf.source)) {
      const std::string local = constant ? affine_expression(*constant, q, options_.fold_affine) : q;
      return fmt::format("{}({}) <= {}", function_name(*function), local, glsl_float(static_cast<float>(sdf.iso)));
    }
    const auto grid_id = std::get<Id<voml::Grid>>(sdf.source);
    const voml::Grid& grid = at(module_.grids, grid_id);
    out_.uses.grid_atlas = true;
    const Affine atlas = lookup_from_local(grid, grid_id, grid_atlas_);
    const std::string at = affine_expression(constant ? atlas * *constant : atlas, q, options_.fold_affine);
    const std::string iso = glsl_float(static_cast<float>(sdf.iso / grid_atlas_.scales[grid_id.index]));
    if (grid_atlas_.filter != Filter::hardware) return fmt::format("sample_grid({}) <= {}", at, iso);
    return fmt::format("textureLod(grid_atlas, {}, 0.0).r <= {}", at, iso);
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
      case voml::Placement::single: emit_single(sdf); break;
      case voml::Placement::tiled: emit_tiled(sdf); break;
      case voml::Placement::seeded: emit_seeded(id, sdf); break;
    }
    close();
    line("");
  }

  void emit_single(const Sdf& sdf) {
    const Affine& affine = sdf.local_from_object.front();
    const LocalBox box = local_box(sdf, module_);
    if (options_.box_tests && cube_maps_into(affine, box)) {
      line("return {};", source_test(sdf, &affine, "p"));
      return;
    }
    line("vec3 q = {};", affine_expression(affine, "p", options_.fold_affine));
    line("return {} && {};", box_test(box, "q"), source_test(sdf, nullptr, "q"));
  }

  void emit_tiled(const Sdf& sdf) {
    line("vec3 q = wrap_cube({});", affine_expression(sdf.local_from_object.front(), "p", options_.fold_affine));
    line("return {} && {};", box_test(local_box(sdf, module_), "q"), source_test(sdf, nullptr, "q"));
  }

  std::string find_cell(const gpu::LookupRecord& lookup, const std::string& p) {
    out_.uses.lists = true;
    return fmt::format("find_cell({}, {}, {}, uvec3({}u, {}u, {}u), {}u)", p, vec3_literal(glm::dvec3(lookup.lo)),
                       vec3_literal(glm::dvec3(lookup.cells_per_unit)), lookup.size_x, lookup.size_y, lookup.size_z,
                       lookup.first_cell);
  }

  void emit_seeded(Id<Sdf> id, const Sdf& sdf) {
    const gpu::SdfRecord& record = records_.sdfs[id.index];
    out_.uses.placements = true;
    line("uvec2 range = {};", find_cell(record.lookup, "p"));
    line("uint asked = 0u;");
    line("bool negative = false;");
    open("for (uint i = range.x; i < range.y && !negative; ++i)");
    line("++asked;");
    line("vec3 q = apply(placements[{} + lists[i]].local_from_object, p);", fmt::format("{}u", record.first_placement));
    line("negative = {} && {};", box_test(local_box(sdf, module_), "q"), source_test(sdf, nullptr, "q"));
    close();
    line("hit_unfinished = hit_unfinished || (!negative && asked != range.y - range.x);");
    line("return negative;");
  }

  // ---- objects ----

  std::string call(Id<Object> object, const std::string& p, const std::string& level,
                   const std::string& guard = "true") const {
    if (cut_[object.index]) {
      return fmt::format("{}walk({}u, {}, {})", guard == "true" ? "" : "if (" + guard + ") ", object.index, p, level);
    }
    if (guarded_[object.index]) return fmt::format("object_{}({}, {}, {})", object.index, p, level, guard);
    return fmt::format("object_{}({}, {})", object.index, p, level);
  }

  void emit_object(Id<Object> id) {
    const ObjectParts& parts = parts_[id.index];
    for (const Id<Sdf> sdf : parts.sdfs) emit_sdf(sdf);
    line("// {}", at(module_.objects, id).name);
    guard_ = guarded_[id.index] ? "entered" : "";
    open(fmt::format("void object_{}(vec3 p, uint level{})", id.index, guard_.empty() ? "" : ", bool entered"));
    const bool one_region = parts.regions.size() == 1;
    if (!one_region) emit_decisions(at(module_.objects, id).root, parts.has_flat_tree);
    for (const Id<Region> region : parts.regions) emit_candidates(region, one_region);
    emit_own_answer(parts.regions, one_region);
    close();
    line("");
  }

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
    open(fmt::format("if ({}(p))", sdf_name(decision.sdf)));
    emit_tree(decision.negative);
    indent_ -= 2;
    line("} else {");
    indent_ += 2;
    emit_tree(decision.positive);
    close();
  }

  void emit_candidates(Id<Region> id, bool one_region) {
    const Region& region = at(module_.regions, id);
    for (std::size_t g = 0; g < region.groups.size(); ++g) {
      const CandidateGroup& group = region.groups[g];
      const std::uint32_t record = records_.regions[id.index].first_group + static_cast<std::uint32_t>(g);
      line("// {}: {} candidates", region.name, fmt::format("{}", group.candidates.size()));
      const std::string here = guarded(one_region ? "" : fmt::format("region == {}u", id.index));
      const std::string nobody_yet = g == 0 ? "" : "hit_number == 0u";  // nobody is asked once there is an answer
      const std::string asked = here.empty() || nobody_yet.empty() ? here + nobody_yet : here + " && " + nobody_yet;
      if (group.candidates.size() == 1) {
        emit_one_candidate(id, group, asked);
      } else {
        emit_group(id, group, records_.groups[record], asked);
      }
    }
  }

  void emit_group(Id<Region> region, const CandidateGroup& group, const gpu::GroupRecord& record,
                  const std::string& asked) {
    open(asked.empty() ? "" : fmt::format("if ({})", asked));
    if (group.box_from_object) {
      line("vec3 b = {};", affine_expression(*group.box_from_object, "p", options_.fold_affine));
      open("if (in_cube(b))");
    }
    emit_candidate_loop(region, group, record);
    if (group.box_from_object) close();
    close();
  }

  /// The call stands in no condition: a chain of objects, each in the one before, is as deep as one.
  void emit_one_candidate(Id<Region> region, const CandidateGroup& group, const std::string& asked) {
    const Candidate& candidate = group.candidates.front();
    open("");
    std::string enter = asked;
    const auto also = [&](const std::string& condition) { enter += (enter.empty() ? "" : " && ") + condition; };
    if (group.box_from_object) {
      line("vec3 b = {};", affine_expression(*group.box_from_object, "p", options_.fold_affine));
      also("in_cube(b)");
    }
    const std::string q = affine_expression(candidate.local_from_parent, "p", options_.fold_affine);
    line(candidate.tiled ? "vec3 q = wrap_cube({});" : "vec3 q = {};", q);
    if (!candidate.tiled) also("in_cube(q)");
    line("bool enter = {};", enter.empty() ? "true" : enter);
    line("{};", call(candidate.object, "q", "level + 1u", "enter"));
    line("if (enter && hit_number != 0u) came_through({}u, {}u, level);", fmt::format("{}", region.index),
         fmt::format("{}", group.first_number));
    close();
  }

  void emit_candidate_loop(Id<Region> region, const CandidateGroup& group, const gpu::GroupRecord& record) {
    out_.uses.placements = true;
    const bool any_tiled = std::any_of(group.candidates.begin(), group.candidates.end(),
                                       [](const Candidate& candidate) { return candidate.tiled; });
    line("uvec2 range = {};", find_cell(record.lookup, group.box_from_object ? "b" : "p"));
    line("uint asked = 0u;");
    open("for (uint i = range.x; i < range.y && hit_number == 0u; ++i)");
    line("++asked;");
    line("uint c = lists[i];");
    line("vec3 q = apply(placements[{} + c].local_from_object, p);", fmt::format("{}u", record.first_placement));
    if (any_tiled) {
      line("bool tiled = placements[{} + c].tiled != 0u;", fmt::format("{}u", record.first_placement));
      line("if (tiled) q = wrap_cube(q);");
    }
    open(any_tiled ? "if (tiled || in_cube(q))" : "if (in_cube(q))");
    emit_calls(group, record);
    line("if (hit_number != 0u) came_through({}u, {}, level);", fmt::format("{}", region.index),
         group.first_number == 0 ? std::string("c") : fmt::format("{}u + c", group.first_number));
    close();
    close();
    line("hit_unfinished = hit_unfinished || (hit_number == 0u && asked != range.y - range.x);");
  }

  /// One call for each different object of the group; all objects that are cut share one walker.
  void emit_calls(const CandidateGroup& group, const gpu::GroupRecord& record) {
    std::vector<Id<Object>> inlined, walked;
    for (const Id<Object> object : called_objects(group)) (cut_[object.index] ? walked : inlined).push_back(object);
    if (inlined.size() + walked.size() == 1) {
      line("{};", call(inlined.empty() ? walked.front() : inlined.front(), "q", "level + 1u"));
      return;
    }
    line("uint object = placements[{} + c].object;", fmt::format("{}u", record.first_placement));
    // One after the other, not nested in each other's else.
    std::string none;
    for (std::size_t i = 0; i < inlined.size(); ++i) {
      line("if (object == {}u) {};", fmt::format("{}", inlined[i].index), call(inlined[i], "q", "level + 1u"));
      none += fmt::format("{}object != {}u", i == 0 ? "" : " && ", inlined[i].index);
    }
    if (!walked.empty()) line(none.empty() ? "walk(object, q, level + 1u);" : "if ({}) walk(object, q, level + 1u);", none);
  }

  /// Nobody inside answered: the region's own colour counts, unless it is empty.
  void emit_own_answer(const std::vector<Id<Region>>& regions, bool one_region) {
    const bool may_be_found = std::any_of(regions.begin(), regions.end(), [&](Id<Region> region) {
      return !at(module_.regions, region).groups.empty();
    });
    if (one_region) {
      const Region& region = at(module_.regions, regions.front());
      if (region.number == 0) return;
      const std::string condition = guarded(may_be_found ? "hit_number == 0u" : "");
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
         guarded(may_be_found ? "hit_number == 0u && number != 0u" : "number != 0u"));
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
  std::string body_;
  std::size_t indent_ = 0;
  std::vector<std::uint32_t> function_lines_;                // of each function
  std::vector<ObjectParts> parts_;                           // of each object
  std::vector<std::vector<std::vector<Id<Object>>>> calls_;  // of each region and group: the different objects
  std::vector<bool> cut_;
  std::vector<bool> too_deep_;  // of these, for their nesting
  std::vector<bool> guarded_;   // objects whose function has a guard
  std::string guard_;           // of the function that is being written; "" if it has none
  std::vector<bool> needed_;
  std::uint32_t function_nesting_ = 0;
  std::set<Id<Sdf>> emitted_;
};

std::string bindings(const Uses& uses) {
  std::string text;
  const auto sampler = [&](const char* slot, const char* name) {
    text += fmt::format("layout(set = 0, binding = {}) uniform sampler3D {};\n", slot, name);
  };
  const auto buffer = [&](const char* slot, const char* block, const char* type, const char* name) {
    text += fmt::format("layout(set = 0, binding = {}, std430) readonly buffer {} {{ {} {}[]; }};\n", slot, block, type, name);
  };
  if (uses.grid_atlas) sampler("DMVV_BIND_GRID_ATLAS", "grid_atlas");
  if (uses.bitmap_atlas) sampler("DMVV_BIND_BITMAP_ATLAS", "bitmap_atlas");
  if (uses.placements) buffer("DMVV_BIND_PLACEMENTS", "Placements", "PlacementRecord", "placements");
  if (uses.lists) buffer("DMVV_BIND_CELLS", "Cells", "uint", "cells");
  if (uses.lists) buffer("DMVV_BIND_LISTS", "Lists", "uint", "lists");
  if (uses.walker) {
    buffer("DMVV_BIND_NODES", "Nodes", "NodeRecord", "nodes");
    buffer("DMVV_BIND_SDFS", "Sdfs", "SdfRecord", "sdfs");
    buffer("DMVV_BIND_GROUPS", "Groups", "GroupRecord", "groups");
    buffer("DMVV_BIND_OBJECTS", "Objects", "uint", "objects");
  }
  if (uses.tapes) buffer("DMVV_BIND_TAPE_CELLS", "TapeCells", "uint", "tape_cells");
  if (uses.tapes) buffer("DMVV_BIND_TAPES", "Tapes", "uvec2", "tapes");
  if (uses.time) buffer("DMVV_BIND_TIME", "TimeValues", "float", "time_values");
  if (uses.walker || uses.region_colors) buffer("DMVV_BIND_REGIONS", "Regions", "RegionRecord", "regions");
  return text;
}

}  // namespace

Evaluation generate_evaluation(const Module& module, const Records& records, const Atlas& grid_atlas,
                               const GlslOptions& options) {
  return Generator(module, records, grid_atlas, options).run();
}

std::string generate_glsl(const Evaluation& evaluation, std::uint32_t depth, Kernel kernel) {
  const Uses& uses = evaluation.uses;
  const bool own_filter = uses.grid_atlas && evaluation.filter != Filter::hardware;
  std::string text = "#version 460\n";
  text += fmt::format("#define DMVV_DEPTH {}\n", depth);
  if (kernel == Kernel::points) text += "#define DMVV_PATHS\n";
  if (uses.lists) text += "#define DMVV_LISTS\n";
  if (uses.grid_atlas) text += "#define DMVV_GRIDS\n";
  if (own_filter) text += "#define DMVV_FILTER\n";
  if (own_filter && evaluation.filter == Filter::tricubic) text += "#define DMVV_TRICUBIC\n";
  if (!evaluation.functions.empty()) text += "#define DMVV_FUNCTIONS\n";
  text += shader_text::records;
  text += bindings(uses);
  if (kernel == Kernel::pixels) text += shader_text::surface;
  if (kernel == Kernel::pixels) text += shader_text::pixel_io;
  text += shader_text::evaluate;
  if (own_filter) text += shader_text::filter;
  text += evaluation.functions;
  if (uses.walker) text += evaluation.codegen == Codegen::thesis ? shader_text::walk_thesis : shader_text::walk;
  text += "\n// ---- the scene ----\n";
  text += evaluation.glsl;
  text += kernel == Kernel::points ? shader_text::points : shader_text::pixels;
  return text;
}

}  // namespace dmvv::compiler
