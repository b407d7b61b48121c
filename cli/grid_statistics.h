// What a distance grid's values say of it: only its zero set may be trusted until this is known (spec/lxn.md).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "voml/assets/grid.h"

namespace dmvv::cli {

struct GridStatistics {
  float least = 0, greatest = 0;
  double share_inside = 0;       ///< of the samples: value <= 0
  glm::dvec3 lipschitz{0.0};     ///< greatest |df/dx|, |df/dy|, |df/dz| of the trilinear interpolant, cube units
  double greatest_gradient = 0;  ///< bound of the gradient's norm: of each cell's greatest slopes together
};

/// Exact for the slopes: a trilinear interpolant's partial derivatives are greatest along the edges of its cells.
/// Cost: linear in the values.
GridStatistics measure(const voml::Grid& grid);

}  // namespace dmvv::cli
