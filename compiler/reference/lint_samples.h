// Inside compiler: where lint looks at SDFs, and what their samples there tell.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <limits>
#include <map>
#include <vector>

#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// 17 x 17 points on each face of the standard cube.
const std::vector<glm::dvec3>& border_points();

/// 600 points that fill the standard cube evenly (Halton, bases 2, 3, 5).
const std::vector<glm::dvec3>& inner_points();

/// No point of the standard cube is farther than this from one of these points.
inline constexpr double widest_gap = 0.3;

/// Times in milliseconds: 30 in the first 20 s and an hour; the start alone where time has no effect.
const std::vector<double>& lint_times(bool uses_time);

/// The least and the largest value of an SDF's source at all these points, at one time or several.
struct Extremes {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  glm::dvec3 at_least{0.0}, at_most{0.0};
  double least_t_ms = 0.0, most_t_ms = 0.0;
  bool any_nan = false;  ///< or a loop that does not end
};

/// The extremes of each function at each time: sampled once, whoever asks how often.
class SampledFunctions {
 public:
  explicit SampledFunctions(const Module& module) : module_(module) {}

  /// Cost: 2,334 evaluations when it is first asked.
  const Extremes& at(Id<Function> function, double t_ms);

 private:
  const Module& module_;
  std::map<std::pair<std::size_t, double>, Extremes> known_;
};

/// Adds what `more` has seen.
void include(Extremes& all, const Extremes& more);

}  // namespace dmvv::compiler
