#include "authoring/grid_check.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "authoring/slices.h"
#include "authoring/triangle_tree.h"
#include "compiler/reference.h"

namespace dmvv::authoring {

namespace {

/// SplitMix64 (Steele, Lea, Flood 2014): chance that is the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  glm::uvec3 below(const glm::uvec3& size) {
    const std::uint64_t x = next() % size.x, y = next() % size.y, z = next() % size.z;
    return {x, y, z};
  }
  glm::dvec3 in_box(const glm::dvec3& lo, const glm::dvec3& hi) {
    const double x = unit(), y = unit(), z = unit();
    return lo + glm::dvec3(x, y, z) * (hi - lo);
  }
  glm::dvec3 direction() {
    const double z = 2.0 * unit() - 1.0, turn = 2.0 * std::numbers::pi * unit();
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    return {r * std::cos(turn), r * std::sin(turn), z};
  }

 private:
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
  }
  std::uint64_t state_;
};

class Tally {
 public:
  void add(double error, const glm::dvec3& p) {
    ++errors_.points;
    sum2_ += error * error;
    if (!(error <= errors_.greatest)) {
      errors_.greatest = error;
      errors_.where = p;
    }
  }
  Errors result() const {
    Errors errors = errors_;
    if (errors.points != 0) errors.root_mean_square = std::sqrt(sum2_ / static_cast<double>(errors.points));
    return errors;
  }

 private:
  Errors errors_;
  double sum2_ = 0.0;
};

/// What a grid is compared with.
struct Exact {
  std::function<double(const glm::dvec3&)> value;
  std::function<double(const glm::dvec3&)> slope;  ///< of `value`
  bool grid_has_value;                             ///< else the grid's are distances with the sign of `value`
};

double longest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

/// The results for each of n numbers, computed on all cores.
template <class T>
std::vector<T> for_all(std::size_t n, const std::function<T(std::size_t)>& f) {
  constexpr std::size_t run = 64;
  std::vector<T> results(n);
  const auto some = [&](std::uint32_t part) {
    for (std::size_t i = part * run; i < std::min(n, (part + 1) * run); ++i) results[i] = f(i);
  };
  for_each_slice(static_cast<std::uint32_t>((n + run - 1) / run), 0, some, {}, 0, 0);
  return results;
}

/// A place with the grid's value there.
struct Probe {
  glm::dvec3 p;
  double value;
  bool at_sample;
};

void check_volume(const voml::Grid& grid, const Exact& exact, std::size_t points, GridCheck& check) {
  Random random(1);
  std::vector<Probe> probes;
  probes.reserve(2 * points);
  const glm::dvec3 first = centre_of(grid, glm::dvec3(0.0)), last = centre_of(grid, glm::dvec3(grid.size - 1u));
  for (std::size_t i = 0; i < points; ++i) {
    const glm::uvec3 at = random.below(grid.size);
    const double stored = grid.values[(std::size_t{at.z} * grid.size.y + at.y) * grid.size.x + at.x];
    probes.push_back({centre_of(grid, at), stored, true});
    const glm::dvec3 p = random.in_box(first, last);
    probes.push_back({p, compiler::sample(grid, p), false});
  }
  const auto expected = for_all<double>(probes.size(), [&](std::size_t i) { return exact.value(probes[i].p); });

  Tally samples, between, wrong;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const auto& [p, value, at_sample] = probes[i];
    (at_sample ? samples : between).add(std::abs(value - expected[i]), p);
    if ((value <= 0.0) != (expected[i] <= 0.0)) wrong.add(std::abs(expected[i]) / exact.slope(p), p);
  }
  if (exact.grid_has_value) {
    check.samples = samples.result();
    check.between = between.result();
  }
  check.wrong_side = wrong.result();
  check.side_points = probes.size();
}

// ---- meshes ----

/// Points spread evenly over the area of all triangles.
struct OnTriangle {
  glm::dvec3 p, normal;
};
std::vector<OnTriangle> spread(const TriangleTree& tree, std::size_t points) {
  std::vector<double> area_up_to;
  area_up_to.reserve(tree.triangle_count());
  double area = 0.0;
  for (TriangleTree::Index i = 0; i < tree.triangle_count(); ++i) {
    area_up_to.push_back(area += tree.triangle(i).area());
  }
  std::vector<OnTriangle> result;
  if (!(area > 0.0)) return result;
  Random random(2);
  for (std::size_t i = 0; i < points; ++i) {
    const auto found = std::ranges::upper_bound(area_up_to, area * random.unit());
    const auto index = static_cast<TriangleTree::Index>(
        std::min<std::ptrdiff_t>(found - area_up_to.begin(), static_cast<std::ptrdiff_t>(area_up_to.size()) - 1));
    const Triangle& triangle = tree.triangle(index);
    const Corners c = triangle.corners();
    const double root = std::sqrt(random.unit()), v = random.unit();
    const glm::dvec3 normal = triangle.area_vector();
    result.push_back({(1.0 - root) * c[0] + root * (1.0 - v) * c[1] + root * v * c[2], normal / glm::length(normal)});
  }
  return result;
}

}  // namespace

