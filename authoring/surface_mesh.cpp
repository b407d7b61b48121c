#include "authoring/surface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <unordered_map>

namespace dmvv::authoring {
namespace {

using glm::dvec3;
using glm::ivec3;

constexpr int block_cells = 4;
constexpr int bisections = 9, more_bisections = 4;
constexpr std::size_t batch_points = std::size_t{1} << 18;
constexpr double drawn_in_cells = 0.06;  // at a time

/// As a file of float32 holds it: what is asked for is what will be drawn.
dvec3 stored(const dvec3& p) { return dvec3(glm::vec3(p)); }

enum Side : char { outside = 0, inside_it = 1, unknown = 2 };

/// Nodes of the grid, with a layer round the cube that is outside.
class Nodes {
 public:
  Nodes(const InsideTest& inside, int resolution)
      : inside_(inside),
        resolution_(resolution),
        edge_(resolution + 3),
        sides_(static_cast<std::size_t>(edge_) * static_cast<std::size_t>(edge_) * static_cast<std::size_t>(edge_),
               char{unknown}) {}

  int edge() const { return edge_; }
  std::size_t index(const ivec3& node) const {
    return (static_cast<std::size_t>(node.z) * static_cast<std::size_t>(edge_) + static_cast<std::size_t>(node.y)) *
               static_cast<std::size_t>(edge_) +
           static_cast<std::size_t>(node.x);
  }
  dvec3 position(const ivec3& node) const { return stored(dvec3(node - 1) * (2.0 / resolution_) - 1.0); }
  char side(const ivec3& node) const { return sides_[index(node)]; }

  void want(const ivec3& node) {
    char& side = sides_[index(node)];
    if (side != unknown) return;
    side = outside;  // so that it is wanted once
    if (glm::any(glm::lessThan(node, ivec3(1))) || glm::any(glm::greaterThan(node, ivec3(resolution_ + 1)))) return;
    wanted_.push_back(node);
  }

  /// Asks for all that is wanted.
  Result<void> ask() {
    std::vector<dvec3> points;
    for (std::size_t begin = 0; begin < wanted_.size(); begin += batch_points) {
      const std::size_t end = std::min(begin + batch_points, wanted_.size());
      points.clear();
      for (std::size_t i = begin; i < end; ++i) points.push_back(position(wanted_[i]));
      const auto answers = inside_(points);
      if (!answers) return tl::unexpected<Error>(answers.error());
      for (std::size_t i = begin; i < end; ++i) sides_[index(wanted_[i])] = (*answers)[i - begin];
    }
    wanted_.clear();
    return {};
  }

 private:
  const InsideTest& inside_;
  int resolution_, edge_;
  std::vector<char> sides_;
  std::vector<ivec3> wanted_;
};

/// Cubes of cells, of which those that the surface passes are known node by node.
class Blocks {
 public:
  explicit Blocks(Nodes& nodes)
      : nodes_(nodes),
        count_((nodes.edge() - 2) / block_cells + 1),
        known_(static_cast<std::size_t>(count_) * static_cast<std::size_t>(count_) * static_cast<std::size_t>(count_),
               0) {}

  Result<void> find() {
    const ivec3 all(count_);
    each(ivec3(0), all, [&](const ivec3& b) {
      each(ivec3(0), ivec3(2), [&](const ivec3& corner) { nodes_.want(node(b + corner)); });
    });
    if (auto asked = nodes_.ask(); !asked) return asked;
    std::vector<ivec3> wave, next;
    each(ivec3(0), all, [&](const ivec3& b) {
      if (mixed(b, b + 1, true)) enter(b, wave);
    });
    while (!wave.empty()) {
      for (const ivec3& b : wave) each(node(b), node(b + 1) + 1, [&](const ivec3& n) { nodes_.want(n); });
      if (auto asked = nodes_.ask(); !asked) return asked;
      next.clear();
      for (const ivec3& b : wave) {
        found.push_back(b);
        for (int axis = 0; axis < 3; ++axis) {
          for (int way = 0; way < 2; ++way) {
            ivec3 lo = b, hi = b + 1, beside = b;
            (way == 0 ? hi : lo)[axis] = (way == 0 ? lo : hi)[axis];
            beside[axis] += way == 0 ? -1 : 1;
            if (beside[axis] >= 0 && beside[axis] < count_ && mixed(lo, hi, false)) enter(beside, next);
          }
        }
      }
      std::swap(wave, next);
    }
    return {};
  }

  ivec3 node(const ivec3& block) const { return glm::min(block * block_cells, ivec3(nodes_.edge() - 1)); }

