// Stress cases: scenes and points where float32, drivers and data structures are pushed to their limits; each case
// measures one figure and says what it must be (spec/accuracy.md, "Limits").
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "runtime/runtime.h"

namespace dmvv::stress {

struct Case {
  std::string name;     ///< "deep/0.5 x 40: wrong answers"
  std::string what;     ///< one sentence
  double measured = 0;  ///< in `unit`
  double bound = 0;     ///< what it must not exceed, or, if at_least, fall below
  bool at_least = false;
  std::string unit;    ///< "points", "share", "levels", "2^-24", ...
  std::string detail;  ///< the first thing that went wrong, or where it is; may be empty
  bool held = false;
};

struct Options {
  bool long_form = false;  ///< more points, all decades, 10^6 seeds: minutes instead of seconds
};

/// Runs every case on the reference and on a device, with each form of generated code; `done` is called after each
/// case. Device messages (validation) are the caller's to look at. Errors: what the device or a driver refuses; a scene
/// that does not compile is a case that does not hold.
/// Cost: some 20 s on two cores, or minutes.
Result<std::vector<Case>> run(runtime::Device& device, const Options& options,
                              const std::function<void(const Case&)>& done = {});

}  // namespace dmvv::stress
