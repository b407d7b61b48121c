#include "compiler/plan/stage_plan.h"

#include <algorithm>
#include <numeric>

#include "shaders/records.h"

namespace dmvv::compiler {

namespace {

class Planning {
 public:
  Planning(const Module& module, const CodePlan& code, std::uint32_t least_lines)
      : module_(module), code_(code), least_lines_(least_lines) {}

  StagePlan run() {
    if (!code_.cut[module_.root.index]) enter({}, module_.root);
    std::uint32_t number = 0;
    for (auto& stage : plan_.numbers) stage.second = ++number;  // in the map's order, what follows comes later
    return std::move(plan_);
  }

 private:
  void enter(const Way& way, Id<Object> object) {
    const std::vector<Id<Region>>& regions = code_.parts[object.index].regions;
    for (const Id<Region> region : regions) {
      Way there = way;
      there.push_back(region);
      if (regions.size() == 1) {
        search(there, 0);
      } else if (lines_of(region) >= least_lines_) {
        divide(there, 0);
      }
    }
  }

  /// From a group on, in a region that its pixels have come to.
  void search(const Way& way, std::size_t first) {
    const auto& groups = at(module_.regions, way.back()).groups;
    for (std::size_t g = first; g < groups.size(); ++g) {
      if (groups[g].candidates.size() > 1 && code_.group_lines[way.back().index][g] >= least_lines_) divide(way, g);
    }
    if (const auto object = last_object(module_, code_, way.back())) enter(way, *object);
  }

  void divide(const Way& way, std::size_t group) {
    if (plan_.numbers.try_emplace({way, group}, 0).second) search(way, group + 1);
  }

  std::uint64_t lines_of(Id<Region> region) const {
    const auto& lines = code_.group_lines[region.index];
    return std::accumulate(lines.begin(), lines.end(), std::uint64_t{0});
  }

  const Module& module_;
  const CodePlan& code_;
  std::uint32_t least_lines_;
  StagePlan plan_;
};

}  // namespace

std::optional<std::uint32_t> StagePlan::stage_at(const Way& way, std::size_t group) const {
  const auto found = numbers.find({way, group});
  return found == numbers.end() ? std::nullopt : std::optional(found->second);
}

std::optional<Id<Object>> last_object(const Module& module, const CodePlan& code, Id<Region> region) {
  const auto& groups = at(module.regions, region).groups;
  if (groups.empty() || groups.back().candidates.size() != 1) return std::nullopt;
  const Candidate& candidate = groups.back().candidates.front();
  return candidate.tiled || code.cut[candidate.object.index] ? std::nullopt : std::optional(candidate.object);
}

StagePlan plan_stages(const Module& module, const CodePlan& code, const StageOptions& options) {
  if (code.inlined_lines < options.least_program_lines) return {};
  std::uint32_t least_lines = std::max(1u, options.least_lines);
  StagePlan plan = Planning(module, code, least_lines).run();
  for (; plan.numbers.size() >= DMVV_MOST_STAGES; least_lines *= 2) plan = Planning(module, code, least_lines).run();
  return plan;
}

}  // namespace dmvv::compiler
