#include "compiler/ir/affine.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/support/scenes.h"

using namespace dmvv;
using compiler::Affine;

namespace {

void check_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-15) {
  CAPTURE(a.x);
  CAPTURE(a.y);
  CAPTURE(a.z);
  CHECK(glm::length(a - b) <= tolerance);
}

}  // namespace

TEST_CASE("rotations are right-handed and apply x, then y, then z") {
  const auto turn = [](glm::dvec3 degrees) { return compiler::object_from_local({{}, degrees, glm::dvec3(1.0)}); };
  CHECK(turn({90, 0, 0})({0, 1, 0}) == glm::dvec3(0, 0, 1));
  CHECK(turn({0, 90, 0})({0, 0, 1}) == glm::dvec3(1, 0, 0));
  CHECK(turn({0, 0, 90})({1, 0, 0}) == glm::dvec3(0, 1, 0));
  // x first turns y into z, then y turns z into x; the other order would give z.
  CHECK(turn({90, 90, 0})({0, 1, 0}) == glm::dvec3(1, 0, 0));
  check_near(turn({0, 0, 30})({1, 0, 0}), {std::sqrt(0.75), 0.5, 0});
  CHECK(turn({360, -720, 1080})({1, 2, 3}) == glm::dvec3(1, 2, 3));
}

TEST_CASE("scale comes first, translation last") {
  const Affine m = compiler::object_from_local({{10, 0, 0}, {0, 0, 90}, {2, 3, 4}});
  CHECK(m({1, 0, 0}) == glm::dvec3(10, 2, 0));
  CHECK(m({0, 1, 0}) == glm::dvec3(7, 0, 0));
}

TEST_CASE("local_from_object inverts object_from_local, also for tiny and mirrored scales") {
  tests::Random random(3);
  for (const double magnitude : {1.0, 1e-6, 1e6}) {
    for (int i = 0; i < 200; ++i) {
      const voml::Transform transform{random.point(-2, 2), random.point(-400, 400),
                                      magnitude * glm::dvec3(random.in(0.1, 2), -random.in(0.1, 2), random.in(0.1, 2))};
      const glm::dvec3 p = random.point();
      const glm::dvec3 back = compiler::local_from_object(transform)(compiler::object_from_local(transform)(p));
      check_near(back, p, 1e-13 + 1e-14 / magnitude);
      const glm::dvec3 twice =
          compiler::inverse(compiler::object_from_local(transform))(compiler::object_from_local(transform)(p));
      check_near(twice, p, 1e-12 + 1e-14 / magnitude);
    }
  }
}

TEST_CASE("seeds combine component by component, positions in fractions of the edge") {
  const voml::Transform base{{0.1, 0, 0}, {10, 0, 0}, {2, 2, 2}};
  const voml::Transform seed = compiler::combine(base, {{0.25, -0.5, 0}, {1, 2, 3}, {0.5, 1, 2}});
  CHECK(seed.translate == glm::dvec3(0.6, -1, 0));
  CHECK(seed.rotate_deg == glm::dvec3(11, 2, 3));
  CHECK(seed.scale == glm::dvec3(1, 2, 4));
}
