// The value of a distance grid at a point, in double.
#pragma once

#include <glm/vec3.hpp>

#include "voml/assets/grid.h"

namespace dmvv::compiler {

/// Trilinear sample of a grid at a point of the standard cube, cell-centred, clamped to the outer centres.
double sample(const voml::Grid& grid, const glm::dvec3& q);

/// Catmull-Rom (tricubic, 64 samples) at a point of the grid's box, cell-centred; beyond the edge the outer samples
/// repeat. Equal to the samples at their centres, once continuously differentiable.
/// Source: Keys 1981, "Cubic convolution interpolation for digital image processing", a = -1/2.
double sample_tricubic(const voml::Grid& grid, const glm::dvec3& q);

}  // namespace dmvv::compiler
