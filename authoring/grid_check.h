// How far a distance grid is from the exact surface that it was made from.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "authoring/distance_grid.h"
#include "authoring/bake.h"

namespace dmvv::authoring {

/// Magnitudes over a number of points.
struct Errors {
  std::size_t points = 0;
  double greatest = 0.0;
  double root_mean_square = 0.0;
  glm::dvec3 where{0.0};  ///< of the greatest
};

/// All lengths in units of the standard cube, whose edge is 2. g(p) is the grid as scenes sample it: trilinear, clamped.
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
  /// At those points: g and the exact value on different sides of zero. Errors::greatest is the exact distance of such a
  /// point to the boundary (the value over the slope, as above).
  Errors wrong_side;
  std::size_t side_points = 0;
};

/// Against a mesh placed as `report` says. Exact: the distance to the nearest triangle, negative where the winding number
/// exceeds 1/2 (with clusters opened up to 4 times their radius). The same input gives the same result.
/// Cost: `points` times four queries.
GridCheck check_grid(const voml::Grid& grid, const voml::Mesh& mesh, const GridReport& report,
                     std::size_t points = 20000);

/// Against a field; `distance` as in BakeOptions. Points of its boundary are roots on random lines through the box,
/// searched in steps of half a voxel: what is thinner can be missed.
/// Cost: some `points` times 5 evaluations a voxel of the grid's longest side at most.
GridCheck check_grid(const voml::Grid& grid, const Field& field, bool distance, std::size_t points = 20000);

}  // namespace dmvv::authoring
