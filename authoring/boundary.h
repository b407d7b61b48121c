// Private to authoring: points of an exact boundary, and how much of it a grid of some resolution keeps.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "authoring/triangle_tree.h"
#include "voml/assets/grid.h"
#include "voml/assets/mesh.h"

namespace dmvv::authoring {

/// What a grid holds samples of: negative inside. Thread-safe.
using SignedValue = std::function<double(const glm::dvec3&)>;

/// A point of a boundary, and the direction of length 1 towards the outside.
struct BoundaryPoint {
  glm::dvec3 p, outward;
};

/// The solid that a closed surface, or nearly one, winds around. A surface that is inside out is turned back.
class Solid {
 public:
  explicit Solid(const TriangleTree& tree) : tree_(tree), orientation_(tree.signed_volume() < 0.0 ? -1.0 : 1.0) {}

  /// Where the winding number exceeds 1/2; `accuracy` as in TriangleTree::winding_number.
  bool holds(const glm::dvec3& p, double accuracy) const {
    return orientation_ * tree_.winding_number(p, accuracy) > 0.5;
  }
  double signed_distance(const glm::dvec3& p, double accuracy) const {
    return holds(p, accuracy) ? -tree_.distance(p) : tree_.distance(p);
  }

  /// Points spread evenly over the area of all triangles, but for those that bound nothing: solid on both sides at the
  /// distance `beside`, or on neither; their share goes to `bounding_nothing`. The same in every run.
  std::vector<BoundaryPoint> boundary(std::size_t points, double beside, double& bounding_nothing) const;

 private:
  const TriangleTree& tree_;
  double orientation_;
};

/// The share of the points near which a grid has no boundary. It has one if its trilinear interpolation is <= 0
/// somewhere within a voxel on the inner side and > 0 somewhere within a voxel on the outer side, each looked for in
/// steps of 1/16 voxel along the normal and eight directions around it, so that rounded edges count as kept. Outside
/// its box a grid is positive. The samples are grid.values or, for a grid without, those that `value` would give it.
double share_lost(const voml::Grid& grid, const SignedValue& value, std::span<const BoundaryPoint> points);

/// The finest resolution that is tried, beyond what a grid can have.
inline constexpr std::uint32_t finest_resolution_tried = 8192;

/// A resolution above `from` whose grid over `box` and its padding keeps 99 % of the boundary, to some 3 % the least
/// one: found by halves, measured with the samples that such a grid would have. 0 if the finest one tried does not.
/// Cost: up to some 20 times 16 samples a point, 200 where the boundary is lost.
std::uint32_t resolution_that_keeps_most(const voml::Bounds& box, double padding, std::uint32_t from,
                                         const SignedValue& value, std::span<const BoundaryPoint> points);

}  // namespace dmvv::authoring
