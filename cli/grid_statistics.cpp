#include "cli/grid_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace dmvv::cli {
namespace {

/// The corners of the cell at `cell` (a layer of one sample has cells without thickness: their slope is 0).
std::array<double, 8> corners(const voml::Grid& grid, const glm::uvec3& cell) {
  std::array<double, 8> values{};
  for (unsigned corner = 0; corner < 8; ++corner) {
    const glm::uvec3 at(std::min(cell.x + (corner & 1), grid.size.x - 1),
                        std::min(cell.y + (corner >> 1 & 1), grid.size.y - 1),
                        std::min(cell.z + (corner >> 2 & 1), grid.size.z - 1));
    values[corner] = grid.values[at.x + std::size_t{grid.size.x} * (at.y + std::size_t{grid.size.y} * at.z)];
  }
  return values;
}

/// Greatest slopes along the four edges in each direction.
glm::dvec3 slopes(const std::array<double, 8>& values, const glm::dvec3& spacing) {
  glm::dvec3 greatest(0.0);
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned step = 1u << axis;
    for (unsigned corner = 0; corner < 8; ++corner) {
      if (corner & step) continue;
      greatest[axis] = std::max(greatest[axis], std::abs(values[corner | step] - values[corner]) / spacing[axis]);
    }
  }
  return greatest;
}

}  // namespace

GridStatistics measure(const voml::Grid& grid) {
  GridStatistics result;
  const auto [least, greatest] = std::ranges::minmax(grid.values);
  result.least = least;
  result.greatest = greatest;
  const auto inside = std::ranges::count_if(grid.values, [](float value) { return value <= 0.0f; });
  result.share_inside = static_cast<double>(inside) / static_cast<double>(grid.values.size());

  const glm::dvec3 spacing = (grid.box_hi - grid.box_lo) / glm::dvec3(grid.size);
  const glm::uvec3 cells = glm::max(grid.size, glm::uvec3(2)) - 1u;
  for (glm::uvec3 cell(0); cell.z < cells.z; ++cell.z) {
    for (cell.y = 0; cell.y < cells.y; ++cell.y) {
      for (cell.x = 0; cell.x < cells.x; ++cell.x) {
        const glm::dvec3 slope = slopes(corners(grid, cell), spacing);
        result.lipschitz = glm::max(result.lipschitz, slope);
        result.greatest_gradient = std::max(result.greatest_gradient, glm::length(slope));
      }
    }
  }
  return result;
}

}  // namespace dmvv::cli
