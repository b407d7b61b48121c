#include "authoring/triangle_tree.h"

#include <doctest/doctest.h>

#include <random>

#include "tests/unit/authoring/shapes.h"

namespace dmvv::tests {

namespace {

using authoring::Corners;
using authoring::Triangle;
using authoring::TriangleTree;

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

class Random {
 public:
  double number(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  dvec3 point(double extent) { return {number(-extent, extent), number(-extent, extent), number(-extent, extent)}; }

 private:
  std::mt19937 engine_{7};
};

}  // namespace

TEST_CASE("a triangle's distance in each of its seven zones") {
  const Triangle triangle({dvec3(0, 0, 0), dvec3(4, 0, 0), dvec3(0, 3, 0)});
  const auto distance = [&](dvec3 p) { return std::sqrt(triangle.squared_distance(p, infinity)); };
  CHECK(distance({1, 1, 2}) == doctest::Approx(2));  // the face, from either side
  CHECK(distance({1, 1, -2}) == doctest::Approx(2));
  CHECK(distance({-3, -4, 0}) == doctest::Approx(5));  // the corners
  CHECK(distance({7, 0, 4}) == doctest::Approx(5));
  CHECK(distance({0, 7, 3}) == doctest::Approx(5));
  CHECK(distance({2, -3, 4}) == doctest::Approx(5));  // the edges
  CHECK(distance({-3, 1, 4}) == doctest::Approx(5));
  CHECK(distance({2 + 0.6, 1.5 + 0.8, 0}) == doctest::Approx(1));
  CHECK(distance({0, 0, 0}) == 0.0);
}

TEST_CASE("a triangle's distance does not depend on the order of its corners") {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const Corners t{random.point(1), random.point(1), random.point(1)};
    const dvec3 p = random.point(2);
    const double expected = squared_distance(p, t);
    int order[3] = {0, 1, 2};
    do {
      const double actual = Triangle({t[order[0]], t[order[1]], t[order[2]]}).squared_distance(p, infinity);
      REQUIRE(std::abs(std::sqrt(actual) - std::sqrt(expected)) < 1e-14);
    } while (std::next_permutation(order, order + 3));
  }
}

TEST_CASE("slivers and triangles without area are the segments and points they look like") {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const dvec3 a = random.point(1), b = random.point(1), p = random.point(2);
    const dvec3 between = glm::mix(a, b, random.number(0, 1));
    const double height = std::pow(10.0, random.number(-20, -10));
    const double segment = std::sqrt(squared_distance_to_segment(p, a, b));
    CHECK(std::abs(std::sqrt(Triangle({a, b, between}).squared_distance(p, infinity)) - segment) < 1e-13);
    CHECK(std::abs(std::sqrt(Triangle({a, between + height * random.point(1), b}).squared_distance(p, infinity)) -
                   segment) < 2 * height + 1e-13);
    CHECK(std::abs(std::sqrt(Triangle({a, b, a}).squared_distance(p, infinity)) - segment) < 1e-13);
    CHECK(std::abs(std::sqrt(Triangle({a, a, a}).squared_distance(p, infinity)) - glm::distance(p, a)) < 1e-13);
  }
}

TEST_CASE("a triangle's solid angle") {
  // One face of an octahedron is an eighth of the sphere, seen from its centre, behind the face.
  const Corners octant{dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, 1)};
  CHECK(Triangle(octant).solid_angle(dvec3(0)) == doctest::Approx(pi / 2));
  CHECK(Triangle({octant[0], octant[2], octant[1]}).solid_angle(dvec3(0)) == doctest::Approx(-pi / 2));
  // Very near, a face fills half the sphere; in its own plane, beside it, nothing.
  CHECK(Triangle(octant).solid_angle(dvec3(1.0 / 3.0 - 1e-9)) == doctest::Approx(2 * pi));
  CHECK(Triangle(octant).solid_angle(dvec3(1.0 / 3.0 + 1e-9)) == doctest::Approx(-2 * pi));
  CHECK(std::abs(Triangle({dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0)}).solid_angle(dvec3(2, 2, 0))) < 1e-15);
  CHECK(Triangle({dvec3(0), dvec3(1, 1, 1), dvec3(2, 2, 2)}).solid_angle(dvec3(1, 0, 0)) == doctest::Approx(0));
}

