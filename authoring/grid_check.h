// How far a distance grid is from the exact surface that it was made from.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "authoring/bake.h"
#include "authoring/distance_grid.h"

namespace dmvv::authoring {

/// Magnitudes over a number of points.
struct Errors {
  std::size_t points = 0;
  double greatest = 0.0;
  double root_mean_square = 0.0;
  glm::dvec3 where{0.0};  ///< of the greatest
};

/// All lengths in units of the standard cube, whose edge is 2. g(p) is the grid as scenes sample it: trilinear,
/// clamped.
struct GridCheck {
  double voxel = 0.0;  ///< longest edge
  /// At points of the exact boundary, spread evenly over its area: |g|, the exact distance being zero there. For values
  /// that are no distances |g| over the slope of the exact field (its greater change over a voxel, forth or back, along
  /// each axis): how far off the grid's boundary is, to first order.
  Errors surface;
  /// Share of the points drawn on a mesh that bound nothing: both sides of them are solid, or neither is. They are left
  /// out of `surface`.
  double bounding_nothing = 0.0;
  /// |value - exact| at samples drawn at random, and |g - exact| at points spread evenly between the outermost samples.
  /// Not measured where the exact value is not known: distances to a field's boundary.
  std::optional<Errors> samples, between;
  /// At those points: g and the exact value on different sides of zero. Errors::greatest is the exact distance of such
  /// a point to the boundary (the value over the slope, as above).
  Errors wrong_side;
  std::size_t side_points = 0;
  /// Share of the exact boundary near which (within a voxel; spec/lxn.md) the grid has none: thin parts and narrow
  /// gaps, which no sample lies in. Counted at the points of `surface`.
  double boundary_lost = 0.0;
  /// If that is more than 1 %: a resolution that would keep 99 % (its grid's samples were computed near those points),
  /// the least one to some 3 %; 0 if 8192 does not. For distances to a field's boundary the field's own values stand
  /// for them.
  std::optional<std::uint32_t> resolution_needed;
};

/// Against a mesh placed as `report` says. Exact: the distance to the nearest triangle, negative where the winding
/// number exceeds 1/2 (with clusters opened up to 4 times their radius). The same input gives the same result. Cost:
/// `points` times four queries; where more than 1 % of the boundary is lost, some 100 times that.
GridCheck check_grid(const voml::Grid& grid, const voml::Mesh& mesh, const GridReport& report,
                     std::size_t points = 20000);

/// Against the field that it was baked from, with the same options. Points of its boundary are roots on random lines
/// through the box, searched in steps of half a voxel, and of 1/128 voxel where the field's change along the line
/// allows for two roots in a step: what is thinner can be missed. Cost: some `points` times 5 evaluations a voxel of
/// the grid's longest side; where more than 1 % of the boundary is lost, some thousand more a point.
GridCheck check_grid(const voml::Grid& grid, const Field& field, const BakeOptions& options,
                     std::size_t points = 20000);

}  // namespace dmvv::authoring
