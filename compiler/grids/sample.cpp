#include "compiler/grids/sample.h"

#include <glm/common.hpp>
#include <glm/vec4.hpp>

namespace dmvv::compiler {

double sample(const voml::Grid& grid, const glm::dvec3& q) {
  const glm::dvec3 last(grid.size - 1u);
  const glm::dvec3 u = (q - grid.box_lo) / (grid.box_hi - grid.box_lo) * glm::dvec3(grid.size) - 0.5;
  const glm::dvec3 c = glm::clamp(u, glm::dvec3(0.0), last);
  const glm::dvec3 base = glm::min(glm::floor(c), glm::max(last - 1.0, glm::dvec3(0.0)));
  const glm::dvec3 w = c - base;
  const glm::uvec3 lo(base);
  const glm::uvec3 hi = glm::min(lo + 1u, grid.size - 1u);
  const auto value = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return static_cast<double>(grid.values[(std::size_t{z} * grid.size.y + y) * grid.size.x + x]);
  };
  const double v00 = glm::mix(value(lo.x, lo.y, lo.z), value(hi.x, lo.y, lo.z), w.x);
  const double v10 = glm::mix(value(lo.x, hi.y, lo.z), value(hi.x, hi.y, lo.z), w.x);
  const double v01 = glm::mix(value(lo.x, lo.y, hi.z), value(hi.x, lo.y, hi.z), w.x);
  const double v11 = glm::mix(value(lo.x, hi.y, hi.z), value(hi.x, hi.y, hi.z), w.x);
  return glm::mix(glm::mix(v00, v10, w.y), glm::mix(v01, v11, w.y), w.z);
}

namespace {

/// Weights of the samples at -1, 0, 1, 2 for a point between 0 and 1.
glm::dvec4 catmull_rom(double t) {
  return 0.5 * glm::dvec4(t * (t * (2.0 - t) - 1.0), 2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)),
                          t * t * (t - 1.0));
}

}  // namespace

double sample_tricubic(const voml::Grid& grid, const glm::dvec3& q) {
  const glm::dvec3 c = (q - grid.box_lo) / (grid.box_hi - grid.box_lo) * glm::dvec3(grid.size) - 0.5;
  const glm::dvec3 base = glm::floor(c);
  const glm::dvec3 t = c - base;
  const glm::dvec4 weights[3] = {catmull_rom(t.x), catmull_rom(t.y), catmull_rom(t.z)};
  const glm::ivec3 first = glm::ivec3(base) - 1;
  const glm::ivec3 last = glm::ivec3(grid.size) - 1;
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        const glm::uvec3 at(glm::clamp(first + glm::ivec3(i, j, k), glm::ivec3(0), last));
        const double value = grid.values[(std::size_t{at.z} * grid.size.y + at.y) * grid.size.x + at.x];
        sum += weights[0][i] * weights[1][j] * weights[2][k] * value;
      }
    }
  }
  return sum;
}

}  // namespace dmvv::compiler
