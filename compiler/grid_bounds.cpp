#include "compiler/grid_bounds.h"

#include <algorithm>
#include <cmath>

namespace dmvv::compiler {

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

}  // namespace dmvv::compiler
