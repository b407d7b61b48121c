#include "compiler/grids/grid_bounds.h"

#include <algorithm>
#include <cmath>

#include "compiler/grids/storage.h"
#include "compiler/grids/texels.h"
#include "compiler/ir/rounding.h"

namespace dmvv::compiler {

namespace {

// A grid may lie anywhere in an atlas of up to this many texels: bound of the texel error of a normalised coordinate.
constexpr double atlas_texels = 2048.0;
// Weights good to 8u, four products and three sums: 40u of the largest sample at each of three levels, magnified 5/4
// times by the levels above.
constexpr double tricubic_roundings = 256.0;
constexpr double trilinear_roundings = 8.0;
constexpr double normalised_roundings =
    4.0;  // a normalised texel is converted by the device, and compared with iso / scale

}  // namespace

GridBounds grid_bounds(const voml::Grid& grid) {
  const std::size_t nx = grid.size.x, ny = grid.size.y, nz = grid.size.z;
  const float* v = grid.values.data();
  float slope[3] = {0, 0, 0};
  float magnitude = 0;
  for (std::size_t z = 0, i = 0; z < nz; ++z) {
    for (std::size_t y = 0; y < ny; ++y) {
      for (std::size_t x = 0; x < nx; ++x, ++i) {
        magnitude = std::max(magnitude, std::abs(v[i]));
        if (x + 1 < nx) slope[0] = std::max(slope[0], std::abs(v[i + 1] - v[i]));
        if (y + 1 < ny) slope[1] = std::max(slope[1], std::abs(v[i + nx] - v[i]));
        if (z + 1 < nz) slope[2] = std::max(slope[2], std::abs(v[i + nx * ny] - v[i]));
      }
    }
  }
  return {{slope[0], slope[1], slope[2]}, magnitude};
}

glm::dvec3 sample_error(const voml::Grid& grid, const glm::dvec3& error) {
  const glm::dvec3 samples_per_unit = glm::dvec3(grid.size) / (grid.box_hi - grid.box_lo);
  // The atlas coordinate takes a product and a sum, the sampler scales it up and subtracts a half.
  return error * samples_per_unit + 6.0 * float_unit * atlas_texels;
}

double filter_error(const GridBounds& bounds, double iso, TexelFormat format, Filter filter) {
  const double roundings = (filter == Filter::tricubic ? tricubic_roundings : trilinear_roundings) +
                           (is_normalised(format) ? normalised_roundings : 0.0);
  return roundings * float_unit * (bounds.magnitude + std::abs(iso)) + 1e-30;
}

}  // namespace dmvv::compiler
