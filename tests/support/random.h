// Random numbers that are the same everywhere.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace dmvv::tests {

/// Small deterministic generator (splitmix64); uniform numbers in [0, 1).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// Of 0, 1, ..., n - 1; n is not 0.
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(uniform() * n); }
  bool chance(double probability) { return uniform() < probability; }
  double in(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  glm::dvec3 point(double lo = -1.0, double hi = 1.0) {
    const double x = in(lo, hi), y = in(lo, hi);
    return {x, y, in(lo, hi)};
  }

 private:
  std::uint64_t state_;
};

}  // namespace dmvv::tests
