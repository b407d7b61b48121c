// Pictures by rays beside the reference's rays.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <mutex>
#include <string>

#include "base/parallel.h"
#include "compiler/program.h"
#include "compiler/rays/ray_reference.h"
#include "runtime/view/frame_setup.h"
#include "runtime/view/picture.h"

namespace dmvv::tests {

/// Root units that a hit may be off beyond what the reference says of its boundary (spec/accuracy.md).
constexpr double hit_error = 1e-5;

struct RayAgreement {
  std::size_t rays = 0, uncertain = 0, doubtful = 0, wrong = 0;
  double largest_error = 0.0;        ///< of a hit, beyond the reference's own
  double largest_color_error = 0.0;  ///< of a premultiplied channel, of rays that are certain
  std::string first;                 ///< the first that is wrong
  void add(const RayAgreement& other) {
    rays += other.rays, uncertain += other.uncertain, doubtful += other.doubtful, wrong += other.wrong;
    largest_error = std::max(largest_error, other.largest_error);
    largest_color_error = std::max(largest_color_error, other.largest_color_error);
    if (first.empty()) first = other.first;
  }
};

inline std::vector<compiler::Cut> cuts_of(const runtime::View& view) {
  std::vector<compiler::Cut> cuts;
  for (const runtime::Plane& plane : view.cuts) cuts.push_back({plane.normal, plane.d});
  return cuts;
}

/// Compares each `every`-th pixel of a picture with regions, depth and doubt.
inline RayAgreement compare_rays(const compiler::RayReference& reference, const compiler::Program& program,
                                 const runtime::View& view, const runtime::Picture& picture, std::size_t every) {
  const runtime::RayFrame frame = runtime::plan_frame_setup(view, program.content, 16384)->rays.value();
  const std::vector<compiler::Cut> cuts = cuts_of(view);
  const std::size_t count = (picture.depth.size() + every - 1) / every;
  RayAgreement sum;
  std::mutex mutex;
  in_parallel(count, [&](std::size_t i) {
    const std::size_t pixel = i * every;
    const double x = double(pixel % view.size_px.x), y = double(pixel / view.size_px.x);
    const glm::dvec3 direction = frame.corner + x * frame.step_x + y * frame.step_y;
    const auto answer = reference.along({frame.eye, direction}, cuts, view.time_ms);
    RayAgreement one;
    one.rays = 1;
    const bool met = !answer.segments.empty();
    if (!answer.certain) {
      one.uncertain = 1;
    } else if (picture.doubt[pixel] != 0) {
      one.doubtful = 1;
    } else {
      const std::uint32_t number = met ? program.regions[answer.segments.front().path.back().region].number : 0;
      const double error = met ? (std::abs(picture.depth[pixel] - answer.depth) - answer.segments.front().t0_error) *
                                     glm::length(direction)
                               : 0.0;
      one.largest_error = picture.regions[pixel] == number ? std::max(error, 0.0) : 0.0;
      if (picture.regions[pixel] != number || !(error <= hit_error)) {
        one.wrong = 1;
        one.first = fmt::format(
            "pixel {:.0f} {:.0f}, ray \"{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\": expected region {} at {}, "
            "got {} at {}",
            x, y, frame.eye.x, frame.eye.y, frame.eye.z, direction.x, direction.y, direction.z, number, answer.depth,
            picture.regions[pixel], picture.depth[pixel]);
      }
    }
    if (one.uncertain == 0 && one.doubtful == 0 && !picture.rgba.empty()) {
      const float* const got = &picture.rgba[4 * pixel];
      for (int channel = 0; channel < 4; ++channel) {
        const double share = channel == 3 ? 1.0 : answer.rgba.a, got_share = channel == 3 ? 1.0 : got[3];
        const double error = std::abs(share * answer.rgba[channel] - got_share * got[channel]);
        one.largest_color_error = std::max(one.largest_color_error, error);
      }
    }
    const std::lock_guard lock(mutex);
    sum.add(one);
  });
  return sum;
}

}  // namespace dmvv::tests
