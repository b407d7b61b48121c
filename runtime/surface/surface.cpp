// Support mesh -> vertices with normals, split at creases.
#include "runtime/surface/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <span>

namespace dmvv::runtime {
namespace {

constexpr double crease_deg = 40.0;
constexpr double largest_coordinate = 1e15;  // squares and products of float32 stay finite far beyond

std::optional<Error> find_fault(const voml::Mesh& mesh) {
  if (mesh.triangles.empty()) return Error{Fault::input, "the support mesh has no triangle", {}};
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec3& p = mesh.positions[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::abs(p[axis]) <= largest_coordinate)) {
        return Error{Fault::input,
                     fmt::format("vertex {} of the support mesh has the coordinate {}; {} is the most", i, p[axis],
                                 largest_coordinate),
                     {}};
      }
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      if (mesh.triangles[i][corner] >= mesh.positions.size()) {
        return Error{Fault::input,
                     fmt::format("triangle {} of the support mesh refers to vertex {} of {}", i,
                                 mesh.triangles[i][corner], mesh.positions.size()),
                     {}};
      }
    }
  }
  return std::nullopt;
}

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : glm::dvec3(0.0);
}

std::vector<glm::dvec3> face_normals(const voml::Mesh& mesh) {
  std::vector<glm::dvec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3& a = mesh.positions[t.x];
    normals.push_back(unit_or_zero(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a)));
  }
  return normals;
}

double corner_angle(const voml::Mesh& mesh, std::uint32_t corner) {
  const glm::uvec3& t = mesh.triangles[corner / 3];
  const int at = static_cast<int>(corner % 3);
  const glm::dvec3& p = mesh.positions[t[at]];
  const glm::dvec3 a = unit_or_zero(mesh.positions[t[(at + 1) % 3]] - p);
  const glm::dvec3 b = unit_or_zero(mesh.positions[t[(at + 2) % 3]] - p);
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// The corners (3 * triangle + place) of every vertex: those of vertex v are corners[first[v]] .. corners[first[v +
/// 1]].
struct VertexCorners {
  std::vector<std::uint32_t> first, corners;

  explicit VertexCorners(const voml::Mesh& mesh)
      : first(mesh.positions.size() + 1, 0), corners(3 * mesh.triangles.size()) {
    for (const glm::uvec3& t : mesh.triangles) {
      for (int i = 0; i < 3; ++i) ++first[t[i] + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t c = 0; c < corners.size(); ++c)
      corners[next[mesh.triangles[c / 3][static_cast<int>(c % 3)]]++] = c;
  }
  std::span<const std::uint32_t> of(std::size_t vertex) const {
    return {corners.data() + first[vertex], corners.data() + first[vertex + 1]};
  }
};

/// Groups corners of one vertex whose faces share a smooth edge there; group[i] is the first corner of i's group.
class SmoothGroups {
 public:
  const std::vector<std::uint32_t>& of(const voml::Mesh& mesh, const std::vector<glm::dvec3>& normals,
                                       std::span<const std::uint32_t> corners) {
    static const double smooth_cosine = std::cos(crease_deg * std::numbers::pi / 180.0);
    group_.resize(corners.size());
    std::iota(group_.begin(), group_.end(), 0u);
    edges_.clear();
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
      const glm::uvec3& t = mesh.triangles[corners[i] / 3];
      const int at = static_cast<int>(corners[i] % 3);
      edges_.push_back({t[(at + 1) % 3], i});
      edges_.push_back({t[(at + 2) % 3], i});
    }
    std::ranges::sort(edges_);
    for (std::size_t e = 1; e < edges_.size(); ++e) {
      if (edges_[e - 1].first != edges_[e].first) continue;
      const std::uint32_t a = edges_[e - 1].second, b = edges_[e].second;
      if (glm::dot(normals[corners[a] / 3], normals[corners[b] / 3]) >= smooth_cosine) join(a, b);
    }
    for (std::uint32_t i = 0; i < group_.size(); ++i) group_[i] = leader(i);
    return group_;
  }

 private:
  std::uint32_t leader(std::uint32_t i) {
    while (group_[i] != i) i = group_[i] = group_[group_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = leader(a), b = leader(b);
    group_[std::max(a, b)] = std::min(a, b);
  }

  std::vector<std::uint32_t> group_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;  // (vertex at the other end, corner)
};

}  // namespace

Result<Surface> make_surface(const voml::Mesh& mesh) {
  if (auto fault = find_fault(mesh)) return tl::unexpected(std::move(*fault));
  Surface surface;
  surface.bounds = voml::bounds(mesh);
  surface.indices.resize(3 * mesh.triangles.size());
  const std::vector<glm::dvec3> normals = face_normals(mesh);
  const VertexCorners vertex_corners(mesh);
  SmoothGroups groups;
  std::vector<glm::dvec3> sums;
  std::vector<std::uint32_t> vertices;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto corners = vertex_corners.of(v);
    const auto& group = groups.of(mesh, normals, corners);
    sums.assign(corners.size(), glm::dvec3(0.0));
    vertices.assign(corners.size(), 0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      sums[group[i]] += corner_angle(mesh, corners[i]) * normals[corners[i] / 3];
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (group[i] == i) {
        vertices[i] = static_cast<std::uint32_t>(surface.vertices.size());
        const glm::dvec3 sum = glm::length(sums[i]) > 0.0 ? sums[i] : normals[corners[i] / 3];
        surface.vertices.push_back({glm::vec3(mesh.positions[v]), glm::vec3(unit_or_zero(sum))});
      }
      surface.indices[corners[i]] = vertices[group[i]];
    }
  }
  return surface;
}

}  // namespace dmvv::runtime
