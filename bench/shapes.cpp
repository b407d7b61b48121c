#include "bench/shapes.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

namespace dmvv::bench {
namespace {

constexpr const char* scene_text = R"(<MVV>
  <OBJECT name="BODY">
    <SDF name="BOUNDARY" file="boundary.lxn"/>
    <REGION name="R.INSIDE" type="color" rgb="0.95 0.65 0.2"/>
    <REGION name="R.OUTSIDE" type="color" rgb="0.15 0.25 0.45"/>
    <MAPPINGS name="BODY">
      <SDF name="BOUNDARY"><NEGATIVE region="R.INSIDE"/><POSITIVE region="R.OUTSIDE"/></SDF>
    </MAPPINGS>
  </OBJECT>
</MVV>
)";

constexpr double turn = 2.0 * std::numbers::pi;

double fraction(double x) { return x - std::floor(x); }

}  // namespace

Shape sphere(std::size_t surface_points) {
  const glm::dvec3 center(0.03, -0.02, 0.011);
  const double radius = 0.6;
  Shape shape{"sphere", [=](const glm::dvec3& p) { return glm::length(p - center) - radius; }, {}, 0.5 * radius};
  // A Fibonacci lattice: equal steps in z, golden angles about it.
  for (std::size_t i = 0; i < surface_points; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(surface_points);
    const double r = std::sqrt(1.0 - z * z);
    const double angle = turn * fraction(static_cast<double>(i) * (std::numbers::phi - 1.0));
    const glm::dvec3 normal(r * std::cos(angle), r * std::sin(angle), z);
    shape.surface.push_back({center + radius * normal, normal});
  }
  return shape;
}

Shape torus(std::size_t surface_points) {
  const glm::dvec3 center(-0.017, 0.023, 0.03);
  const double ring = 0.55, tube = 0.25;  // about the z axis
  Shape shape{"torus",
              [=](const glm::dvec3& p) {
                const glm::dvec3 q = p - center;
                return glm::length(glm::dvec2(glm::length(glm::dvec2(q)) - ring, q.z)) - tube;
              },
              {},
              0.5 * tube};
  // An additive sequence in three dimensions (Roberts 2018); the third thins out the inner side, whose area is smaller.
  constexpr double g = 1.2207440846057596;  // the real root of x^4 = x + 1
  for (std::size_t i = 0; shape.surface.size() < surface_points; ++i) {
    const auto k = static_cast<double>(i);
    const double u = turn * fraction(0.5 + k / g), v = turn * fraction(0.5 + k / (g * g));
    if (fraction(0.5 + k / (g * g * g)) > (ring + tube * std::cos(v)) / (ring + tube)) continue;
    const glm::dvec3 normal(std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v));
    shape.surface.push_back({center + ring * glm::dvec3(std::cos(u), std::sin(u), 0.0) + tube * normal, normal});
  }
  return shape;
}

voml::Grid sample_grid(std::uint32_t n, const std::function<double(const glm::dvec3&)>& f) {
  voml::Grid grid;
  grid.size = glm::uvec3(n);
  grid.values.reserve(std::size_t{n} * n * n);
  for (std::uint32_t z = 0; z < n; ++z) {
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        grid.values.push_back(static_cast<float>(f((glm::dvec3(x, y, z) + 0.5) * (2.0 / n) - 1.0)));
      }
    }
  }
  return grid;
}

SceneSource grid_scene(const Shape& shape, std::uint32_t n) {
  SceneSource source;
  source.name = shape.name;
  source.path = "scene.voml";
  source.files =
      memory_files({{"scene.voml", scene_text}, {"boundary.lxn", voml::write_lxn(sample_grid(n, shape.distance))}});
  source.slice = runtime::Plane{{0.0, 0.0, 1.0}, 0.05};
  return source;
}

}  // namespace dmvv::bench
