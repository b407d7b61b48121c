// Small scenes and the files they name, made by the tests themselves.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <string>

#include "tests/cli/program.h"
#include "voml/assets/grid.h"

namespace dmvv::tests {

/// A cube of half the size embedded in the standard cube: no files. Region numbers: R.CORE 1, R.SHELL 2.
inline constexpr const char* nested_cubes = R"(<MVV>
  <OBJECT name="CORE"><REGION name="R.CORE" type="color" rgb="1 0.5 0"/></OBJECT>
  <OBJECT name="SHELL"><REGION name="R.SHELL" type="color" rgb="0 0 1">
    <EMBEDDED name="CORE" scale="0.5 0.5 0.5"/>
  </REGION></OBJECT>
</MVV>
)";

/// The bytes of an LXN file of n^3 samples of f over the whole cube.
inline std::string sampled(std::uint32_t n, const std::function<double(const glm::dvec3&)>& f) {
  voml::Grid grid;
  grid.size = glm::uvec3(n);
  for (glm::uvec3 at(0); at.z < n; ++at.z) {
    for (at.y = 0; at.y < n; ++at.y) {
      for (at.x = 0; at.x < n; ++at.x) {
        const glm::dvec3 q = (glm::dvec3(at) + 0.5) / glm::dvec3(n) * 2.0 - 1.0;
        grid.values.push_back(static_cast<float>(f(q)));
      }
    }
  }
  return voml::write_lxn(grid);
}

}  // namespace dmvv::tests
