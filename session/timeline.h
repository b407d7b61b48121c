// A timeline says how many frames an animation has, and when each of them is (spec/animate.md). Pure.
#pragma once

#include <cstdint>

#include "base/result.h"

namespace dmvv::session {

/// Frames at even distances in [from, to). All values are finite, to > from, fps > 0, at most max_count frames.
struct Timeline {
  static constexpr std::uint32_t max_count = 10'000'000;

  double from_ms;
  double to_ms;
  double fps;

  /// ceil((to - from) * fps / 1000), at least 1; a frame within a millionth of a frame of `to` is not there, so that
  /// rounding adds none.
  std::uint32_t count() const;
  /// from + i * 1000 / fps
  double time_ms(std::uint32_t frame) const;
};
Result<Timeline> make_timeline(double from_ms, double to_ms, double fps);

}  // namespace dmvv::session
