// Device values are what a device reads of time values over a span of time, as intervals.
#pragma once

#include <vector>

#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/time_values.h"

namespace dmvv::compiler::snippet {

/// What a device reads as `hoisted` at the times of an interval, and what it stands for: the value in double and its
/// rounding to float32. A reduced value stands for itself, whole periods apart.
/// Cost: the instructions of the slots, in intervals; at a single time in double.
std::vector<BoxValue> device_values(const TimeSplit& split, const Interval& t_ms);

}  // namespace dmvv::compiler::snippet
