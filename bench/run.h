// Runs cases: times, errors against the reference, memory, bytes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/plan.h"
#include "runtime/runtime.h"
#include "session/session.h"

namespace dmvv::bench {

/// Samples of one step, in the order they were taken.
struct Step {
  std::string name;
  std::vector<double> ms;
};

/// Answers held against the reference's. Compared are those that the reference is certain of; of the others it is told
/// how many there are and how many differ.
struct RegionErrors {
  std::size_t compared = 0;
  std::size_t wrong = 0;
  std::size_t uncertain = 0;
  std::size_t uncertain_different = 0;

  double wrong_fraction() const {
    return compared == 0 ? 0.0 : static_cast<double>(wrong) / static_cast<double>(compared);
  }
};

struct Measurement {
  Case what;
  std::string failure;                           ///< why there is nothing else; empty: measured
  std::vector<std::string> validation_messages;  ///< none, or the figures are worth nothing

  // ---- times ----
  std::vector<Step> steps;        ///< of each build: "read", "compile", "SPIR-V", "upload", "pipeline", in this order
  std::size_t settle_frames = 0;  ///< drawn before the timed ones, after the first
  double settle_ms = 0.0;         ///< wall time of these
  std::vector<double> frame_ms;   ///< wall time; the first frame is not among them
  std::vector<double> gpu_ms;     ///< the same frames by the device's time stamps; empty if it has none
  std::vector<double> point_ns;  ///< cost of a point: (t(n) - t(64)) / (n - 64), kernel `points`; n is 262144, or 16384
                                 ///< where that would take over 0.3 s

  // ---- sizes ----
  std::uint64_t upload_bytes = 0;  ///< buffers and textures of the scene
  std::uint64_t peak_bytes = 0;  ///< resident memory of the first build and frame at most, beyond what was there before
  compiler::Statistics statistics;

  // ---- errors ----
  std::optional<RegionErrors> points;  ///< region and path
  std::optional<RegionErrors> pixels;  ///< region
  std::optional<std::size_t>
      differing;  ///< pixels of the last frame whose region is another with all passes of a frame off
  std::optional<double> color_rmse;  ///< of the pixels compared (or of all, with truth_samples); 0..1 a channel
  std::optional<Displacement> displacement;
  std::optional<double> pixel_pitch;  ///< object units between pixel centres of the timed frames (slices only)

  /// From text to the first picture: sum of the steps' medians.
  double build_ms() const;
};

/// The samples of a step; empty if there is none of that name.
std::vector<double> samples_of(const Measurement& measurement, const std::string& step);

struct RunOptions {
  double budget_s = 0.0;  ///< cases that have not begun by then are left out; 0: no limit
  /// Called before each case.
  std::function<void(const Case& next)> progress;
  /// Called after each case with all measurements so far, in order. May be empty.
  std::function<void(const std::vector<Measurement>& so_far)> done;
};

/// Runs the cases in order, one measurement each. A case that fails is a measurement with its reason. Cases that need
/// distance grids are left out where a scene has none. Each case opens a device of its own, and
/// `progress` may change what the driver finds in its cache.
std::vector<Measurement> run_cases(const session::Options& device, const std::vector<Case>& cases,
                                   const RunOptions& options);

}  // namespace dmvv::bench
