// The displacement of boundaries that were moved by a known amount.
#include "bench/displacement.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "bench/shapes.h"

using namespace dmvv;
using namespace dmvv::bench;
using doctest::Approx;

namespace {

Inside below(const std::function<double(const glm::dvec3&)>& f) {
  return [f](std::span<const glm::dvec3> points) -> Result<std::vector<char>> {
    std::vector<char> sides;
    for (const glm::dvec3& p : points) sides.push_back(f(p) <= 0.0 ? 1 : 0);
    return sides;
  };
}

}  // namespace

TEST_CASE("points of the shapes lie on them, and their normals are gradients") {
  for (const Shape& shape : {sphere(500), torus(500)}) {
    CAPTURE(shape.name);
    REQUIRE(shape.surface.size() == 500);
    double worst = 0.0, worst_normal = 0.0;
    glm::dvec3 mean(0.0);
    for (const SurfacePoint& point : shape.surface) {
      worst = std::max(worst, std::abs(shape.distance(point.position)));
      // A distance grows by as much as one goes along its gradient.
      worst_normal = std::max(worst_normal, std::abs(shape.distance(point.position + 0.01 * point.normal) - 0.01));
      mean += point.normal;
    }
    CHECK(worst < 1e-14);
    CHECK(worst_normal < 1e-14);
    CHECK(glm::length(mean) / 500.0 < 0.02);  // spread evenly over the area
  }
}

TEST_CASE("a surface moved by a constant is found where it went") {
  for (const Shape& shape : {sphere(300), torus(300)}) {
    for (const double offset : {0.0, 0.003, -0.02}) {
      CAPTURE(shape.name);
      CAPTURE(offset);
      const auto found = measure_displacement(
          shape.surface, below([&](const glm::dvec3& p) { return shape.distance(p) - offset; }), shape.reach);
      REQUIRE(found);
      CHECK(found->count == 300);
      CHECK(found->lost == 0);
      CHECK(std::abs(found->max - std::abs(offset)) < 1e-9);
      CHECK(std::abs(found->rms - std::abs(offset)) < 1e-9);
      CHECK(std::abs(found->mean - offset) < 1e-9);
    }
  }
}

TEST_CASE("a wavy surface has the largest and the root mean square of its waves") {
  // Radius 0.6 + 0.01 cos(polar angle), whose mean square over the sphere is 0.01^2 / 3: along its radius.
  const Shape shape = sphere(4000);
  const glm::dvec3 center = shape.surface[0].position - 0.6 * shape.surface[0].normal;
  const auto found = measure_displacement(shape.surface, below([&](const glm::dvec3& p) {
                                            const glm::dvec3 q = p - center;
                                            return glm::length(q) - 0.6 - 0.01 * q.z / glm::length(q);
                                          }),
                                          shape.reach);
  REQUIRE(found);
  CHECK(found->max == Approx(0.01).epsilon(1e-3));
  CHECK(found->rms == Approx(0.01 / std::sqrt(3.0)).epsilon(1e-3));
  CHECK(std::abs(found->mean) < 1e-6);
}

TEST_CASE("a boundary that is not within reach is lost, not guessed") {
  const Shape shape = sphere(200);
  const auto found = measure_displacement(shape.surface, below([](const glm::dvec3& p) { return p.x; }), 0.1);
  REQUIRE(found);
  CHECK(found->count + found->lost == 200);
  CHECK(found->lost > 100);
  const auto failing = measure_displacement(
      shape.surface,
      [](std::span<const glm::dvec3>) -> Result<std::vector<char>> { return fail(Fault::environment, "gone"); }, 0.1);
  REQUIRE_FALSE(failing);
  CHECK(failing.error().message == "gone");
}
