#include "compiler/plan/code_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "compiler/plan/codegen.h"

namespace dmvv::compiler {

namespace {

// Lines that the parts of a shader take after inlining; counted on generated text.
constexpr std::uint32_t lines_of_decision = 8;
constexpr std::uint32_t lines_of_seeded_decision = 22;
constexpr std::uint32_t lines_of_group = 26;
constexpr std::uint32_t lines_of_walker = 110;
constexpr double surely = 1.5;                  // times cheaper that walking must be expected to be
constexpr std::uint32_t most_own_lines = 8000;  // of one object that is written out at all
constexpr std::uint32_t most_lines = 1u << 24;  // sums saturate here: shared subtrees can count exponentially
// lavapipe ignores, in silence, conditions that stand inside more than 80 others, after inlining; lowering early exits
// adds some.
constexpr std::uint32_t most_nested = 48;
constexpr std::uint32_t deep_tree = 16;  // decisions on a way; deeper trees are written without nesting
constexpr std::uint32_t nesting_of_flat_tree = 2;
constexpr std::uint32_t nesting_of_group = 6;  // of a loop over candidates
constexpr std::uint32_t nesting_of_walker = 8;

std::uint32_t saturating_add(std::uint32_t a, std::uint64_t b) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(a + b, most_lines));
}

class Planning {
 public:
  Planning(const Module& module, const SourceSizes& sizes, const std::vector<Id<Object>>& alike,
           const PlanOptions& options)
      : module_(module), sizes_(sizes), alike_(alike), options_(options) {}

  CodePlan run() {
    collect_objects();
    choose_cuts();
    mark_needed();
    describe();
    measure();
    return std::move(plan_);
  }

 private:
  void collect_objects() {
    plan_.parts.resize(module_.objects.size());
    for (std::size_t i = 0; i < module_.objects.size(); ++i) plan_.parts[i] = collect(module_.objects[i].root);
    for (const Region& region : module_.regions) {
      plan_.calls.emplace_back();
      counted_.emplace_back();
      for (const CandidateGroup& group : region.groups) {
        plan_.calls.back().push_back(called_objects(group));
        std::set<Id<Object>> counted;
        for (const Id<Object> object : plan_.calls.back().back()) counted.insert(alike_[object.index]);
        counted_.back().emplace_back(counted.begin(), counted.end());
      }
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
    return function ? sizes_.function_lines[function->index] : sizes_.filter_lines;
  }

  static std::vector<Id<Object>> called_objects(const CandidateGroup& group) {
    std::vector<Id<Object>> called;
    for (const Candidate& candidate : group.candidates) called.push_back(candidate.object);
    std::sort(called.begin(), called.end());
    called.erase(std::unique(called.begin(), called.end()), called.end());
    return called;
  }

  std::uint32_t own_lines(std::size_t object) const {
    const ObjectParts& parts = plan_.parts[object];
    std::uint64_t lines = 4 + std::uint64_t{parts.source_lines};
    lines += std::uint64_t{parts.decisions - parts.seeded} * lines_of_decision;
    lines += std::uint64_t{parts.seeded} * lines_of_seeded_decision;
    for (const Id<Region> region : parts.regions) lines += at(module_.regions, region).groups.size() * lines_of_group;
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(lines, most_lines));
  }

