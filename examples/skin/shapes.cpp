#include "shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "examples/noise.h"

namespace skin {

using namespace assets;

namespace {

using std::numbers::pi;

/// Blend of two distances over a width of k.
double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4.0;
}

double to_segment(dvec3 p, dvec3 a, dvec3 b) {
  const double t = glm::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
  return glm::length(p - glm::mix(a, b, t));
}

/// 1 in the middle of a line of a family of lines, 0 away from it; the lines lie `apart` and waver.
double line(double x, double z, double angle, double apart, double width, std::uint32_t seed) {
  const double u = std::cos(angle) * x + std::sin(angle) * z + 0.035 * noise(dvec3(x, 0.0, z) * 4.0 + 20.0, seed);
  return bell(std::abs(u / apart - std::round(u / apart)) * apart / width);
}

/// Distance from the skin's axis-aligned height field, to first order.
double height_distance(double (*height)(double, double), dvec3 p) {
  const double step = 2e-3;
  const double slope_x = (height(p.x + step, p.z) - height(p.x - step, p.z)) / (2.0 * step);
  const double slope_z = (height(p.x, p.z + step) - height(p.x, p.z - step)) / (2.0 * step);
  return (p.y - height(p.x, p.z)) / std::sqrt(1.0 + slope_x * slope_x + slope_z * slope_z);
}

}  // namespace

double surface_height(double x, double z) {
  const double furrows = std::max(line(x, z, 0.55, 0.29, 0.055, 3), 0.8 * line(x, z, -0.75, 0.33, 0.050, 4));
  return 0.705 + 0.006 * noise(dvec3(x, 0.0, z) * 3.0 + 9.0, 1) + 0.003 * noise(dvec3(x, 0.0, z) * 9.0, 2) -
         0.020 * furrows;
}

const std::vector<dvec2>& papillae() {
  static const std::vector<dvec2> sites = [] {
    Random random(11);
    std::vector<dvec2> made;
    for (int i = 0; i < 10; ++i)
      for (int j = 0; j < 10; ++j) {
        const double x = random.uniform(-0.045, 0.045), z = random.uniform(-0.045, 0.045);
        // Every second row is moved by half a step.
        made.emplace_back(-0.95 + 0.205 * i + 0.1 * (j % 2) + x - 0.03, j == 6 ? papilla_row : -0.92 + 0.205 * j + z);
      }
    return made;
  }();
  return sites;
}

double junction_height(double x, double z) {
  double bump = 0.0;
  std::uint32_t number = 0;
  for (const dvec2 site : papillae()) {
    const double size = 0.80 + 0.4 * (hash(number++, 0, 0, 5) / 4294967295.0);
    bump = std::max(bump, 0.115 * size * bell(glm::length(dvec2(x, z) - site) / 0.105));
  }
  return 0.452 + bump + 0.010 * noise(dvec3(x, 0.0, z) * 5.0 + 31.0, 6);
}

dvec3 normal_of(double (*height)(double, double), double x, double z) {
  const double step = 4e-3;
  return glm::normalize(dvec3((height(x - step, z) - height(x + step, z)) / (2.0 * step), 1.0,
                              (height(x, z - step) - height(x, z + step)) / (2.0 * step)));
}

double surface_distance(dvec3 p) { return height_distance(surface_height, p); }
double junction_distance(dvec3 p) { return height_distance(junction_height, p); }

double packed_cell_distance(dvec3 p) {
  static const std::vector<dvec3> sides = [] {
    Random random(21);
    std::vector<dvec3> normals;
    while (normals.size() < 15) {
      const dvec3 d = random.uniform3(-1.0, 1.0);
      if (glm::length(d) > 1.0 || glm::length(d) < 0.1) continue;
      const dvec3 n = glm::normalize(d);
      if (std::all_of(normals.begin(), normals.end(), [&](dvec3 m) { return glm::dot(m, n) < 0.72; }))
        normals.push_back(n);
    }
    return normals;
  }();
  double d = glm::length(p) - 0.97;
  for (const dvec3 n : sides) d = -smooth_min(-d, -(glm::dot(p, n) - 0.80), 0.16);
  return d;
}

double follicle_distance(dvec3 p) {
  const double r = std::sqrt(p.x * p.x + p.z * p.z);
  const double ridges = 0.0025 * noise(dvec3(p.x * 14.0, p.y * 7.0, p.z * 14.0), 41);
  const double sheath = r - (0.066 + 0.010 * bell((p.y - 0.30) / 0.35) + ridges);
  const double bulb = glm::length(dvec3(p.x, (p.y + 0.62) * 0.72, p.z)) - 0.105;
  return std::max(smooth_min(std::max(sheath, -0.62 - p.y), bulb, 0.07), p.y - 0.40);
}

double dermal_papilla_distance(dvec3 p) {
  const double r = std::sqrt(p.x * p.x + p.z * p.z);
  const double drop =
      glm::length(dvec2(r, std::max(std::abs(p.y + 0.640) - 0.035, 0.0))) - 0.040 + 0.16 * std::max(p.y + 0.640, 0.0);
  const double stem = std::max(r - 0.022, p.y + 0.62);
  return smooth_min(drop, stem, 0.02);
}

double sebaceous_distance(dvec3 p) {
  static const std::vector<std::array<double, 4>> lobes = [] {
    Random random(51);
    std::vector<std::array<double, 4>> made;
    for (int i = 0; i < 9; ++i) {
      const double turn = 2.4 * i, y = -0.085 + 0.017 * i;
      const double out = 0.052 * std::sqrt(1.0 - std::pow((y + 0.02) / 0.13, 2.0));
      const double size = random.uniform(0.036, 0.046);
      made.push_back({out * std::cos(turn), y, out * std::sin(turn), size});
    }
    return made;
  }();
  double d = to_segment(p, dvec3(0.0, -0.06, 0.0), dvec3(0.0, 0.13, 0.0)) - 0.016;
  for (const auto& [x, y, z, size] : lobes) d = smooth_min(d, glm::length(p - dvec3(x, y, z)) - size, 0.012);
  return d;
}

double coil_distance(dvec3 p) {
  // One tube, wound up; then up and out.
  static const std::vector<dvec3> path = [] {
    std::vector<dvec3> made;
    for (int i = 0; i <= 700; ++i) {
      const double s = i / 700.0, turn = 2.0 * pi * s;
      // A torus knot, seven times around while ten times across, shaken.
      const double around = 7.0 * turn, across = 10.0 * turn;
      const double ring = 0.082 + 0.050 * std::cos(across);
      const dvec3 q(ring * std::cos(around), 0.066 * std::sin(across), ring * std::sin(around));
      const dvec3 shake(noise(q * 16.0 + 5.0, 61), noise(q * 16.0 + 35.0, 62), noise(q * 16.0 + 65.0, 63));
      made.push_back(q + 0.013 * shake + dvec3(0.0, -0.03, 0.0));
    }
    const dvec3 last = made.back();
    for (int i = 1; i <= 20; ++i) {  // to the middle above
      const double s = i / 20.0, ease = s * s * (3.0 - 2.0 * s);
      made.push_back(dvec3(last.x * (1.0 - ease), glm::mix(last.y, 0.18, s), last.z * (1.0 - ease)));
    }
    return made;
  }();
  double d = 1.0;
  for (std::size_t i = 1; i < path.size(); ++i) d = std::min(d, to_segment(p, path[i - 1], path[i]));
  return d - 0.0155;
}

}  // namespace skin
