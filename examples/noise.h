// Random numbers and noise that are the same on every machine.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace assets {

using glm::dvec3;

/// PCG32 (O'Neill 2014), the minimal form.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) { next(); }

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005u + 1442695040888963407u;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
    return std::rotr(xorshifted, static_cast<int>(old >> 59u));
  }
  /// Uniform in [lo, hi).
  double uniform(double lo, double hi) { return lo + (hi - lo) * next() / 4294967296.0; }
  /// Three of them. Drawn one after the other: the order of a call's arguments is the compiler's choice.
  dvec3 uniform3(double lo, double hi) {
    const double x = uniform(lo, hi);
    const double y = uniform(lo, hi);
    const double z = uniform(lo, hi);
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

inline std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9e3779b9u + x * 0x85ebca6bu + y * 0xc2b2ae35u + z * 0x27d4eb2fu;
  for (int round = 0; round < 2; ++round) h = (h ^ (h >> 15u)) * 0x2c1b3c6du;
  return h ^ (h >> 16u);
}

/// Smooth lattice noise in [-1, 1] with features of size 1; repeats after `period` units along each axis.
inline double noise(dvec3 p, std::uint32_t seed, int period = 4096) {
  const dvec3 cell = glm::floor(p);
  const dvec3 t = p - cell;
  const dvec3 s = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
  const auto lattice = [&](int dx, int dy, int dz) {
    const auto wrap = [&](double c, int d) {
      const int i = (static_cast<int>(c) + d) % period;
      return static_cast<std::uint32_t>(i < 0 ? i + period : i);
    };
    return hash(wrap(cell.x, dx), wrap(cell.y, dy), wrap(cell.z, dz), seed) / 2147483647.5 - 1.0;
  };
  const auto row = [&](int dy, int dz) { return glm::mix(lattice(0, dy, dz), lattice(1, dy, dz), s.x); };
  return glm::mix(glm::mix(row(0, 0), row(1, 0), s.y), glm::mix(row(0, 1), row(1, 1), s.y), s.z);
}

/// Sum of octaves, about [-1, 1].
inline double fractal_noise(dvec3 p, std::uint32_t seed, int octaves, int period = 4096) {
  double sum = 0.0, weight = 0.5, total = 0.0;
  for (int i = 0; i < octaves; ++i, weight *= 0.55, p *= 2.0, period *= 2) {
    sum += weight * noise(p, seed + static_cast<std::uint32_t>(i), period);
    total += weight;
  }
  return sum / total;
}

/// 1 at x = 0, falling smoothly to 0 at |x| = 1.
inline double bell(double x) {
  const double t = std::max(0.0, 1.0 - x * x);
  return t * t;
}

}  // namespace assets
