// Places and orientations that fill a volume evenly, the same on every machine.
#pragma once

#include <cmath>
#include <fstream>
#include <glm/vec3.hpp>
#include <random>
#include <string>
#include <vector>

namespace examples {

/// Chance that is the same everywhere: the standard fixes the numbers of this generator, but not those of its
/// distributions.
class Random {
 public:
  double uniform(double lo = 0.0, double hi = 1.0) { return lo + (hi - lo) * generator_() / 4294967296.0; }

  /// Drawn one after the other: the order of a call's arguments is the compiler's choice.
  glm::dvec3 uniform3() {
    const double x = uniform(), y = uniform(), z = uniform();
    return {x, y, z};
  }

  /// Angles in degrees about x, then y, then z: evenly over all rotations.
  glm::dvec3 rotation() {
    const glm::dvec3 u = uniform3();
    return {360.0 * u.x, std::asin(2.0 * u.y - 1.0) * 180.0 / std::acos(-1.0), 360.0 * u.z};
  }

 private:
  std::mt19937 generator_{1};
};

/// The cells of [0, 1)^3, x fastest, and in each a place: even, but no lattice.
inline std::vector<glm::dvec3> spread(const glm::ivec3& cells, Random& random) {
  std::vector<glm::dvec3> places;
  for (glm::ivec3 c(0); c.z < cells.z; ++c.z) {
    for (c.y = 0; c.y < cells.y; ++c.y) {
      for (c.x = 0; c.x < cells.x; ++c.x) places.push_back((glm::dvec3(c) + random.uniform3()) / glm::dvec3(cells));
    }
  }
  return places;
}

/// A file of vectors, a line each.
class VectorFile {
 public:
  explicit VectorFile(const std::string& path) : stream_(path) { stream_.precision(7); }
  void add(const glm::dvec3& v) { stream_ << v.x << ' ' << v.y << ' ' << v.z << '\n'; }
  bool close() {
    stream_.close();
    return !stream_.fail();
  }

 private:
  std::ofstream stream_;
};

}  // namespace examples
