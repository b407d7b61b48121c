#include "bench/displacement.h"

#include <algorithm>
#include <cmath>

namespace dmvv::bench {
namespace {

constexpr int halvings = 30;

struct Bracket {
  double inside;
  double outside;
};

}  // namespace

Result<Displacement> measure_displacement(std::span<const SurfacePoint> surface, const Inside& inside, double reach) {
  const auto ask = [&](const auto& offset_of) {
    std::vector<glm::dvec3> points;
    points.reserve(surface.size());
    for (std::size_t i = 0; i < surface.size(); ++i) {
      points.push_back(surface[i].position + offset_of(i) * surface[i].normal);
    }
    return inside(points);
  };
  const auto at_low = ask([&](std::size_t) { return -reach; });
  if (!at_low) return tl::unexpected(at_low.error());
  const auto at_high = ask([&](std::size_t) { return reach; });
  if (!at_high) return tl::unexpected(at_high.error());

  std::vector<Bracket> brackets(surface.size(), {-reach, reach});
  for (int i = 0; i < halvings; ++i) {
    const auto middle = [&](std::size_t k) { return 0.5 * (brackets[k].inside + brackets[k].outside); };
    const auto answers = ask(middle);
    if (!answers) return tl::unexpected(answers.error());
    for (std::size_t k = 0; k < brackets.size(); ++k) {
      ((*answers)[k] != 0 ? brackets[k].inside : brackets[k].outside) = middle(k);
    }
  }

  Displacement found;
  double squares = 0.0;
  for (std::size_t k = 0; k < brackets.size(); ++k) {
    if ((*at_low)[k] == 0 || (*at_high)[k] != 0) {
      ++found.lost;
      continue;
    }
    const double offset = 0.5 * (brackets[k].inside + brackets[k].outside);
    ++found.count;
    found.max = std::max(found.max, std::abs(offset));
    found.mean += offset;
    squares += offset * offset;
  }
  if (found.count != 0) {
    found.mean /= static_cast<double>(found.count);
    found.rms = std::sqrt(squares / static_cast<double>(found.count));
  }
  return found;
}

}  // namespace dmvv::bench
