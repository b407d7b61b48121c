#include "support_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>

#include "examples/assets.h"
#include "examples/cells.h"
#include "examples/noise.h"
#include "shapes.h"

namespace orange {

using namespace assets;

namespace {

/// Points of the unit sphere and triangles: an icosahedron whose faces are split into n^2 triangles.
struct Sphere {
  std::vector<dvec3> directions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Sphere geodesic_sphere(int n) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  const std::array<dvec3, 12> corners = {{{-1, g, 0},
                                          {1, g, 0},
                                          {-1, -g, 0},
                                          {1, -g, 0},
                                          {0, -1, g},
                                          {0, 1, g},
                                          {0, -1, -g},
                                          {0, 1, -g},
                                          {g, 0, -1},
                                          {g, 0, 1},
                                          {-g, 0, -1},
                                          {-g, 0, 1}}};
  constexpr std::array<std::array<int, 3>, 20> faces = {{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                         {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                         {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                         {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}}};
  Sphere sphere;
  // A point is known by its weights at the corners, so faces share the points of their common edges exactly.
  std::map<std::array<std::array<int, 2>, 3>, std::uint32_t> known;
  const auto point = [&](const std::array<int, 3>& face, int i, int j) {
    std::array<std::array<int, 2>, 3> key = {{{face[0], n - i - j}, {face[1], i}, {face[2], j}}};
    for (auto& [corner, weight] : key)
      if (weight == 0) corner = -1;
    std::sort(key.begin(), key.end());
    const auto [entry, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(sphere.directions.size()));
    if (is_new) {
      dvec3 sum(0.0);
      for (const auto& [corner, weight] : key)
        if (weight != 0) sum += corners[corner] * double(weight);
      sphere.directions.push_back(glm::normalize(sum));
    }
    return entry->second;
  };
  for (const auto& face : faces)
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        sphere.triangles.push_back({point(face, i, j), point(face, i + 1, j), point(face, i, j + 1)});
        if (i + j + 1 < n)
          sphere.triangles.push_back({point(face, i + 1, j), point(face, i + 1, j + 1), point(face, i, j + 1)});
      }
  return sphere;
}

/// How deep each mesh point lies below the skin: a margin that keeps the mesh inside the scene, and the dimples, drawn
/// a little wider and deeper than their distance fields.
std::vector<double> mesh_depths(const std::vector<dvec3>& directions, const std::vector<Gland>& glands) {
  const double margin = 0.0035;
  Cells cells(0.04);
  std::vector<double> depths;
  for (const dvec3 d : directions) {
    cells.add(d, static_cast<std::uint32_t>(depths.size()));
    // The furrows at the stem are the hardest for the skin's grid.
    depths.push_back(margin + (d.y > 0.0 ? 0.004 * bell(std::sqrt(d.x * d.x + d.z * d.z) / 0.3) : 0.0));
  }
  for (const Gland& gland : glands)
    cells.visit_near(gland.direction, [&](std::uint32_t i) {
      const double distance = glm::length(directions[i] - gland.direction);
      const double dimple = 0.0080 * gland.size * bell(distance / (0.034 * gland.size));
      depths[i] = std::max(depths[i], margin + dimple);
    });
  return depths;
}

}  // namespace

std::string support_mesh(const std::vector<Gland>& glands) {
  const Sphere sphere = geodesic_sphere(76);
  const std::vector<double> depths = mesh_depths(sphere.directions, glands);
  Mesh mesh;
  for (std::size_t i = 0; i < sphere.directions.size(); ++i)
    mesh.points.push_back(sphere.directions[i] * (skin_radius(sphere.directions[i]) - depths[i]));
  for (const auto& t : sphere.triangles) mesh.triangles.emplace_back(t[0], t[1], t[2]);
  return to_ply(mesh, "support mesh of the orange");
}

}  // namespace orange
