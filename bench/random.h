// Chance that is the same everywhere.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace dmvv::bench {

/// splitmix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  /// [0, 1)
  double uniform() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  glm::dvec3 point(const glm::dvec3& lo, const glm::dvec3& hi) {
    const double x = uniform(), y = uniform(), z = uniform();
    return lo + glm::dvec3(x, y, z) * (hi - lo);
  }

 private:
  std::uint64_t state_;
};

}  // namespace dmvv::bench