GridCheck check_grid(const voml::Grid& grid, const voml::Mesh& mesh, const GridReport& report, std::size_t points) {
  std::vector<Corners> triangles;
  triangles.reserve(mesh.triangles.size());
  const auto placed = [&](std::uint32_t vertex) {
    return report.cube_from_mesh_scale * mesh.positions[vertex] + report.cube_from_mesh_offset;
  };
  for (const glm::uvec3& t : mesh.triangles) triangles.push_back({placed(t.x), placed(t.y), placed(t.z)});
  const TriangleTree tree(triangles);
  triangles = {};
  const double orientation = tree.signed_volume() < 0.0 ? -1.0 : 1.0;
  constexpr double accuracy = 4.0;
  const auto solid = [&](const glm::dvec3& p) { return orientation * tree.winding_number(p, accuracy) > 0.5; };
  const Exact exact{.value = [&](const glm::dvec3& p) { return solid(p) ? -tree.distance(p) : tree.distance(p); },
                    .slope = [](const glm::dvec3&) { return 1.0; },
                    .grid_has_value = true};

  GridCheck check;
  check.voxel = longest(step_of(grid));
  check_volume(grid, exact, points, check);

  Tally surface;
  std::size_t bounding_nothing = 0;
  const double beside = 1e-4 * check.voxel;
  const std::vector<OnTriangle> drawn = spread(tree, points);
  const auto bounds = for_all<char>(drawn.size(), [&](std::size_t i) {
    const auto& [p, normal] = drawn[i];
    return solid(p + beside * normal) != solid(p - beside * normal);
  });
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (bounds[i]) {
      surface.add(std::abs(compiler::sample(grid, drawn[i].p)), drawn[i].p);
    } else {
      ++bounding_nothing;
    }
  }
  check.surface = surface.result();
  if (!drawn.empty()) check.bounding_nothing = static_cast<double>(bounding_nothing) / static_cast<double>(drawn.size());
  return check;
}

// ---- fields ----

namespace {

/// The part of a line in a box, as parameters of p + t d.
std::pair<double, double> clip(const glm::dvec3& p, const glm::dvec3& d, const glm::dvec3& lo, const glm::dvec3& hi) {
  double from = -1e30, to = 1e30;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0.0) continue;
    const double a = (lo[axis] - p[axis]) / d[axis], b = (hi[axis] - p[axis]) / d[axis];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return {from, to};
}

/// Lines of equal chance for all lines that meet the box's ball meet every piece of a surface in it as often as its area
/// is large (Crofton). Calls visit(p) at each root.
template <class Visit>
void roots_on_lines(const Field& field, const voml::Grid& grid, std::size_t lines, std::size_t most, Visit visit) {
  Random random(3);
  const glm::dvec3 middle = 0.5 * (grid.box_lo + grid.box_hi);
  const double radius = 0.5 * glm::distance(grid.box_lo, grid.box_hi);
  const glm::dvec3 steps = step_of(grid);
  const double step = 0.5 * std::min({steps.x, steps.y, steps.z});
  std::size_t found = 0;
  for (std::size_t i = 0; i < lines && found < most; ++i) {
    // A direction, and a point evenly on the disc across it.
    const glm::dvec3 d = random.direction();
    const glm::dvec3 x = glm::normalize(glm::cross(d, std::abs(d.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const double r = radius * std::sqrt(random.unit()), turn = 2.0 * std::numbers::pi * random.unit();
    const glm::dvec3 p = middle + r * (std::cos(turn) * x + std::sin(turn) * glm::cross(d, x));
    const auto [from, to] = clip(p, d, grid.box_lo, grid.box_hi);
    if (!(from < to)) continue;
    double last = from;
    bool inside = field(p + from * d) <= 0.0;
    for (double t = from; t < to;) {
      t = std::min(t + step, to);
      const bool next = field(p + t * d) <= 0.0;
      if (next != inside) {
        double a = last, b = t;
        for (int halving = 0; halving < 50; ++halving) {
          const double m = 0.5 * (a + b);
          ((field(p + m * d) <= 0.0) == inside ? a : b) = m;
        }
        visit(p + a * d);
        ++found;
      }
      inside = next;
      last = t;
    }
  }
}

}  // namespace

GridCheck check_grid(const voml::Grid& grid, const Field& field, bool distance, std::size_t points) {
  GridCheck check;
  const glm::dvec3 steps = step_of(grid);
  check.voxel = longest(steps);
  const auto slope = [&](const glm::dvec3& p) {
    const double here = field(p);
    glm::dvec3 change(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = steps[axis];
      change[axis] = std::max(std::abs(field(p + step) - here), std::abs(field(p - step) - here)) / steps[axis];
    }
    return std::max(glm::length(change), 1e-30);
  };
  check_volume(grid, {.value = [&](const glm::dvec3& p) { return field(p); }, .slope = slope, .grid_has_value = !distance},
               points, check);

  Tally surface;
  roots_on_lines(field, grid, points, points, [&](const glm::dvec3& p) {
    const double value = std::abs(compiler::sample(grid, p));
    surface.add(distance ? value : value / slope(p), p);
  });
  check.surface = surface.result();
  return check;
}

}  // namespace dmvv::authoring