  /// Lines of each object with everything that it calls inlined, given the cuts.
  std::vector<std::uint32_t> all_inlined_lines(const std::vector<bool>& cut) const {
    std::vector<std::uint32_t> lines(module_.objects.size());
    const std::uint32_t walker_lines =
        saturating_add(lines_of_walker + sizes_.filter_lines,
                       std::accumulate(sizes_.function_lines.begin(), sizes_.function_lines.end(), std::uint64_t{0}));
    for (std::size_t i = module_.objects.size(); i-- > 0;) {
      if (cut[i]) {
        lines[i] = walker_lines;
        continue;
      }
      lines[i] = own_lines(i);
      for (const Id<Region> region : plan_.parts[i].regions) {
        for (const auto& called : counted_[region.index]) {
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

  void choose_cuts() {
    const bool only_records = options_.codegen == Codegen::table || options_.codegen == Codegen::thesis;
    plan_.cut.assign(module_.objects.size(), only_records);
    if (options_.codegen == Codegen::automatic) cut_what_walks_cheaper();
    cut_too_deep();
    for (std::size_t i = 0; i < plan_.cut.size(); ++i) plan_.cut[i] = plan_.cut[i] || own_lines(i) > most_own_lines;
    const std::size_t root = module_.root.index;
    while (!plan_.cut[root]) {
      const std::uint32_t now = all_inlined_lines(plan_.cut)[root];
      if (now <= options_.inlined_line_budget) break;
      std::size_t best = root;
      std::uint32_t best_lines = now;
      for (std::size_t i = 0; i < plan_.cut.size(); ++i) {
        if (plan_.cut[i] || i == root || alike_[i].index != i) continue;
        const std::uint32_t then = all_inlined_lines(with_cut(i))[root];
        const bool fits = then <= options_.inlined_line_budget;
        const bool best_fits = best_lines <= options_.inlined_line_budget;
        if (fits ? (!best_fits || then > best_lines) : (!best_fits && then < best_lines)) {
          best = i;
          best_lines = then;
        }
      }
      plan_.cut = with_cut(best);
    }
  }

  /// The cuts and one more: of an object and those that share its code.
  std::vector<bool> with_cut(std::size_t object) const {
    std::vector<bool> cut = plan_.cut;
    for (std::size_t i = 0; i < cut.size(); ++i) cut[i] = cut[i] || alike_[i] == alike_[object];
    return cut;
  }

  /// Only where the model is sure: its figures are rough, and the first walked object brings the walker along.
  void cut_what_walks_cheaper() {
    costs_ = expected_costs(module_, sizes_, alike_, options_.costs);
    for (std::size_t i = 0; i < costs_.size(); ++i) plan_.cut[i] = walks_cheaper(i);
  }

  bool walks_cheaper(std::size_t object) const {
    return !costs_.empty() && costs_[object].walked * surely < costs_[object].specialised;
  }

  /// Objects that would be nested too deeply with what they call are cut, the innermost first.
  void cut_too_deep() {
    std::uint32_t halvings = 0;
    while ((std::size_t{1} << halvings) < module_.functions.size()) ++halvings;
    const std::uint32_t walker = nesting_of_walker + halvings + sizes_.function_nesting;
    std::vector<std::uint32_t> nested(module_.objects.size());
    for (std::size_t i = nested.size(); i-- > 0;) {
      nested[i] =
          (plan_.parts[i].has_flat_tree ? nesting_of_flat_tree : plan_.parts[i].depth) + sizes_.function_nesting + 3;
      for (const Id<Region> region : plan_.parts[i].regions) {
        for (const CandidateGroup& group : at(module_.regions, region).groups) {
          const std::uint32_t around = group.candidates.size() > 1 ? nesting_of_group : 0;
          for (const Candidate& candidate : group.candidates)
            nested[i] = std::max(nested[i], around + nested[candidate.object.index]);
        }
      }
      too_deep_.push_back(nested[i] > most_nested);
      if (too_deep_.back()) plan_.cut[i] = true;
      if (plan_.cut[i]) nested[i] = walker;
    }
    std::reverse(too_deep_.begin(), too_deep_.end());
  }

  void mark_needed() {
    plan_.needed.assign(module_.objects.size(), false);
    plan_.needed[module_.root.index] = true;
    for (std::size_t i = 0; i < plan_.needed.size(); ++i) {
      if (!plan_.needed[i] || plan_.cut[i]) continue;
      for (const Id<Region> region : plan_.parts[i].regions) {
        for (const auto& called : plan_.calls[region.index]) {
          for (const Id<Object> child : called) plan_.needed[child.index] = true;
        }
      }
    }
  }

  void measure() {
    const std::vector<std::uint32_t> lines = all_inlined_lines(plan_.cut);
    plan_.inlined_lines = lines[module_.root.index];
    for (const auto& groups : counted_) {
      plan_.group_lines.emplace_back();
      for (const auto& called : groups) {
        std::uint32_t sum = 0;
        for (const Id<Object> object : called) sum = saturating_add(sum, lines[object.index]);
        plan_.group_lines.back().push_back(sum);
      }
    }
  }

  void describe() {
    for (std::size_t i = 0; i < module_.objects.size(); ++i) plan_.object_forms.push_back(form_of_object(i));
  }

  std::string form_of_object(std::size_t i) const {
    if (options_.codegen == Codegen::table) return "table";
    if (options_.codegen == Codegen::thesis) return "thesis";
    if (too_deep_[i]) return fmt::format("table, specialised code would nest more than {} conditions", most_nested);
    if (walks_cheaper(i)) {
      return fmt::format("table, {:.0f} ns a point expected in place of {:.0f}", costs_[i].walked,
                         costs_[i].specialised);
    }
    if (plan_.cut[i]) return fmt::format("table, specialised code would exceed {} lines", options_.inlined_line_budget);
    return plan_.needed[i] ? "specialised" : "table, below an object that was cut";
  }

  const Module& module_;
  const SourceSizes& sizes_;
  const std::vector<Id<Object>>& alike_;
  const PlanOptions& options_;
  std::vector<std::vector<std::vector<Id<Object>>>> counted_;  // as plan_.calls, one of each that share their code
  std::vector<bool> too_deep_;                                 // objects that are cut for their nesting
  std::vector<ObjectCost> costs_;                              // of each object, for Codegen::automatic
  CodePlan plan_;
};

}  // namespace

bool CodePlan::walks() const { return std::find(cut.begin(), cut.end(), true) != cut.end(); }

CodePlan plan_code(const Module& module, const SourceSizes& sizes, const std::vector<Id<Object>>& alike,
                   const PlanOptions& options) {
  return Planning(module, sizes, alike, options).run();
}

}  // namespace dmvv::compiler
