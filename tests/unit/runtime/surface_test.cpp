#include "runtime/surface/surface.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "support.h"

using namespace dmvv;
using namespace dmvv::tests;

TEST_CASE("the cube keeps its flat faces") {
  const auto surface = must(runtime::make_surface(voml::standard_cube()));
  CHECK(surface.vertices.size() == 24);  // 8 corners, one copy a face
  CHECK(surface.indices.size() == 36);
  for (std::size_t i = 0; i < surface.indices.size(); i += 3) {
    glm::vec3 p[3];
    for (std::size_t k = 0; k < 3; ++k) p[k] = surface.vertices[surface.indices[i + k]].position;
    const glm::vec3 face = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    for (std::size_t k = 0; k < 3; ++k) CHECK(surface.vertices[surface.indices[i + k]].normal == face);
  }
}

TEST_CASE("a fine sphere is smooth") {
  const auto mesh = sphere(1.0, {0.0, 0.0, 0.0}, 24);
  const auto surface = must(runtime::make_surface(mesh));
  CHECK(surface.vertices.size() == mesh.positions.size());
  for (const auto& vertex : surface.vertices) CHECK(glm::dot(vertex.normal, vertex.position) > 0.999f);
}

TEST_CASE("edges bent by more than 40 degrees split, others do not") {
  const auto vertices_of_roof = [](double bend_deg) {
    const double a = bend_deg * std::numbers::pi / 180.0;
    const voml::Mesh roof{{{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {std::cos(a), 0, -std::sin(a)}}, {{0, 1, 2}, {1, 0, 3}}};
    return must(runtime::make_surface(roof)).vertices.size();
  };
  CHECK(vertices_of_roof(39.0) == 4);
  CHECK(vertices_of_roof(41.0) == 6);
}

TEST_CASE("normals are weighted by angle, not by the number of triangles") {
  // A corner of three faces of a shallow pyramid, one of them cut into two triangles: the apex normal stays +z.
  const double h = 0.2;
  const auto rim = [](double turn) { return glm::dvec3(std::cos(turn), std::sin(turn), 0.0); };
  const double third = 2.0 * std::numbers::pi / 3.0;
  voml::Mesh pyramid{{{0, 0, h}, rim(0), rim(third), rim(2 * third), 0.5 * (rim(0) + rim(third))}, {}};
  pyramid.triangles = {{0, 1, 4}, {0, 4, 2}, {0, 2, 3}, {0, 3, 1}};
  const auto surface = must(runtime::make_surface(pyramid));
  const auto apex =
      std::find_if(surface.vertices.begin(), surface.vertices.end(), [](const auto& v) { return v.position.z > 0; });
  CHECK(apex->normal.z == doctest::Approx(1.0).epsilon(1e-6));
}

TEST_CASE("broken meshes are refused") {
  CHECK(runtime::make_surface({}).error().message == "the support mesh has no triangle");
  voml::Mesh mesh = voml::standard_cube();
  mesh.positions[5].y = NAN;
  CHECK(runtime::make_surface(mesh).error().message.find("vertex 5") != std::string::npos);
  mesh.positions[5].y = 1e200;
  CHECK(runtime::make_surface(mesh).error().message.find("1e+200") != std::string::npos);
  mesh = voml::standard_cube();
  mesh.triangles.push_back({0, 0, 1});  // without area: drawn as nothing, harmless
  CHECK(runtime::make_surface(mesh).has_value());
}