  /// What each(lo, hi, visit) visits: lo <= at < hi, x fastest.
  template <class Visit>
  static void each(const ivec3& lo, const ivec3& hi, Visit visit) {
    for (ivec3 at = lo; at.z < hi.z; ++at.z)
      for (at.y = lo.y; at.y < hi.y; ++at.y)
        for (at.x = lo.x; at.x < hi.x; ++at.x) visit(at);
  }

  std::vector<ivec3> found;

 private:
  /// Whether nodes from block lo to block hi, both ends included, lie on both sides; of their corners alone, or of all.
  bool mixed(const ivec3& lo, const ivec3& hi, bool corners) const {
    bool any[2] = {false, false};
    if (corners) {
      each(ivec3(0), ivec3(2), [&](const ivec3& c) { any[static_cast<int>(nodes_.side(node(lo + c)))] = true; });
    } else {
      each(node(lo), node(hi) + 1, [&](const ivec3& n) { any[static_cast<int>(nodes_.side(n))] = true; });
    }
    return any[0] && any[1];
  }

  void enter(const ivec3& b, std::vector<ivec3>& wave) {
    char& known =
        known_[(static_cast<std::size_t>(b.z) * static_cast<std::size_t>(count_) + static_cast<std::size_t>(b.y)) *
                   static_cast<std::size_t>(count_) +
               static_cast<std::size_t>(b.x)];
    if (known) return;
    known = 1;
    wave.push_back(b);
  }

  Nodes& nodes_;
  int count_;
  std::vector<char> known_;
};

/// The triangles of the tetrahedra that the surface passes, over crossings of their edges.
class Crossings {
 public:
  explicit Crossings(const Nodes& nodes) : nodes_(nodes) {}

