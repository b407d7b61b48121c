// Where the evaluation of pixels is divided into stages, kernels of their own: each holds only the code of what its
// pixels have come to, and runs over a dense list of them (Laine, Karras and Aila 2013, "Megakernels considered
// harmful"). On a device that runs all of a kernel's code for each group of points, code in another kernel costs
// nothing.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "compiler/plan/code_plan.h"
#include "compiler/plan/stage_options.h"

namespace dmvv::compiler {

/// The regions that a pixel passes on the way down from the root. From each of them but the last it went on into the
/// single candidate of the region's last group.
using Way = std::vector<Id<Region>>;

/// What stages hold. Stage 0 begins with the root; the others with a group of a way's last region, and go on from
/// there. A pixel is answered or goes on to a stage with a higher number.
struct StagePlan {
  std::map<std::pair<Way, std::size_t>, std::uint32_t>
      numbers;  ///< of the stages that begin there; from 1, in their order

  std::optional<std::uint32_t> stage_at(const Way& way, std::size_t group) const;
};

/// Divides before groups whose candidates have much code: where the root, or an object that is embedded in this way,
/// has several regions, before all groups of one of them together. At most DMVV_MOST_STAGES, else only before those of
/// most code. Empty where nothing is divided. Cost: linear in regions.
StagePlan plan_stages(const Module& module, const CodePlan& code, const StageOptions& options);

/// The object that stands in a constant place of its own behind all else in a region, if there is one that is code.
std::optional<Id<Object>> last_object(const Module& module, const CodePlan& code, Id<Region> region);

}  // namespace dmvv::compiler
