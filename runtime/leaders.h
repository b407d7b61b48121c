// Inside the runtime only: whether it pays to ask leaders first how far their answers hold.
#pragma once

#include <algorithm>
#include <cstdint>

#include "shaders/records.h"

namespace dmvv::runtime {

/// Pixels evaluated in a frame, however they were listed.
inline std::uint32_t evaluated_pixels(const gpu::PixelListHeader& counted, bool with_leaders) {
  const auto& counts = counted.counts;
  return with_leaders ? counts[DMVV_LEADERS_OF_TILES] + counts[DMVV_LEFT] : counts[DMVV_TO_EVALUATE];
}

/// Rent or buy: their kernel is made when frames without it have taken as long as the driver took to compile the other one.
/// Where too few pixels followed, the next frames do without, more and more of them.
class Leaders {
 public:
  /// What compiling a kernel of this scene takes.
  void set_cost(double compile_ms) { compile_ms_ = compile_ms; }

  /// Are leaders asked in the next frame?
  bool begin_frame() {
    if (spent_ms_ < compile_ms_) return false;
    if (pause_ == 0) return true;
    --pause_;
    return false;
  }
  /// After a frame that took `ms`.
  void end_frame(const gpu::PixelListHeader& counted, double ms, bool asked) {
    spent_ms_ += ms;
    if (!asked) return;
    const double others = counted.counts[DMVV_TO_EVALUATE], followed = others - counted.counts[DMVV_LEFT];
    const bool paid = followed >= share_that_pays * others;
    if (!paid) pause_ = next_pause_;
    next_pause_ = paid ? 1 : std::min(2 * next_pause_, longest_pause);
  }

 private:
  // A leader costs half as much again as another pixel, and to look whether a pixel follows costs a tenth of evaluating it.
  static constexpr double share_that_pays = 0.2;
  static constexpr std::uint32_t longest_pause = 64;

  double compile_ms_ = 0.0, spent_ms_ = 0.0;
  std::uint32_t pause_ = 0, next_pause_ = 1;
};

}  // namespace dmvv::runtime
