// Meshes of shapes whose distances are known, and exact answers by going through all triangles.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "authoring/triangle_tree.h"
#include "voml/assets/grid.h"
#include "voml/assets/mesh.h"

namespace dmvv::tests {

using glm::dvec3;

// ---- meshes ----

/// A sphere of unit radius: an octahedron whose triangles are cut into four again and again.
inline voml::Mesh sphere(int subdivisions) {
  voml::Mesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                  {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int i = 0; i < subdivisions; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), mesh.positions.size());
      if (is_new) mesh.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
      return found->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& t : mesh.triangles) {
      const std::uint32_t xy = middle(t.x, t.y), yz = middle(t.y, t.z), zx = middle(t.z, t.x);
      finer.insert(finer.end(), {{t.x, xy, zx}, {xy, t.y, yz}, {zx, yz, t.z}, {xy, yz, zx}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// A torus about the z axis: radius 1 to the middle of the tube, tube radius `tube`.
inline voml::Mesh torus(double tube, std::uint32_t around, std::uint32_t across) {
  voml::Mesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t k = 0; k < across; ++k) {
      const double u = 2.0 * std::numbers::pi * i / around, v = 2.0 * std::numbers::pi * k / across;
      const double r = 1.0 + tube * std::cos(v);
      mesh.positions.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return a % around * across + b % across; };
      mesh.triangles.emplace_back(at(i, k), at(i + 1, k), at(i + 1, k + 1));
      mesh.triangles.emplace_back(at(i, k), at(i + 1, k + 1), at(i, k + 1));
    }
  }
  return mesh;
}

inline voml::Mesh box(const dvec3& lo, const dvec3& hi) {
  voml::Mesh mesh = voml::standard_cube();
  for (dvec3& p : mesh.positions) p = lo + 0.5 * (p + 1.0) * (hi - lo);
  return mesh;
}

inline voml::Mesh inside_out(voml::Mesh mesh) {
  for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

inline voml::Mesh transformed(voml::Mesh mesh, double scale, const dvec3& offset) {
  for (dvec3& p : mesh.positions) p = scale * p + offset;
  return mesh;
}

inline voml::Mesh joined(voml::Mesh mesh, const voml::Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(t + first);
  return mesh;
}

inline std::vector<authoring::Corners> corners_of(const voml::Mesh& mesh) {
  std::vector<authoring::Corners> triangles;
  for (const glm::uvec3& t : mesh.triangles) {
    triangles.push_back({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]});
  }
  return triangles;
}

// ---- distances known from mathematics ----

inline double box_distance(const dvec3& p, const dvec3& lo, const dvec3& hi) {
  const dvec3 outside = glm::max(lo - p, p - hi);
  return glm::length(glm::max(outside, 0.0)) + std::min(std::max({outside.x, outside.y, outside.z}), 0.0);
}

inline double torus_distance(const dvec3& p, double tube) { return std::hypot(std::hypot(p.x, p.y) - 1.0, p.z) - tube; }

// ---- exact answers by brute force, written unlike the code under test ----

inline double squared_distance_to_segment(const dvec3& p, const dvec3& a, const dvec3& b) {
  const dvec3 ab = b - a;
  const double t = glm::dot(ab, ab) > 0.0 ? glm::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0, 1.0) : 0.0;
  return glm::dot(p - (a + t * ab), p - (a + t * ab));
}

/// The plane's distance where the foot point lies inside all three edges, else that of the nearest edge.
inline double squared_distance(const dvec3& p, const authoring::Corners& t) {
  const dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  bool above_face = glm::dot(normal, normal) > 0.0;
  double edges = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const dvec3 a = t[i], b = t[(i + 1) % 3];
    above_face = above_face && glm::dot(glm::cross(b - a, p - a), normal) >= 0.0;
    edges = std::min(edges, squared_distance_to_segment(p, a, b));
  }
  if (!above_face) return edges;
  const double height = glm::dot(normal, p - t[0]);
  return height * height / glm::dot(normal, normal);
}

inline double distance(const dvec3& p, const std::vector<authoring::Corners>& triangles) {
  double nearest2 = std::numeric_limits<double>::infinity();
  for (const authoring::Corners& triangle : triangles) nearest2 = std::min(nearest2, squared_distance(p, triangle));
  return std::sqrt(nearest2);
}

/// Sum of the solid angles by the formula of van Oosterom and Strackee.
inline double winding_number(const dvec3& p, const std::vector<authoring::Corners>& triangles) {
  double sum = 0.0;
  for (const authoring::Corners& t : triangles) {
    const dvec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)),
                            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (4.0 * std::numbers::pi);
}

// ---- grids ----

/// Calls visit(centre, value) for every sample, where the specification of Grid says that it stands.
template <class Visit>
void for_each_sample(const voml::Grid& grid, Visit visit) {
  std::size_t i = 0;
  for (std::uint32_t z = 0; z < grid.size.z; ++z) {
    for (std::uint32_t y = 0; y < grid.size.y; ++y) {
      for (std::uint32_t x = 0; x < grid.size.x; ++x, ++i) {
        visit(grid.box_lo + (dvec3(x, y, z) + 0.5) / dvec3(grid.size) * (grid.box_hi - grid.box_lo),
              static_cast<double>(grid.values[i]));
      }
    }
  }
}

}  // namespace dmvv::tests
