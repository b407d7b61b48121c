// How far a boundary, as it is evaluated, lies from where it should be. Knows nothing of what evaluates it.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/result.h"

namespace dmvv::bench {

/// A point of the true surface and its outward unit normal.
struct SurfacePoint {
  glm::dvec3 position;
  glm::dvec3 normal;
};

/// Whether points are inside (1) or outside (0), all at once.
using Inside = std::function<Result<std::vector<char>>(std::span<const glm::dvec3>)>;

/// Distances along the true normal from the true surface to the evaluated one, outward positive; in object units.
struct Displacement {
  std::size_t count = 0;  ///< points whose boundary was found
  std::size_t lost = 0;   ///< points without a change from inside to outside within the reach
  double max = 0.0;       ///< largest magnitude
  double rms = 0.0;
  double mean = 0.0;  ///< signed: a shift of the whole surface shows here
};

/// Finds the boundary near each surface point by bisection between -reach and +reach along the normal, 30 halvings: to
/// 1e-9 of the reach, finer than the float32 coordinates at which a device evaluates (6e-8).
/// Where the boundary crosses the line more than once, one of the crossings is found.
/// Cost: 32 calls with one point a surface point.
Result<Displacement> measure_displacement(std::span<const SurfacePoint> surface, const Inside& inside, double reach);

}  // namespace dmvv::bench
