// Makes the two small grids of the skull scene that do not come from scans.
//
//   make_marrow FOLDER      writes marrow.lxn and ball.lxn into FOLDER
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "base/files.h"
#include "examples/noise.h"
#include "voml/assets/grid.h"

namespace {

using glm::dvec3;

std::string sample(std::uint32_t n, const std::function<double(dvec3)>& distance) {
  dmvv::voml::Grid grid;
  grid.size = glm::uvec3(n);
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x)
        grid.values.push_back(static_cast<float>(distance((dvec3(x, y, z) + 0.5) / double(n) * 2.0 - 1.0)));
  return dmvv::voml::write_lxn(grid);
}

/// The marrow spaces of spongy bone: balls of several sizes that break into each other. One octant of the cube is made,
/// the others are its mirror images: then opposite faces of the cube are alike, and tiles of it join without a seam.
std::string marrow() {
  struct Ball {
    dvec3 centre;
    double radius;
  };
  std::vector<Ball> balls;
  assets::Random random(11);
  for (int i = 0; i < 48; ++i) {
    const dvec3 centre = random.uniform3(0.0, 1.0);
    balls.push_back({centre, random.uniform(0.10, 0.19)});
  }
  return sample(48, [&](dvec3 p) {
    double nearest = 1e30;
    for (const Ball& ball : balls) nearest = std::min(nearest, glm::distance(glm::abs(p), ball.centre) - ball.radius);
    return nearest;
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: make_marrow FOLDER\n");
    return 2;
  }
  const std::string folder = argv[1];
  const std::string ball = sample(24, [](dvec3 p) { return glm::length(p) - 0.8; });
  for (const auto& [name, bytes] : {std::pair{"ball.lxn", ball}, std::pair{"marrow.lxn", marrow()}}) {
    if (const auto written = dmvv::write_file(folder + "/" + name, bytes); !written) {
      fmt::print(stderr, "make_marrow: {}\n", written.error().message);
      return 2;
    }
  }
}