TEST_CASE("distances of a soup of triangles are those of brute force, whatever the guess") {
  Random random;
  std::vector<Corners> soup;
  for (int i = 0; i < 1500; ++i) {
    const dvec3 centre = random.point(1);
    const double size = std::pow(10.0, random.number(-6, 0));
    soup.push_back({centre + random.point(size), centre + random.point(size), centre + random.point(size)});
  }
  for (const std::size_t count : {1u, 2u, 5u, 64u, 1500u}) {
    const std::vector<Corners> triangles(soup.begin(), soup.begin() + static_cast<std::ptrdiff_t>(count));
    const TriangleTree tree(triangles);
    TriangleTree::Index guess = 0;
    for (int i = 0; i < 500; ++i) {
      const dvec3 p = random.point(i % 2 == 0 ? 1.0 : 5.0);
      REQUIRE(std::abs(tree.distance(p, guess) - distance(p, triangles)) < 1e-13);
    }
  }
}

TEST_CASE("distances stay exact where float32 boxes are coarse: triangles and points far from the origin") {
  Random random;
  const dvec3 far(1000.0, -3000.0, 250.0);
  std::vector<Corners> triangles;
  for (int i = 0; i < 400; ++i) {
    const dvec3 at = far + random.point(1e-2);
    triangles.push_back({at, at + random.point(1e-4), at + random.point(1e-4)});
  }
  const TriangleTree tree(triangles);
  for (int i = 0; i < 500; ++i) {
    const dvec3 p = far + random.point(i % 2 == 0 ? 1e-2 : 1e3);
    REQUIRE(std::abs(tree.distance(p) - distance(p, triangles)) < 1e-11);
  }
}

TEST_CASE("a triangle of the tree is told by its number in the list that was given") {
  const std::vector<Corners> triangles = corners_of(torus(0.4, 20, 10));
  const TriangleTree tree(triangles);
  REQUIRE(tree.triangle_count() == triangles.size());
  for (const Corners& t : triangles) {
    const dvec3 centroid = (t[0] + t[1] + t[2]) / 3.0;
    TriangleTree::Index nearest = 0;
    CHECK(tree.distance(centroid, nearest) < 1e-12);
    CHECK((triangles[tree.given_number(nearest)] == t));
    CHECK(glm::distance(tree.triangle(nearest).centroid(), centroid) < 1e-12);
  }
}

TEST_CASE("many equal triangles do not unbalance the tree") {
  const std::vector<Corners> equal(5000, Corners{dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0)});
  const TriangleTree tree(equal);
  TriangleTree::Index guess = 0;
  CHECK(tree.distance({0.25, 0.25, 3}, guess) == doctest::Approx(3));
  CHECK(tree.winding_number({0.25, 0.25, -1}) == doctest::Approx(winding_number({0.25, 0.25, -1}, equal)));
}

TEST_CASE("winding numbers: exact with unlimited accuracy, near it with the usual one") {
  Random random;
  voml::Mesh open = torus(0.4, 60, 30);
  open.triangles.resize(open.triangles.size() * 2 / 3);
  const std::vector<Corners> triangles = corners_of(open);
  const TriangleTree tree(triangles);
  for (int i = 0; i < 1000; ++i) {
    const dvec3 p = random.point(1.6);
    const double exact = winding_number(p, triangles);
    REQUIRE(std::abs(tree.winding_number(p, 1e6) - exact) < 1e-12);
    REQUIRE(std::abs(tree.winding_number(p) - exact) < 0.03);
    REQUIRE(std::abs(tree.winding_number(p, 8.0) - exact) < 0.002);
  }
}

TEST_CASE("winding numbers count the shells around a point") {
  const voml::Mesh inner = transformed(sphere(3), 0.5, dvec3(0));
  const voml::Mesh twice = joined(sphere(3), inner), hollow = joined(sphere(3), inside_out(inner));
  const auto count = [](const voml::Mesh& mesh, const dvec3& p) {
    return std::lround(TriangleTree(corners_of(mesh)).winding_number(p));
  };
  CHECK(count(twice, {0.1, 0.2, 0.1}) == 2);
  CHECK(count(twice, {0, 0.75, 0}) == 1);
  CHECK(count(twice, {0, 1.5, 0}) == 0);
  CHECK(count(hollow, {0.1, 0.2, 0.1}) == 0);
  CHECK(count(hollow, {0, 0.75, 0}) == 1);
  CHECK(count(inside_out(hollow), {0, 0.75, 0}) == -1);
}

TEST_CASE("signed volume") {
  const voml::Mesh shape = box({5, 6, 7}, {7, 9, 11});
  CHECK(TriangleTree(corners_of(shape)).signed_volume() == doctest::Approx(2 * 3 * 4));
  CHECK(TriangleTree(corners_of(inside_out(shape))).signed_volume() == doctest::Approx(-2 * 3 * 4));
}

}  // namespace dmvv::tests
