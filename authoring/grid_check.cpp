#include "authoring/grid_check.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>
#include <utility>

#include "authoring/boundary.h"
#include "authoring/chance.h"
#include "authoring/slices.h"
#include "authoring/triangle_tree.h"
#include "compiler/grids/sample.h"
#include "compiler/reference/reference.h"

namespace dmvv::authoring {

namespace {

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

/// How much of the boundary the grid has lost, and which resolution would keep most of it.
void check_kept(const voml::Grid& grid, const voml::Bounds& box, double padding, const SignedValue& value,
                std::span<const BoundaryPoint> points, GridCheck& check) {
  check.boundary_lost = share_lost(grid, value, points);
  if (check.boundary_lost <= 0.01) return;
  const std::uint32_t resolution = std::max({grid.size.x, grid.size.y, grid.size.z});
  check.resolution_needed = resolution_that_keeps_most(box, padding, resolution, value, points);
}

}  // namespace

// ---- meshes ----

GridCheck check_grid(const voml::Grid& grid, const voml::Mesh& mesh, const GridReport& report, std::size_t points) {
  const auto placed = [&](const glm::dvec3& p) {
    return report.cube_from_mesh_scale * p + report.cube_from_mesh_offset;
  };
  std::vector<Corners> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    triangles.push_back({placed(mesh.positions[t.x]), placed(mesh.positions[t.y]), placed(mesh.positions[t.z])});
  }
  const TriangleTree tree(triangles);
  triangles = {};
  const Solid solid(tree);
  const Exact exact{.value = [&](const glm::dvec3& p) { return solid.signed_distance(p, 4.0); },
                    .slope = [](const glm::dvec3&) { return 1.0; },
                    .grid_has_value = true};

  GridCheck check;
  check.voxel = longest(step_of(grid));
  check_volume(grid, exact, points, check);

  Tally surface;
  const auto boundary = solid.boundary(points, 1e-4 * check.voxel, check.bounding_nothing);
  for (const BoundaryPoint& point : boundary) surface.add(std::abs(compiler::sample(grid, point.p)), point.p);
  check.surface = surface.result();
  const voml::Bounds box = voml::bounds(mesh);
  const auto as_sampled = [&](const glm::dvec3& p) { return solid.signed_distance(p, 2.0); };
  check_kept(grid, {placed(box.lo), placed(box.hi)}, report.padding, as_sampled, boundary, check);
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

/// The field along a line of points, and where it changes sides.
class Line {
 public:
  Line(const Field& field, const glm::dvec3& p, const glm::dvec3& d) : field_(field), p_(p), d_(d) {}

  /// Calls visit(t, whether it leads inside) at each root between the two parameters. Steps that may hide two, by the
  /// greatest change over any step, are halved up to `halvings` times.
  template <class Visit>
  void roots(double from, double to, double step, Visit visit) {
    std::vector<double> at, values;
    for (double t = from;; t = std::min(t + step, to)) {
      at.push_back(t);
      values.push_back(value(t));
      if (!(t < to)) break;
    }
    double slope = 0.0;
    for (std::size_t i = 1; i < at.size(); ++i) {
      slope = std::max(slope, std::abs(values[i] - values[i - 1]) / (at[i] - at[i - 1]));
    }
    for (std::size_t i = 1; i < at.size(); ++i) {
      search(at[i - 1], values[i - 1], at[i], values[i], slope, halvings, visit);
    }
  }

 private:
  static constexpr int halvings = 6;

  double value(double t) const { return field_(p_ + t * d_); }

  template <class Visit>
  void search(double a, double at_a, double b, double at_b, double slope, int depth, Visit visit) {
    const bool inside = at_a <= 0.0;
    if ((at_b <= 0.0) != inside) {
      for (int halving = 0; halving < 50; ++halving) {
        const double m = 0.5 * (a + b);
        ((value(m) <= 0.0) == inside ? a : b) = m;
      }
      return visit(a, !inside);
    }
    if (depth == 0 || !(std::abs(at_a) + std::abs(at_b) < slope * (b - a))) return;
    const double m = 0.5 * (a + b), at_m = value(m);
    search(a, at_a, m, at_m, slope, depth - 1, visit);
    search(m, at_m, b, at_b, slope, depth - 1, visit);
  }

  const Field& field_;
  glm::dvec3 p_, d_;
};

/// Points of a field's boundary: roots on lines of equal chance for all lines that meet the box's ball, which meet
/// every piece of a surface in it as often as its area is large (Crofton). At most one for each of `points` lines, or
/// so.
std::vector<BoundaryPoint> boundary_on_lines(const Field& field, const voml::Grid& grid, std::size_t points) {
  Random random(3);
  const glm::dvec3 middle = 0.5 * (grid.box_lo + grid.box_hi);
  const double radius = 0.5 * glm::distance(grid.box_lo, grid.box_hi);
  const glm::dvec3 steps = step_of(grid);
  const double voxel = std::min({steps.x, steps.y, steps.z});
  std::vector<BoundaryPoint> found;
  for (std::size_t i = 0; i < points && found.size() < points; ++i) {
    // A direction, and a point evenly on the disc across it.
    const glm::dvec3 d = random.direction();
    const glm::dvec3 x = glm::normalize(glm::cross(d, std::abs(d.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const double r = radius * std::sqrt(random.unit()), turn = 2.0 * std::numbers::pi * random.unit();
    const glm::dvec3 p = middle + r * (std::cos(turn) * x + std::sin(turn) * glm::cross(d, x));
    const auto [from, to] = clip(p, d, grid.box_lo, grid.box_hi);
    if (!(from < to)) continue;
    Line(field, p, d).roots(from, to, 0.5 * voxel, [&](double t, bool leads_inside) {
      found.push_back({p + t * d, leads_inside ? -d : d});
    });
  }
  // Outwards goes the gradient; where there is none, the line.
  for (BoundaryPoint& point : found) {
    const double h = 1e-3 * voxel;
    glm::dvec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = h;
      gradient[axis] = field(point.p + step) - field(point.p - step);
    }
    const double length = glm::length(gradient);
    if (length > 0.0 && std::isfinite(length)) point.outward = gradient / length;
  }
  return found;
}

}  // namespace

GridCheck check_grid(const voml::Grid& grid, const Field& field, const BakeOptions& options, std::size_t points) {
  const bool distance = options.distance;
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
  check_volume(grid,
               {.value = [&](const glm::dvec3& p) { return field(p); }, .slope = slope, .grid_has_value = !distance},
               points, check);

  Tally surface;
  const auto boundary = boundary_on_lines(field, grid, points);
  for (const BoundaryPoint& point : boundary) {
    const double value = std::abs(compiler::sample(grid, point.p));
    surface.add(distance ? value : value / slope(point.p), point.p);
  }
  check.surface = surface.result();
  const auto box = field.inside();
  if (box)
    check_kept(
        grid, *box, options.padding, [&](const glm::dvec3& p) { return field(p); }, boundary, check);
  return check;
}

}  // namespace dmvv::authoring