  void add_cell(const ivec3& cell) {
    static constexpr int ways[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    char sides = 0;
    Blocks::each(cell, cell + 2,
                 [&](const ivec3& n) { sides = static_cast<char>(sides | (nodes_.side(n) == inside_it ? 1 : 2)); });
    if (sides != 3) return;
    for (const auto& way : ways) {
      std::array<ivec3, 4> corners{cell, cell, cell, cell + 1};
      ++corners[1][way[0]];
      corners[2] = corners[1];
      ++corners[2][way[1]];
      add_tetrahedron(corners);
    }
  }

  /// Moves every crossing to the boundary; it stays inside.
  Result<void> bisect(const InsideTest& inside) {
    std::vector<std::size_t> asked(ends_.size());
    std::iota(asked.begin(), asked.end(), std::size_t{0});
    if (auto moved = bisect(asked, bisections, inside); !moved) return moved;
    // Crossings of several edges that still stand at their node would be one vertex, and the surface no manifold there.
    std::erase_if(asked, [&](std::size_t i) { return ends_[i].moved; });
    return bisect(asked, more_bisections, inside);
  }

  voml::Mesh mesh() && {
    voml::Mesh result;
    result.positions.reserve(ends_.size());
    for (const Ends& ends : ends_) result.positions.push_back(ends.in);
    result.triangles = std::move(triangles_);
    return result;
  }

 private:
  struct Ends {
    dvec3 in, out;
    bool moved = false;  ///< `in` is no longer a node
  };

  Result<void> bisect(std::span<const std::size_t> asked, int rounds, const InsideTest& inside) {
    std::vector<dvec3> points;
    for (std::size_t begin = 0; begin < asked.size(); begin += batch_points) {
      const auto batch = asked.subspan(begin, std::min(batch_points, asked.size() - begin));
      for (int round = 0; round < rounds; ++round) {
        points.clear();
        for (const std::size_t i : batch) points.push_back(stored(0.5 * (ends_[i].in + ends_[i].out)));
        const auto answers = inside(points);
        if (!answers) return tl::unexpected<Error>(answers.error());
        for (std::size_t k = 0; k < batch.size(); ++k) {
          Ends& ends = ends_[batch[k]];
          ((*answers)[k] ? ends.in : ends.out) = points[k];
          ends.moved = ends.moved || (*answers)[k];
        }
      }
    }
    return {};
  }

  void add_tetrahedron(const std::array<ivec3, 4>& corners) {
    std::array<ivec3, 4> in, out;
    std::size_t ins = 0, outs = 0;
    for (const ivec3& corner : corners) nodes_.side(corner) == inside_it ? in[ins++] = corner : out[outs++] = corner;
    if (ins == 1) add_triangle({in[0], in[0], in[0]}, {out[0], out[1], out[2]});
    if (ins == 3) add_triangle({in[0], in[1], in[2]}, {out[0], out[0], out[0]});
    if (ins != 2) return;
    add_triangle({in[0], in[0], in[1]}, {out[0], out[1], out[1]});
    add_triangle({in[0], in[1], in[1]}, {out[0], out[1], out[0]});
  }

  /// Corner i is where the surface crosses the edge from in[i] to out[i].
  void add_triangle(const std::array<ivec3, 3>& in, const std::array<ivec3, 3>& out) {
    const auto middle = [&](std::size_t i) { return dvec3(in[i] + out[i]); };
    const dvec3 normal = glm::cross(middle(1) - middle(0), middle(2) - middle(0));
    const dvec3 outward = dvec3(out[0] + out[1] + out[2]) - dvec3(in[0] + in[1] + in[2]);
    const bool turned = glm::dot(normal, outward) < 0.0;
    const std::uint32_t a = vertex(in[0], out[0]), b = vertex(in[1], out[1]), c = vertex(in[2], out[2]);
    triangles_.push_back(turned ? glm::uvec3(a, c, b) : glm::uvec3(a, b, c));
  }

  std::uint32_t vertex(const ivec3& in, const ivec3& out) {
    const ivec3 lo = glm::min(in, out), along = glm::max(in, out) - lo;
    const std::size_t edge = nodes_.index(lo) * 8 + static_cast<std::size_t>(along.x + 2 * along.y + 4 * along.z);
    const auto [place, is_new] = vertex_of_.try_emplace(edge, static_cast<std::uint32_t>(ends_.size()));
    if (is_new) ends_.push_back({nodes_.position(in), nodes_.position(out), false});
    return place->second;
  }

  const Nodes& nodes_;
  std::unordered_map<std::size_t, std::uint32_t> vertex_of_;
  std::vector<Ends> ends_;
  std::vector<glm::uvec3> triangles_;
};

/// inside(points), asked in batches.
Result<std::vector<char>> ask(const InsideTest& inside, std::span<const dvec3> points) {
  std::vector<char> all;
  all.reserve(points.size());
  for (std::size_t begin = 0; begin < points.size(); begin += batch_points) {
    const auto sides = inside(points.subspan(begin, std::min(batch_points, points.size() - begin)));
    if (!sides) return tl::unexpected<Error>(sides.error());
    all.insert(all.end(), sides->begin(), sides->end());
  }
  return all;
}

/// The corners of triangles that pass outside, by their middle or the middle of an edge.
Result<std::vector<std::uint32_t>> corners_of_outer_triangles(const voml::Mesh& mesh, const InsideTest& inside) {
  constexpr std::size_t looked_at = 4;
  std::vector<dvec3> points;
  points.reserve(looked_at * mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    points.insert(points.end(), {(a + b + c) / 3.0, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)});
  }
  const auto sides = ask(inside, points);
  if (!sides) return tl::unexpected<Error>(sides.error());
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < sides->size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i / looked_at];
    if ((*sides)[i] == 0) corners.insert(corners.end(), {t.x, t.y, t.z});
  }
  std::ranges::sort(corners);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

/// Where the surface is hollow, triangles between its points pass outside: their corners move inward, a little at a
/// time.
Result<void> draw_in(voml::Mesh& mesh, double step, const InsideTest& inside) {
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    const auto corners = corners_of_outer_triangles(mesh, inside);
    if (!corners) return tl::unexpected<Error>(corners.error());
    if (corners->empty()) return {};
    std::vector<dvec3> normals(mesh.positions.size(), dvec3(0.0)), moved;
    for (const glm::uvec3& t : mesh.triangles) {
      const dvec3 a = mesh.positions[t.x], normal = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
      for (int i = 0; i < 3; ++i) normals[t[i]] += normal;
    }
    for (const std::uint32_t corner : *corners) {
      const double length = glm::length(normals[corner]);
      const dvec3 inward = length > 0.0 ? normals[corner] * (-step / length) : dvec3(0.0);
      moved.push_back(stored(mesh.positions[corner] + inward));
    }
    const auto sides = ask(inside, moved);
    if (!sides) return tl::unexpected<Error>(sides.error());
    for (std::size_t i = 0; i < moved.size(); ++i) {
      if ((*sides)[i] != 0) mesh.positions[(*corners)[i]] = moved[i];
    }
  }
  return {};
}

// ---- triangles without area ----

bool is_flat(const voml::Mesh& mesh, const glm::uvec3& t) {
  const dvec3 a = mesh.positions[t.x];
  return glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a) == dvec3(0.0);
}

/// Makes vertices at the same place one, and leaves out the triangles that have one twice. Every edge that was passed
/// as often in one direction as in the other still is.
void weld_vertices(voml::Mesh& mesh) {
  const std::vector<std::uint32_t> first = voml::first_of_equal(mesh.positions);
  for (glm::uvec3& t : mesh.triangles) t = {first[t.x], first[t.y], first[t.z]};
  std::erase_if(mesh.triangles, [](const glm::uvec3& t) { return t.x == t.y || t.y == t.z || t.z == t.x; });
}

