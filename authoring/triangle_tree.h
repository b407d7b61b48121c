// Triangles -> a bounding volume hierarchy that answers two questions about a point: how far away the surface is, and
// how often it winds around the point.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace dmvv::authoring {

/// Corners, counter-clockwise seen from outside.
using Corners = std::array<glm::dvec3, 3>;

/// A triangle in a frame of its own: origin a, x along its longest edge to b, y towards c, z outwards. In it the
/// corners are (0, 0), (base, 0) and (apex_x, apex_y) with 0 <= apex_x <= base and apex_y >= 0. Slivers and degenerate
/// triangles keep their size to rounding: only the direction of z becomes arbitrary.
class Triangle {
 public:
  explicit Triangle(const Corners& corners);

  /// Squared distance from `p`; any value >= `limit` if it is not below `limit`.
  double squared_distance(const glm::dvec3& p, double limit) const;

  /// The signed solid angle seen from `p`, positive where the triangle is seen from behind; -2 pi .. 2 pi.
  /// Source: van Oosterom and Strackee 1983.
  double solid_angle(const glm::dvec3& p) const;

  Corners corners() const { return {origin_, origin_ + base_ * x_, origin_ + apex_x_ * x_ + apex_y_ * y_}; }
  double area() const { return 0.5 * base_ * apex_y_; }
  glm::dvec3 area_vector() const { return area() * z_; }
  glm::dvec3 centroid() const { return origin_ + (base_ + apex_x_) / 3.0 * x_ + apex_y_ / 3.0 * y_; }

 private:
  glm::dvec3 to_local(const glm::dvec3& p) const;

  glm::dvec3 origin_, x_, y_, z_;
  double base_, apex_x_, apex_y_;
};

/// Immutable; all queries are thread-safe and free of allocation. Coordinates are below 1e18, so that their squares are
/// numbers of float32.
class TriangleTree {
 public:
  /// Needs at least one triangle. Cost: O(n log n); some 200 bytes a triangle.
  explicit TriangleTree(const std::vector<Corners>& triangles);

  /// Number of a triangle in the tree's own order.
  using Index = std::uint32_t;

  const Triangle& triangle(Index index) const { return triangles_[index]; }
  std::size_t triangle_count() const { return triangles_.size(); }
  /// Its number in the list that the tree was made of.
  std::uint32_t given_number(Index index) const { return order_[index]; }

  /// Distance from `p` to the nearest triangle. `guess` is any triangle, the better the faster, and becomes the nearest
  /// one: pass what the last query nearby left there.
  double distance(const glm::dvec3& p, Index& guess) const;
  /// The same where no triangle is known to be near.
  double distance(const glm::dvec3& p) const;

  /// The generalised winding number (Jacobson et al. 2013): for a closed mesh the integer count of shells around `p`.
  /// Clusters of triangles farther than `accuracy` times their radius are replaced by the first two terms of their
  /// expansion (Barill et al. 2018, who suggest 2); nearer ones are summed exactly.
  double winding_number(const glm::dvec3& p, double accuracy = 2.0) const;

  /// The volume that the surface encloses, negative if it is inside out. For an open mesh: taken from the surface's
  /// centre of area.
  double signed_volume() const;

 private:
  struct Node {
    Index first;  ///< of a leaf's triangles; else the second child (the first one is the next node)
    Index count;  ///< of a leaf's triangles; else 0
  };
  /// For distances: a node with its children's children, whose boxes are tested together. Boxes hold what they bound
  /// with some room for the rounding of a query. An absent child's box is infinitely far away.
  struct WideNode {
    float lo[3][4], hi[3][4];
    Index first[4];  ///< of a leaf's triangles; else the wide node
    Index count[4];  ///< of a leaf's triangles; else 0
  };
  /// The far field of a node: a dipole and its first moments about the centre.
  struct Moments {
    glm::dvec3 centre{0.0};                ///< of area
    double radius2 = 0.0;                  ///< squared distance from the centre to the farthest corner
    glm::dvec3 area{0.0};                  ///< sum of the area vectors a
    glm::dvec3 diagonal{0.0}, mixed{0.0};  ///< sum of (c - centre) a^T, symmetric part: xx yy zz, xy+yx yz+zy zx+xz
  };

  Index build(Index begin, Index end);
  Index build_wide(Index begin, Index end, double room);
  Moments moments(Index begin, Index end) const;

  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> order_;  ///< of each triangle its number in the list that was given
  std::vector<Node> nodes_;           ///< depth first
  std::vector<WideNode> wide_nodes_;
  std::vector<Moments> moments_;
};

}  // namespace dmvv::authoring
