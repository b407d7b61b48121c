#include "support_mesh.h"

#include <cmath>
#include <numbers>

#include "parts.h"
#include "shapes.h"

namespace skin {

using assets::Mesh;

namespace {

/// A block below a height field: `n` cells along an edge of its upper side, walls down to `bottom`.
void add_block(Mesh& mesh, int n, double half, double bottom) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  const auto row = static_cast<std::uint32_t>(n + 1);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = half * (2.0 * i / n - 1.0), z = half * (2.0 * j / n - 1.0);
      mesh.points.emplace_back(x, surface_height(x, z) - 0.0035, z);
    }
  const auto top = [&](std::uint32_t i, std::uint32_t j) { return first + j * row + i; };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
  };
  const auto last = static_cast<std::uint32_t>(n);
  for (std::uint32_t j = 0; j < last; ++j)
    for (std::uint32_t i = 0; i < last; ++i) quad(top(i, j), top(i, j + 1), top(i + 1, j + 1), top(i + 1, j));
  // Around the edge, counterclockwise seen from above: down to the bottom, and from there to its middle.
  std::vector<std::uint32_t> edge;
  for (std::uint32_t k = 0; k < last; ++k) edge.push_back(top(k, last));
  for (std::uint32_t k = 0; k < last; ++k) edge.push_back(top(last, last - k));
  for (std::uint32_t k = 0; k < last; ++k) edge.push_back(top(last - k, 0));
  for (std::uint32_t k = 0; k < last; ++k) edge.push_back(top(0, k));
  const auto below = static_cast<std::uint32_t>(mesh.points.size());
  for (const std::uint32_t i : edge) mesh.points.emplace_back(mesh.points[i].x, bottom, mesh.points[i].z);
  const auto middle = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.emplace_back(0.0, bottom, 0.0);
  for (std::uint32_t k = 0; k < edge.size(); ++k) {
    const auto next = static_cast<std::uint32_t>((k + 1) % edge.size());
    quad(edge[k], below + k, below + next, edge[next]);
    mesh.triangles.emplace_back(middle, below + next, below + k);
  }
}

/// A round rod from `a` to `b`.
void add_rod(Mesh& mesh, dvec3 a, dvec3 b, const glm::dmat3& frame, double radius) {
  constexpr std::uint32_t sides = 20;
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (std::uint32_t k = 0; k < sides; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / sides;
    const dvec3 out = radius * (std::cos(turn) * frame[0] - std::sin(turn) * frame[2]);
    mesh.points.push_back(a + out);
    mesh.points.push_back(b + out);
  }
  mesh.points.push_back(a);
  mesh.points.push_back(b);
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t low = first + 2 * k, next = first + 2 * ((k + 1) % sides);
    mesh.triangles.emplace_back(low, next, next + 1);
    mesh.triangles.emplace_back(low, next + 1, low + 1);
    mesh.triangles.emplace_back(first + 2 * sides, next, low);
    mesh.triangles.emplace_back(first + 2 * sides + 1, low + 1, next + 1);
  }
}

}  // namespace

std::string support_mesh() {
  Mesh mesh;
  add_block(mesh, 220, 0.998, -0.998);
  for (const Placement& hair : hairs()) {
    // In the frame of HAIR the shaft ends at y = 0.875 and is 0.23 thick.
    const dvec3 end = hair.rotation[1] * hair.scale.y;
    add_rod(mesh, hair.position + end * 0.40, hair.position + end * 0.868, hair.rotation, 0.22 * hair.scale.x);
  }
  return to_ply(mesh, "support mesh of the skin");
}

}  // namespace skin
