// Writes the support mesh of a molecule, in the frame of `dmvv seeds`: the surface of the sum of its atoms' blobs
// (Blinn 1982, "A generalization of algebraic surface drawing").
//
// Marching tetrahedra: each cell is cut into six tetrahedra along its diagonal (Kuhn 1960), each of which the surface
// crosses in a triangle or a quad. The result is closed and every edge has two triangles.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "authoring/molecule.h"
#include "base/files.h"

namespace {

using dmvv::authoring::Atom;
using dmvv::authoring::MoleculeFrame;
using glm::dvec3;
using glm::ivec3;

/// How far a density falls below what the surface has: 1 minus the sum of Blinn's blobs exp(-softness (d^2/r^2 - 1)),
/// r being the van der Waals radius, at the n^3 corners of a grid over the standard cube. Negative inside.
class Field {
 public:
  static constexpr double softness = 1.4;  ///< the smaller, the more atoms melt together
  static constexpr double reach = 2.5;     ///< in radii: what lies beyond, 0.0005, is left out

  Field(const std::vector<Atom>& atoms, const MoleculeFrame& frame, int n) : n_(n), step_(2.0 / (n - 1)) {
    values_.assign(static_cast<std::size_t>(n) * n * n, 1.0f);
    for (const Atom& atom : atoms) {
      add((atom.position - frame.center) / frame.angstrom_per_unit, atom.element->radius / frame.angstrom_per_unit);
    }
  }

  int size() const { return n_; }
  dvec3 corner(const ivec3& c) const { return dvec3(c) * step_ - 1.0; }
  float at(const ivec3& c) const { return values_[index(c)]; }
  std::size_t index(const ivec3& c) const {
    return (static_cast<std::size_t>(c.z) * static_cast<std::size_t>(n_) + static_cast<std::size_t>(c.y)) *
               static_cast<std::size_t>(n_) +
           static_cast<std::size_t>(c.x);
  }

 private:
  void add(const dvec3& center, double radius) {
    const ivec3 lo = glm::max(ivec3(glm::floor((center - reach * radius + 1.0) / step_)), 0);
    const ivec3 hi = glm::min(ivec3(glm::ceil((center + reach * radius + 1.0) / step_)), n_ - 1);
    for (ivec3 c = lo; c.z <= hi.z; ++c.z) {
      for (c.y = lo.y; c.y <= hi.y; ++c.y) {
        for (c.x = lo.x; c.x <= hi.x; ++c.x) {
          const dvec3 d = (corner(c) - center) / radius;
          const double squared = glm::dot(d, d);
          if (squared > reach * reach) continue;
          values_[index(c)] -= static_cast<float>(std::exp(-softness * (squared - 1.0)));
        }
      }
    }
  }

  int n_;
  double step_;
  std::vector<float> values_;
};

class Surface {
 public:
  explicit Surface(Field field) : field_(std::move(field)) {
    const int cells = field_.size() - 1;
    for (ivec3 c(0); c.z < cells; ++c.z) {
      for (c.y = 0; c.y < cells; ++c.y) {
        for (c.x = 0; c.x < cells; ++c.x) add_cell(c);
      }
    }
  }

  /// Moves each vertex to the mean of its neighbours and itself: the slivers that tetrahedra leave go.
  void relax() {
    std::vector<dvec3> sums = vertices_;
    std::vector<double> counts(vertices_.size(), 1.0);
    for (const auto& t : triangles_) {
      for (std::size_t i = 0; i < 3; ++i) {
        sums[t[i] - 1] += vertices_[t[(i + 1) % 3] - 1];
        counts[t[i] - 1] += 1.0;
      }
    }
    for (std::size_t i = 0; i < vertices_.size(); ++i) vertices_[i] = sums[i] / counts[i];
  }

  bool write(const std::string& path) const {
    std::ofstream file(path);
    file.precision(6);
    for (const dvec3& v : vertices_) file << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
    for (const auto& t : triangles_) file << "f " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
    file.close();
    return !file.fail();
  }

