// Private to authoring: chance that is the same everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <numbers>

namespace dmvv::authoring {

/// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  glm::uvec3 below(const glm::uvec3& size) {
    const std::uint64_t x = next() % size.x, y = next() % size.y, z = next() % size.z;
    return {x, y, z};
  }
  glm::dvec3 in_box(const glm::dvec3& lo, const glm::dvec3& hi) {
    const double x = unit(), y = unit(), z = unit();
    return lo + glm::dvec3(x, y, z) * (hi - lo);
  }
  glm::dvec3 direction() {
    const double z = 2.0 * unit() - 1.0, turn = 2.0 * std::numbers::pi * unit();
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * std::cos(turn), r * std::sin(turn), z};
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
  }
  std::uint64_t state_;
};

}  // namespace dmvv::authoring
