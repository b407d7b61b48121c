// Inside compiler: how steep a distance grid is, and how large.
#pragma once

#include <glm/vec3.hpp>

#include "compiler/grids/storage.h"
#include "voml/assets/grid.h"

namespace dmvv::compiler {

/// Largest difference between neighbouring samples along each axis: a Lipschitz bound of the trilinear interpolant in
/// texels; and the largest magnitude of a sample.
struct GridBounds {
  glm::dvec3 slope{0.0};
  double magnitude = 0.0;
};

/// Cost: one pass over the samples.
GridBounds grid_bounds(const voml::Grid& grid);

/// A bound of the Catmull-Rom interpolant's slope over GridBounds::slope (spec/accuracy.md). Along an axis, the
/// derivative is a sum of differences of neighbours whose weights' magnitudes sum to 3/2 at most, the weights' own
/// magnitudes to 5/4 along the two others.
inline constexpr double tricubic_slope = 1.5 * 1.25 * 1.25;

/// Bound of the error, in samples, with which a device looks up a local point that is off by `error`.
glm::dvec3 sample_error(const voml::Grid& grid, const glm::dvec3& error);

/// Bound of the rounding of a filtered value and of its comparison with iso, the point's own error apart.
double filter_error(const GridBounds& bounds, double iso, TexelFormat format, Filter filter);

}  // namespace dmvv::compiler