/// The triangle's corners from the beginning of its longest edge on.
glm::uvec3 from_longest_edge(const voml::Mesh& mesh, const glm::uvec3& t) {
  const auto length = [&](std::uint32_t a, std::uint32_t b) {
    return glm::distance(mesh.positions[a], mesh.positions[b]);
  };
  const double xy = length(t.x, t.y), yz = length(t.y, t.z), zx = length(t.z, t.x);
  return xy >= yz && xy >= zx ? t : yz >= zx ? glm::uvec3(t.y, t.z, t.x) : glm::uvec3(t.z, t.x, t.y);
}

/// Of a triangle whose corners lie on a line the longest edge, and with it the triangle beside, is exchanged for the
/// other diagonal of the two. Again, where that made another one of the kind: its longest edge is shorter.
void flip_flat_triangles(voml::Mesh& mesh) {
  constexpr int most_rounds = 32;
  constexpr std::uint32_t gone = 0xffffffffu;
  const auto edge = [](std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32 | to; };
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<std::uint32_t> flat;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      if (is_flat(mesh, mesh.triangles[i])) flat.push_back(i);
    }
    if (flat.empty()) return;
    std::unordered_map<std::uint64_t, std::uint32_t> triangle_of;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      for (int k = 0; k < 3; ++k) triangle_of[edge(mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3])] = i;
    }
    std::vector<bool> changed(mesh.triangles.size(), false);
    for (const std::uint32_t i : flat) {
      const glm::uvec3 t = from_longest_edge(mesh, mesh.triangles[i]);
      const auto beside = triangle_of.find(edge(t.y, t.x));
      if (beside == triangle_of.end() || changed[i] || changed[beside->second] || beside->second == i) continue;
      glm::uvec3& other = mesh.triangles[beside->second];
      const std::uint32_t apex = other.x ^ other.y ^ other.z ^ t.x ^ t.y;  // the corner that is not t.x or t.y
      changed[i] = changed[beside->second] = true;
      mesh.triangles[i] = apex == t.z ? glm::uvec3(gone) : glm::uvec3(t.z, t.x, apex);
      other = apex == t.z ? glm::uvec3(gone) : glm::uvec3(apex, t.y, t.z);
    }
    std::erase_if(mesh.triangles, [](const glm::uvec3& t) { return t.x == gone; });
  }
}

void remove_unused_vertices(voml::Mesh& mesh) {
  constexpr std::uint32_t unused = 0xffffffffu;
  std::vector<std::uint32_t> number(mesh.positions.size(), unused);
  for (const glm::uvec3& t : mesh.triangles) number[t.x] = number[t.y] = number[t.z] = 0;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) {
    if (number[i] == unused) continue;
    mesh.positions[count] = mesh.positions[i];
    number[i] = count++;
  }
  mesh.positions.resize(count);
  for (glm::uvec3& t : mesh.triangles) t = {number[t.x], number[t.y], number[t.z]};
}

/// Crossings that stand at the same node make triangles without area.
void remove_flat_triangles(voml::Mesh& mesh) {
  weld_vertices(mesh);
  flip_flat_triangles(mesh);
  remove_unused_vertices(mesh);
}

}  // namespace

Result<voml::Mesh> surface_mesh(const InsideTest& inside, const SurfaceOptions& options) {
  if (options.resolution < 8 || options.resolution > max_surface_resolution) {
    return fail(Fault::input, fmt::format("the resolution is {}; it must be from 8 to {}", options.resolution,
                                          max_surface_resolution));
  }
  // Step 1: nodes on both sides of the surface.
  Nodes nodes(inside, static_cast<int>(options.resolution));
  Blocks blocks(nodes);
  if (const auto found = blocks.find(); !found) return tl::unexpected<Error>(found.error());
  // Step 2: the triangles between them.
  Crossings crossings(nodes);
  for (const ivec3& block : blocks.found)
    Blocks::each(blocks.node(block), blocks.node(block + 1), [&](const ivec3& cell) { crossings.add_cell(cell); });
  // Step 3: their corners, moved to the boundary.
  if (const auto moved = crossings.bisect(inside); !moved) return tl::unexpected<Error>(moved.error());
  voml::Mesh mesh = std::move(crossings).mesh();
  remove_flat_triangles(mesh);
  // Step 4: what still passes outside is drawn in.
  const double cell = 2.0 / options.resolution;
  if (const auto drawn = draw_in(mesh, drawn_in_cells * cell, inside); !drawn)
    return tl::unexpected<Error>(drawn.error());
  remove_flat_triangles(mesh);
  return mesh;
}

}  // namespace dmvv::authoring
