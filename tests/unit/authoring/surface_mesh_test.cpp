// Surfaces of what can say where it is: closed, in place, complete.
#include "authoring/surface_mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

using namespace dmvv;
using namespace dmvv::authoring;

namespace {

InsideTest test_of(const std::function<double(const glm::dvec3&)>& distance) {
  return [distance](std::span<const glm::dvec3> points) -> Result<std::vector<char>> {
    std::vector<char> result;
    for (const glm::dvec3& p : points) {
      const bool in_cube = std::abs(p.x) <= 1.0 && std::abs(p.y) <= 1.0 && std::abs(p.z) <= 1.0;
      result.push_back(in_cube && distance(p) <= 0.0 ? 1 : 0);
    }
    return result;
  };
}

double volume(const voml::Mesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles)
    sum += glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z])) / 6.0;
  return sum;
}

constexpr double pi = 3.14159265358979323846;

/// What surface_mesh promises: no vertex twice, triangles with an area, each edge passed as often one way as the other,
/// in numbers of float32.
void check_sound(const voml::Mesh& mesh) {
  std::map<std::array<double, 3>, int> places;
  for (const glm::dvec3& p : mesh.positions) {
    ++places[{p.x, p.y, p.z}];
    CHECK(glm::dvec3(glm::vec3(p)) == p);
  }
  CHECK(places.size() == mesh.positions.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  std::vector<bool> used(mesh.positions.size(), false);
  std::size_t without_area = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x];
    without_area += glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a)) > 0.0 ? 0 : 1;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      used[from] = true;
      balance[{std::min(from, to), std::max(from, to)}] += from < to ? 1 : -1;
    }
  }
  CHECK(without_area == 0);
  CHECK(std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; }));
  CHECK(std::ranges::all_of(used, [](bool is_used) { return is_used; }));
}

}  // namespace

TEST_CASE("a ball: closed, its corners within and near the surface, its volume") {
  const auto ball = [](const glm::dvec3& p) { return glm::length(p - glm::dvec3(0.1, -0.05, 0.2)) - 0.7; };
  const auto mesh = surface_mesh(test_of(ball), {48}).value();
  check_sound(mesh);
  CHECK(voml::find_edge_faults(mesh).count() == 0);
  for (const glm::dvec3& p : mesh.positions) {
    CHECK(ball(p) <= 0.0);
    CHECK(ball(p) > -2.0 / 48 / 100);
  }
  // Outward, and smaller than the ball by what chords of half a cell's edge leave out.
  CHECK(volume(mesh) == doctest::Approx(4.0 / 3.0 * pi * 0.343).epsilon(0.005));
}

TEST_CASE("what meets the cube is closed by its faces; the whole cube is the cube") {
  const auto half = surface_mesh(test_of([](const glm::dvec3& p) { return p.x + p.y - 0.123; }), {24}).value();
  CHECK(voml::find_edge_faults(half).count() == 0);
  CHECK(volume(half) == doctest::Approx(4.0 + 2.0 * 0.246 - 0.123 * 0.123).epsilon(0.01));
  const auto cube = surface_mesh(test_of([](const glm::dvec3&) { return -1.0; }), {9}).value();
  CHECK(voml::find_edge_faults(cube).count() == 0);
  CHECK(volume(cube) == doctest::Approx(8.0).epsilon(0.02));
}

TEST_CASE("a thin rod that leaves a ball is followed to its end, though large cells miss it") {
  const auto shape = [](const glm::dvec3& p) {
    const double ball = glm::length(p + glm::dvec3(0.6, 0.1, 0.1)) - 0.3;
    const glm::dvec3 q(std::max(std::abs(p.x) - 0.83, 0.0), p.y + 0.11, p.z + 0.13);
    return std::min(ball, glm::length(q) - 0.05);
  };
  const auto mesh = surface_mesh(test_of(shape), {64}).value();
  check_sound(mesh);
  CHECK(voml::find_edge_faults(mesh).count() == 0);
  CHECK(voml::bounds(mesh).hi.x == doctest::Approx(0.88).epsilon(0.005));
}