 private:
  using Tetrahedron = std::array<ivec3, 4>;

  bool inside(const ivec3& corner) const { return field_.at(corner) <= 0.0f; }

  /// The six ways from the cell's lowest corner to its highest along the axes.
  void add_cell(const ivec3& cell) {
    static constexpr int ways[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int way = 0; way < 6; ++way) {
      Tetrahedron t;
      t[0] = t[1] = cell;
      ++t[1][ways[way][0]];
      t[2] = t[1];
      ++t[2][ways[way][1]];
      t[3] = cell + 1;
      if (way >= 3) std::swap(t[1], t[2]);  // a mirror image: now they are all right-handed
      add_tetrahedron(t);
    }
  }

  /// Brings the corners that are inside to the front, by an even number of exchanges, so that the tetrahedron stays
  /// right-handed; then the triangles' order is known.
  void add_tetrahedron(Tetrahedron t) {
    const auto count = std::ranges::count_if(t, [&](const ivec3& c) { return inside(c); });
    if (count == 0 || count == 4) return;
    bool even = true;
    for (std::size_t front = 0, i = 0; i < 4; ++i) {
      if (!inside(t[i])) continue;
      if (i != front) {
        std::swap(t[i], t[front]);
        even = !even;
      }
      ++front;
    }
    if (!even) count == 3 ? std::swap(t[0], t[1]) : std::swap(t[2], t[3]);
    if (count == 1) {
      add_triangle(vertex(t[0], t[1]), vertex(t[0], t[2]), vertex(t[0], t[3]));
    } else if (count == 3) {
      add_triangle(vertex(t[0], t[3]), vertex(t[1], t[3]), vertex(t[2], t[3]));
    } else {
      const std::uint32_t a = vertex(t[0], t[2]), b = vertex(t[0], t[3]), c = vertex(t[1], t[3]),
                          d = vertex(t[1], t[2]);
      add_triangle(a, b, c);
      add_triangle(a, c, d);
    }
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { triangles_.push_back({a, b, c}); }

  /// Where the surface crosses the edge between two corners; made once. OBJ counts from 1.
  std::uint32_t vertex(ivec3 a, ivec3 b) {
    if (a.x > b.x || a.y > b.y || a.z > b.z) std::swap(a, b);
    const ivec3 along = b - a;
    const auto edge = field_.index(a) * 8 + static_cast<std::size_t>(along.x + 2 * along.y + 4 * along.z);
    const auto [found, is_new] = vertex_of_.try_emplace(edge, static_cast<std::uint32_t>(vertices_.size() + 1));
    if (is_new) {
      const double at_a = field_.at(a), at_b = field_.at(b);
      vertices_.push_back(glm::mix(field_.corner(a), field_.corner(b), at_a / (at_a - at_b)));
    }
    return found->second;
  }

  Field field_;
  std::unordered_map<std::size_t, std::uint32_t> vertex_of_;  ///< edges of tetrahedra, by lower corner and direction
  std::vector<dvec3> vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fputs("usage: make_surface MOLECULE SURFACE.obj\n", stderr);
    return 2;
  }
  const auto bytes = dmvv::disk_files()(words[1], std::numeric_limits<std::uint32_t>::max());
  if (!bytes) {
    std::fprintf(stderr, "make_surface: %s\n", bytes.error().message.c_str());
    return 1;
  }
  dmvv::Diagnostics diagnostics;
  const auto molecule = dmvv::authoring::parse_molecule(words[1], *bytes, {}, diagnostics);
  std::fputs(diagnostics.render().c_str(), stderr);
  if (!molecule) return 1;
  Surface surface(Field(molecule->atoms, dmvv::authoring::fit_molecule(molecule->atoms), 77));
  for (int pass = 0; pass < 3; ++pass) surface.relax();
  if (surface.write(words[2])) return 0;
  std::fprintf(stderr, "make_surface: cannot write to %s\n", words[2]);
  return 1;
}
