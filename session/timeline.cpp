#include "session/timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dmvv::session {

namespace {

constexpr double rounding_frames = 1e-6;

double span_frames(const Timeline& timeline) { return (timeline.to_ms - timeline.from_ms) * timeline.fps / 1000.0; }

}  // namespace

std::uint32_t Timeline::count() const {
  return static_cast<std::uint32_t>(std::max(1.0, std::ceil(span_frames(*this) - rounding_frames)));
}

double Timeline::time_ms(std::uint32_t frame) const { return from_ms + frame * 1000.0 / fps; }

Result<Timeline> make_timeline(double from_ms, double to_ms, double fps) {
  const Timeline timeline{from_ms, to_ms, fps};
  if (!std::isfinite(from_ms) || !std::isfinite(to_ms)) return fail(Fault::input, "--from and --to must be finite");
  if (!(to_ms > from_ms)) {
    return fail(Fault::input, fmt::format("--to ({}) must lie after --from ({})", to_ms, from_ms));
  }
  if (!std::isfinite(fps) || fps <= 0) return fail(Fault::input, fmt::format("--fps: {} is not above zero", fps));
  if (!(span_frames(timeline) <= Timeline::max_count)) {
    return fail(
        Fault::input,
        fmt::format("{:.4g} frames are more than the {} there can be", span_frames(timeline), Timeline::max_count),
        {"choose a shorter span or a smaller --fps"});
  }
  return timeline;
}

}  // namespace dmvv::session