TEST_CASE("triangles of a hollow surface stay within it") {
  // A slab that a ball has dented on both sides: between points on the dents, straight lines pass outside.
  const auto shape = [](const glm::dvec3& p) {
    const double dents = 0.9 - std::min(glm::length(p - glm::dvec3(0, 0, 1.0)), glm::length(p + glm::dvec3(0, 0, 1.0)));
    return std::max({dents, std::abs(p.z - 0.003) - 0.487, std::hypot(p.x, p.y) - 0.79});
  };
  const auto mesh = surface_mesh(test_of(shape), {48}).value();
  check_sound(mesh);
  CHECK(voml::find_edge_faults(mesh).count() == 0);
  std::size_t hollow = 0, outside = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0;
    if (std::hypot(middle.x, middle.y) > 0.3) continue;  // far from the rims
    ++hollow;
    outside += shape(middle) > 0.0 ? 1 : 0;
  }
  CHECK(hollow > 500);
  CHECK(outside == 0);
}

TEST_CASE("no triangle without area, wherever nodes lie on the surface") {
  const auto box = [](const glm::dvec3& p, double half) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - half;
  };
  struct Case {
    std::function<double(const glm::dvec3&)> shape;
    double volume;
    double tolerance;
  };
  const Case cases[] = {
      {[](const glm::dvec3&) { return -1.0; }, 8.0, 1e-6},
      {[&](const glm::dvec3& p) { return box(p, 0.5); }, 1.0, 1e-6},  // faces, edges and corners on nodes
      {[](const glm::dvec3& p) { return p.x; }, 4.0, 1e-6},
      {[](const glm::dvec3& p) { return p.x + p.y + p.z; }, 4.0, 1e-2},  // through nodes, along diagonals
      {[](const glm::dvec3& p) { return std::abs(p.x) + std::abs(p.y) + std::abs(p.z) - 0.75; }, 4.0 / 3.0 * 0.421875,
       1e-2},
      {[](const glm::dvec3& p) { return glm::length(p) - 0.5; }, 4.0 / 3.0 * pi * 0.125, 2e-2},
      {[](const glm::dvec3& p) { return std::hypot(p.x, p.y) - 0.25; }, pi * 0.0625 * 2.0, 3e-2},
      {[&](const glm::dvec3& p) { return std::min(box(p - 0.5, 0.25), box(p, 0.25)); }, 0.25,
       1e-3},  // touch at a corner
      {[](const glm::dvec3& p) { return std::abs(p.z) - 0.125; }, 1.0, 1e-6}};
  for (const Case& c : cases) {
    CAPTURE(&c - cases);
    const auto mesh = surface_mesh(test_of(c.shape), {32}).value();
    REQUIRE_FALSE(mesh.triangles.empty());
    check_sound(mesh);
    CHECK(volume(mesh) == doctest::Approx(c.volume).epsilon(c.tolerance));
    for (const glm::dvec3& p : mesh.positions) CHECK(c.shape(p) <= 0.0);
  }
  // Resolutions at which nodes are no numbers of float32.
  for (const std::uint32_t resolution : {9u, 21u, 49u}) {
    check_sound(surface_mesh(test_of([&](const glm::dvec3& p) { return box(p, 0.5); }), {resolution}).value());
    check_sound(surface_mesh(test_of([](const glm::dvec3&) { return -1.0; }), {resolution}).value());
  }
}

TEST_CASE("nothing, a resolution out of range, a test that fails") {
  CHECK(surface_mesh(test_of([](const glm::dvec3&) { return 1.0; }), {16}).value().triangles.empty());
  CHECK(surface_mesh(test_of([](const glm::dvec3&) { return 1.0; }), {7}).error().fault == Fault::input);
  CHECK_FALSE(surface_mesh(test_of([](const glm::dvec3&) { return 1.0; }), {max_surface_resolution + 1}));
  const InsideTest broken = [](std::span<const glm::dvec3>) -> Result<std::vector<char>> {
    return fail(Fault::environment, "out of order");
  };
  CHECK(surface_mesh(broken, {16}).error().message == "out of order");
}
