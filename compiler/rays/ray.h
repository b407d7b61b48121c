// A ray, and what it meets in a scene: the meaning that every way to draw with rays must agree with.
#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <vector>

#include "compiler/ir/legend.h"

namespace dmvv::compiler {

/// Points origin + t * direction with t >= 0, root coordinates. All numbers are finite, the direction is not zero; it
/// need not be a unit vector: t counts directions.
struct Ray {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};
};

/// Half of space is taken away: the points with dot(normal, p) > d.
struct Cut {
  glm::dvec3 normal{0.0};
  double d = 0.0;
};

/// A piece of a ray on which one region answers by one path.
struct RaySegment {
  double t0 = 0.0, t1 = 0.0;
  std::vector<PathStep> path;  ///< never empty
  /// How far from t0 and t1 a device may find the boundary: nearer than that nothing is proven.
  double t0_error = 0.0, t1_error = 0.0;
  /// Whether every device finds this segment: beyond those errors the answers on both sides are proven, and between
  /// them lies one change. Pieces shorter than 2^-17 root units are not counted.
  bool certain = true;
};

struct RayAnswer {
  std::vector<RaySegment> segments;  ///< in order; the last one may be opaque: it ends where the ray leaves the region
  glm::dvec4 rgba{0.0};              ///< straight alpha; 0 where nothing is seen
  double depth = std::numeric_limits<double>::infinity();  ///< t of the first segment; infinite where nothing is
  bool certain = true;  ///< every segment is, and between them there is proven to be nothing
};

}  // namespace dmvv::compiler
