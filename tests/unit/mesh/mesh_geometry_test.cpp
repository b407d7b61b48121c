#include <glm/geometric.hpp>

#include "tests/unit/mesh/mesh_test.h"

namespace dmvv::tests {

namespace {

double signed_volume(const voml::Mesh& mesh) {
  double volume = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    volume += glm::dot(mesh.positions[t.x], glm::cross(mesh.positions[t.y], mesh.positions[t.z])) / 6.0;
  }
  return volume;
}

}  // namespace

TEST_CASE("the standard cube is closed, faces outwards and spans -1 to 1") {
  const voml::Mesh cube = voml::standard_cube();
  CHECK(cube.positions.size() == 8);
  CHECK(cube.triangles.size() == 12);
  CHECK(signed_volume(cube) == doctest::Approx(8.0));
  CHECK(voml::find_edge_faults(cube).count() == 0);
  CHECK(voml::bounds(cube).lo == glm::dvec3(-1.0));
  CHECK(voml::bounds(cube).hi == glm::dvec3(1.0));
  for (const glm::uvec3& t : cube.triangles) {
    const glm::dvec3 a = cube.positions[t.x], b = cube.positions[t.y], c = cube.positions[t.z];
    CHECK(glm::dot(glm::cross(b - a, c - a), a + b + c) > 0.0);
  }
}

TEST_CASE("bounds hold the triangles, not the vertices that none uses") {
  voml::Mesh mesh{{{1, 2, 3}, {4, 0, 3}, {2, 2, 9}, {100, 100, 100}}, {{0, 1, 2}}};
  CHECK(voml::bounds(mesh).lo == glm::dvec3(1, 0, 3));
  CHECK(voml::bounds(mesh).hi == glm::dvec3(4, 2, 9));
}

TEST_CASE("parts of positive volume look outward, voids do not") {
  voml::Mesh mesh = voml::standard_cube();
  const auto add_cube = [&](double scale, double x, bool inverted) {
    const voml::Mesh cube = voml::standard_cube();
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::dvec3& p : cube.positions) mesh.positions.push_back(scale * p + glm::dvec3(x, 0.0, 0.0));
    for (const glm::uvec3& t : cube.triangles) {
      mesh.triangles.push_back(first + (inverted ? glm::uvec3(t.x, t.z, t.y) : t));
    }
  };
  add_cube(0.5, 0.1, true);
  add_cube(2.0, 9.0, false);
  REQUIRE(voml::find_edge_faults(mesh).count() == 0);
  std::vector<bool> expected(36, true);
  std::fill_n(expected.begin() + 12, 12, false);
  CHECK(voml::outward_triangles(mesh) == expected);
}

TEST_CASE("open edges: a missing triangle leaves three, a lone one has three") {
  voml::Mesh cube = voml::standard_cube();
  cube.triangles.pop_back();
  CHECK(voml::find_edge_faults(cube).count() == 3);
  CHECK(voml::find_edge_faults(cube).open.count == 3);
  cube.triangles.resize(1);
  CHECK(voml::find_edge_faults(cube).count() == 3);
}

TEST_CASE("edges' faults: a triangle turned around disagrees with its three neighbours") {
  voml::Mesh cube = voml::standard_cube();
  std::swap(cube.triangles[5].x, cube.triangles[5].y);
  const voml::EdgeFaults faults = voml::find_edge_faults(cube);
  CHECK(faults.count() == 3);
  CHECK(faults.opposed.count == 3);
  REQUIRE(voml::describe(faults).size() == 1);
  CHECK(voml::describe(faults)[0].starts_with(
      "3 edges lie between two triangles wound against each other, the first from ("));
}

TEST_CASE("edges' faults: four triangles at an edge are counted, split vertices are not") {
  voml::Mesh cube = voml::standard_cube();
  // A second cube that shares the edge x = y = 1.
  voml::Mesh second = cube;
  for (glm::dvec3& p : second.positions) p += glm::dvec3(2, 2, 0);
  voml::Mesh both = cube;
  both.positions.insert(both.positions.end(), second.positions.begin(), second.positions.end());
  for (const glm::uvec3& t : second.triangles) both.triangles.push_back(t + 8u);
  const voml::EdgeFaults faults = voml::find_edge_faults(both);
  CHECK(faults.count() == 1);
  CHECK(faults.crowded.count == 1);
  CHECK(voml::describe(faults) ==
        std::vector<std::string>{"1 edge has more than two triangles, from (1 1 -1) to (1 1 1)"});

  voml::Mesh split;
  for (const glm::uvec3& t : cube.triangles) {
    const auto first = static_cast<std::uint32_t>(split.positions.size());
    for (int corner = 0; corner < 3; ++corner) split.positions.push_back(cube.positions[t[corner]]);
    split.triangles.emplace_back(first, first + 1, first + 2);
  }
  CHECK(voml::find_edge_faults(split).count() == 0);
}

TEST_CASE("edges' faults: a triangle without area neither opens nor closes anything") {
  voml::Mesh cube = voml::standard_cube();
  cube.triangles.emplace_back(0, 1, 1);
  cube.triangles.emplace_back(2, 2, 2);
  CHECK(voml::find_edge_faults(cube).count() == 0);
}

}  // namespace dmvv::tests
