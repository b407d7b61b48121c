// What an evaluation is expected to cost on a device, as code and over records: which form an object gets (--codegen
// auto).
#pragma once

#include <cstdint>
#include <vector>

#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// What a device takes for each kind of work, in nanoseconds a point, all of the device being busy. Only the ratios
/// matter.
struct DeviceCosts {
  double line = 0.07;   ///< a line of straight-line code
  double sample = 2.3;  ///< a value of a distance grid, and the decision on it
  double search = 0.7;  ///< asking whether a candidate's cube holds the point: entry, placement and test
  double step = 15.0;   ///< a decision of the walker, without its source of distances
  double visit = 15.0;  ///< a round of the walker around that: a candidate asked, a group opened, an object left
  /// Share of the code behind a false condition that is not paid for: 0 where every branch is executed (lavapipe), near
  /// 1 where a group of points that agree skips it.
  double skipping = 0.0;
  friend bool operator==(const DeviceCosts&, const DeviceCosts&) = default;
};

/// As session::calibrate measures lavapipe (Mesa 22.3.6) on 2 cores: the defaults.
DeviceCosts costs_of_cpu();
/// What a GPU is taken to cost where nothing was measured: branches skip, and walking costs latency.
DeviceCosts costs_of_gpu();

/// What a point in an object's cube is expected to cost in either form, with all that the object embeds.
struct ObjectCost {
  double specialised = 0.0;
  double walked = 0.0;
};

struct SourceSizes;

/// Expects what each object costs, what it embeds being in the form that costs less. A point meets as many of a group's
/// candidates as their volumes fill; it is walked along the most expensive way. Cost: linear in nodes and candidates.
std::vector<ObjectCost> expected_costs(const Module& module, const SourceSizes& sizes,
                                       const std::vector<Id<Object>>& alike, const DeviceCosts& device);

}  // namespace dmvv::compiler
