// Surface -> clusters -> what of it a view needs.
#include "runtime/surface/clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

namespace dmvv::runtime {
namespace {

constexpr std::uint32_t cells_per_side = 64;
constexpr double rounding = 1e-5;        // of what shaders and rasterisers compute, against the sizes of a scene
constexpr double grazing_cosine = 0.05;  // triangles nearer to edge-on may turn by rounding

struct Triangle {
  std::array<glm::dvec3, 3> corners;

  Triangle(const Surface& surface, std::uint32_t first_index) {
    for (std::uint32_t i = 0; i < 3; ++i) corners[i] = surface.vertices[surface.indices[first_index + i]].position;
  }
  glm::dvec3 middle() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
  glm::dvec3 normal() const { return glm::cross(corners[1] - corners[0], corners[2] - corners[0]); }
};

/// Bits of x (below 64) at every third place.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

std::uint32_t morton_cell(const glm::dvec3& p, const voml::Bounds& bounds) {
  const glm::dvec3 size = glm::max(bounds.hi - bounds.lo, glm::dvec3(std::numeric_limits<double>::min()));
  const glm::dvec3 q = glm::clamp((p - bounds.lo) / size, 0.0, 1.0) * double(cells_per_side - 1);
  return spread_bits(static_cast<std::uint32_t>(q.x)) | spread_bits(static_cast<std::uint32_t>(q.y)) << 1 |
         spread_bits(static_cast<std::uint32_t>(q.z)) << 2;
}

/// Outward triangles first, each kind in the order of its cells, and within a cell as they were. Returns where the
/// outward ones end.
std::uint32_t order_triangles(Surface& surface, const std::vector<bool>& outward) {
  constexpr std::uint32_t cells = cells_per_side * cells_per_side * cells_per_side;
  std::vector<std::uint32_t> buckets(outward.size()), places(2 * cells + 1, 0);
  for (std::uint32_t t = 0; t < outward.size(); ++t) {
    buckets[t] = morton_cell(Triangle(surface, 3 * t).middle(), surface.bounds) + (outward[t] ? 0 : cells);
    ++places[buckets[t] + 1];
  }
  std::partial_sum(places.begin(), places.end(), places.begin());
  const std::uint32_t split = 3 * places[cells];
  std::vector<std::uint32_t> ordered(surface.indices.size());
  for (std::uint32_t t = 0; t < outward.size(); ++t) {
    std::copy_n(surface.indices.begin() + 3 * t, 3, ordered.begin() + 3 * places[buckets[t]]++);
  }
  surface.indices = std::move(ordered);
  return split;
}

void order_vertices(Surface& surface) {
  constexpr std::uint32_t unused = 0xffffffffu;
  std::vector<std::uint32_t> place(surface.vertices.size(), unused);
  std::vector<SurfaceVertex> ordered;
  ordered.reserve(surface.vertices.size());
  for (std::uint32_t& index : surface.indices) {
    if (place[index] == unused) {
      place[index] = static_cast<std::uint32_t>(ordered.size());
      ordered.push_back(surface.vertices[index]);
    }
    index = place[index];
  }
  surface.vertices = std::move(ordered);
}

Cluster bound_cluster(const Surface& surface, IndexRange range) {
  glm::dvec3 lo(std::numeric_limits<double>::max()), hi(-lo), sum(0.0);
  std::vector<Triangle> triangles;
  for (std::uint32_t i = range.first; i < range.first + range.count; i += 3) {
    const Triangle& triangle = triangles.emplace_back(surface, i);
    for (const glm::dvec3& corner : triangle.corners) lo = glm::min(lo, corner), hi = glm::max(hi, corner);
    sum += triangle.normal();
  }
  Cluster cluster{.indices = range, .center = 0.5 * (lo + hi)};
  double cosine = glm::length(sum) > 0.0 ? 1.0 : 0.0;
  if (cosine > 0.0) cluster.axis = glm::normalize(sum);
  for (const Triangle& triangle : triangles) {
    for (const glm::dvec3& corner : triangle.corners) {
      cluster.radius = std::max(cluster.radius, glm::distance(corner, cluster.center));
    }
    const glm::dvec3 normal = triangle.normal();
    const double length = glm::length(normal);
    if (length > 0.0) cosine = std::min(cosine, glm::dot(normal, cluster.axis) / length);
  }
  if (cosine > 0.0) cluster.sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  return cluster;
}

/// Where all of a cluster lies, if it does lie somewhere.
enum class Side { in, out, both };

Side operator&(Side a, Side b) {
  return a == Side::out || b == Side::out ? Side::out : a == Side::in && b == Side::in ? Side::in : Side::both;
}

Side operator!(Side side) { return side == Side::both ? Side::both : side == Side::in ? Side::out : Side::in; }

/// By what the plane leaves.
Side side_of(const Cluster& cluster, const gpu::CutPlane& cut, double margin) {
  const double beyond = glm::dot(glm::dvec3(cut.plane), cluster.center) - static_cast<double>(cut.plane.w);
  if (beyond > cluster.radius + margin) return Side::out;
  return beyond < -cluster.radius - margin ? Side::in : Side::both;
}

/// The four sides of what a tile shows, by their normals into it, all through the eye.
std::array<glm::dvec3, 4> tile_sides(const gpu::RasterParams& raster, const Tile& tile) {
  const auto ray = [&](std::uint32_t x, std::uint32_t y) {
    return glm::dvec3(raster.ray) + double(x) * glm::dvec3(raster.ray_x) + double(y) * glm::dvec3(raster.ray_y);
  };
  const glm::uvec2 lo = tile.corner_px, hi = lo + tile.size_px;
  const std::array corners{ray(lo.x, lo.y), ray(hi.x, lo.y), ray(hi.x, hi.y), ray(lo.x, hi.y)};
  std::array<glm::dvec3, 4> sides;
  for (std::size_t i = 0; i < 4; ++i) sides[i] = glm::normalize(glm::cross(corners[i], corners[(i + 1) % 4]));
  return sides;
}

/// All of its triangles show their backs (Shirman and Abi-Ezzi 1993).
bool turned_away(const Cluster& cluster, const glm::dvec3& from_eye, double distance) {
  const double sine = std::min(1.0, cluster.sine + grazing_cosine);
  return glm::dot(from_eye, cluster.axis) > sine * distance + (1.0 + grazing_cosine) * cluster.radius;
}

struct Place {
  bool in_view;
  bool turned_away;
  Side left;        ///< by all cuts
  Side beyond_cap;  ///< where the mesh's fragments count for caps (shaders/triangle.glsl)
};

Place place_of(const Cluster& cluster, const FrameSetup& setup, std::span<const glm::dvec3> sides) {
  const glm::dvec3 from_eye = cluster.center - setup.eye;
  const double distance = glm::length(from_eye);
  const double margin = rounding * (cluster.radius + distance + glm::length(cluster.center));
  const auto behind = [&](const glm::dvec3& side) { return glm::dot(from_eye, side) < -cluster.radius - margin; };
  const gpu::RasterParams& raster = setup.raster;
  Side left = Side::in, left_by_front = Side::in;
  for (gpu::uint i = 0; i < raster.cut_count; ++i) {
    left = left & side_of(cluster, raster.cuts[i], margin);
    if (i + 1 == raster.front_count) left_by_front = left;
  }
  return {.in_view = !behind(setup.forward) && std::ranges::none_of(sides, behind),
          .turned_away = turned_away(cluster, from_eye, distance),
          .left = left,
          .beyond_cap = raster.front_count != 0 ? left_by_front : !left};
}

}  // namespace

std::vector<Cluster> make_clusters(Surface& surface, const std::vector<bool>& outward) {
  const std::uint32_t split = order_triangles(surface, outward);
  order_vertices(surface);
  std::vector<Cluster> clusters;
  const auto count = static_cast<std::uint32_t>(surface.indices.size());
  for (std::uint32_t first = 0, end = 0; first < count; first = end) {
    end = std::min(first + 3 * triangles_of_cluster, first < split ? split : count);
    clusters.push_back(bound_cluster(surface, {first, end - first}));
    clusters.back().has_seen_backs = first >= split;
  }
  return clusters;
}

Result<ArrangedMesh> arrange_mesh(const voml::Mesh& mesh) {
  auto surface = make_surface(mesh);
  if (!surface) return tl::unexpected(std::move(surface.error()));
  ArrangedMesh arranged{std::move(*surface), {}, voml::find_edge_faults(mesh)};
  const std::vector<bool> outward =
      arranged.edges.count() == 0 ? voml::outward_triangles(mesh) : std::vector<bool>(mesh.triangles.size(), false);
  arranged.clusters = make_clusters(arranged.surface, outward);
  return arranged;
}

std::vector<DrawCall> plan_draw(std::span<const Cluster> clusters, const FrameSetup& setup, const Tile& tile,
                                bool shows_all_backs) {
  const std::array sides = tile_sides(setup.raster, tile);
  std::vector<DrawCall> calls;
  for (const Cluster& cluster : clusters) {
    const Place place = place_of(cluster, setup, sides);
    const bool shows_backs = shows_all_backs || cluster.has_seen_backs;
    if (!place.in_view) continue;
    const bool is_seen = place.left != Side::out && (shows_backs || !place.turned_away);
    const bool counts = setup.has_caps && place.beyond_cap != Side::out;
    if (!is_seen && !counts) continue;
    const bool is_cut = (is_seen && place.left == Side::both) || (counts && place.beyond_cap == Side::both) ||
                        (is_seen && counts && place.left != place.beyond_cap);
    calls.push_back({{is_seen, counts, is_cut, shows_backs}, cluster.indices});
  }
  return calls;
}

std::vector<DrawCall> plan_whole(std::span<const Cluster> clusters, const FrameSetup& setup, bool shows_all_backs) {
  const bool is_cut = setup.raster.cut_count != 0;
  std::vector<DrawCall> calls;
  for (const Cluster& cluster : clusters) {
    calls.push_back({{true, setup.has_caps, is_cut, shows_all_backs || cluster.has_seen_backs}, cluster.indices});
  }
  return calls;
}

}  // namespace dmvv::runtime
