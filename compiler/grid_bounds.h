// Inside compiler: how steep a distance grid is, and how large.
#pragma once

#include <glm/vec3.hpp>

#include "voml/grid.h"

namespace dmvv::compiler {

/// Largest difference between neighbouring samples along each axis: a Lipschitz bound of the trilinear interpolant in
/// texels; and the largest magnitude of a sample.
struct GridBounds {
  glm::dvec3 slope{0.0};
  double magnitude = 0.0;
};

/// Cost: one pass over the samples.
GridBounds grid_bounds(const voml::Grid& grid);

}  // namespace dmvv::compiler
