// Distance grids made from formulas, so that expected values come from mathematics.
#pragma once

#include <functional>
#include <glm/geometric.hpp>
#include <string>

#include "voml/assets/grid.h"

namespace dmvv::tests {

/// A cell-centred grid of f over a box of the standard cube.
inline voml::Grid grid_of(glm::uvec3 size, const std::function<double(glm::dvec3)>& f, glm::dvec3 lo = glm::dvec3(-1.0),
                          glm::dvec3 hi = glm::dvec3(1.0)) {
  voml::Grid grid;
  grid.size = size;
  grid.box_lo = lo;
  grid.box_hi = hi;
  for (std::uint32_t z = 0; z < size.z; ++z) {
    for (std::uint32_t y = 0; y < size.y; ++y) {
      for (std::uint32_t x = 0; x < size.x; ++x) {
        const glm::dvec3 p = lo + (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(size) * (hi - lo);
        grid.values.push_back(static_cast<float>(f(p)));
      }
    }
  }
  return grid;
}

inline std::string sphere_lxn(std::uint32_t n, double radius, glm::dvec3 center = glm::dvec3(0.0)) {
  return voml::write_lxn(grid_of(glm::uvec3(n), [=](glm::dvec3 p) { return glm::length(p - center) - radius; }));
}

/// x > 0 is positive: a plane, exact on any grid.
inline std::string plane_lxn(std::uint32_t n = 4) {
  return voml::write_lxn(grid_of(glm::uvec3(n), [](glm::dvec3 p) { return p.x; }));
}

}  // namespace dmvv::tests
