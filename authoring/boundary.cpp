#include "authoring/boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "authoring/chance.h"
#include "authoring/slices.h"

namespace dmvv::authoring {

// ---- points ----

namespace {

/// A point of a triangle's area, and the triangle's normal.
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

std::vector<BoundaryPoint> Solid::boundary(std::size_t points, double beside, double& bounding_nothing) const {
  constexpr double accuracy = 4.0;
  const std::vector<OnTriangle> drawn = spread(tree_, points);
  const auto sides = for_all<int>(drawn.size(), [&](std::size_t i) {
    const glm::dvec3 step = beside * drawn[i].normal;
    return (holds(drawn[i].p - step, accuracy) ? 1 : 0) - (holds(drawn[i].p + step, accuracy) ? 1 : 0);
  });
  std::vector<BoundaryPoint> result;
  result.reserve(drawn.size());
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (sides[i] != 0) result.push_back({drawn[i].p, static_cast<double>(sides[i]) * drawn[i].normal});
  }
  const std::size_t left_out = drawn.size() - result.size();
  bounding_nothing = drawn.empty() ? 0.0 : static_cast<double>(left_out) / static_cast<double>(drawn.size());
  return result;
}

// ---- what a grid keeps ----

namespace {

/// A grid's interpolation around a point; samples are asked for once, and only where needed.
class Around {
 public:
  Around(const voml::Grid& grid, const SignedValue& value, const glm::dvec3& p)
      : grid_(grid),
        value_(value),
        step_(step_of(grid)),
        first_(glm::ivec3(glm::floor((p - grid.box_lo) / step_)) - 3) {
    known_.fill(std::numeric_limits<double>::quiet_NaN());
  }

  /// At a point within a voxel or so of the first one.
  double operator()(const glm::dvec3& p) {
    if (glm::any(glm::lessThan(p, grid_.box_lo)) || glm::any(glm::greaterThan(p, grid_.box_hi))) return 1.0;
    const glm::dvec3 at = glm::clamp((p - grid_.box_lo) / step_ - 0.5, glm::dvec3(0.0), glm::dvec3(grid_.size - 1u));
    const glm::ivec3 lo(glm::floor(at)), hi = glm::min(lo + 1, glm::ivec3(grid_.size) - 1);
    const glm::dvec3 w = at - glm::dvec3(lo);
    double planes[2];
    for (int k = 0; k < 2; ++k) {
      const int z = k == 0 ? lo.z : hi.z;
      const double front = glm::mix(sample({lo.x, lo.y, z}), sample({hi.x, lo.y, z}), w.x);
      const double back = glm::mix(sample({lo.x, hi.y, z}), sample({hi.x, hi.y, z}), w.x);
      planes[k] = glm::mix(front, back, w.y);
    }
    return glm::mix(planes[0], planes[1], w.z);
  }

 private:
  static constexpr int edge = 7;  // a voxel to either side of any point of a voxel, samples half a voxel further

  double sample(const glm::ivec3& at) {
    if (!grid_.values.empty()) {
      const auto x = static_cast<std::size_t>(at.x), y = static_cast<std::size_t>(at.y),
                 z = static_cast<std::size_t>(at.z);
      return grid_.values[(z * grid_.size.y + y) * grid_.size.x + x];
    }
    const glm::ivec3 near = at - first_;
    double& known = known_[static_cast<std::size_t>((near.z * edge + near.y) * edge + near.x)];
    if (std::isnan(known)) known = value_(centre_of(grid_, glm::dvec3(at)));
    return known;
  }

  const voml::Grid& grid_;
  const SignedValue& value_;
  glm::dvec3 step_;
  glm::ivec3 first_;
  std::array<double, std::size_t{edge} * edge * edge> known_;
};

/// Directions of length 1 to one side of a plane: its normal, and eight around that, which lead away from edges near
/// by.
std::array<glm::dvec3, 9> directions(const glm::dvec3& normal) {
  const glm::dvec3 other = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(normal, other)), v = glm::cross(normal, u);
  std::array<glm::dvec3, 9> result;
  for (int i = 0; i < 9; ++i) {
    const int column = i % 3 - 1, row = i / 3 - 1;
    result[static_cast<std::size_t>(i)] =
        glm::normalize(normal + static_cast<double>(column) * u + static_cast<double>(row) * v);
  }
  return result;
}

bool keeps(const voml::Grid& grid, const SignedValue& value, const BoundaryPoint& point, double voxel) {
  constexpr int steps = 16;
  Around around(grid, value, point.p);
  const auto inside_at = [&](const glm::dvec3& direction, double share) {
    return around(point.p + share * voxel * direction) <= 0.0;
  };
  if (inside_at(-point.outward, 0.5) && !inside_at(point.outward, 0.5)) return true;  // nearly all: with few samples
  const auto meets = [&](const glm::dvec3& side, bool inside) {
    return std::ranges::any_of(directions(side), [&](const glm::dvec3& direction) {
      for (int step = 0; step <= steps; ++step) {
        if (inside_at(direction, static_cast<double>(step) / steps) == inside) return true;
      }
      return false;
    });
  };
  return meets(-point.outward, true) && meets(point.outward, false);
}

}  // namespace

double share_lost(const voml::Grid& grid, const SignedValue& value, std::span<const BoundaryPoint> points) {
  if (points.empty()) return 0.0;
  const glm::dvec3 step = step_of(grid);
  const double voxel = std::min({step.x, step.y, step.z});
  const auto lost =
      for_all<char>(points.size(), [&](std::size_t i) { return keeps(grid, value, points[i], voxel) ? 0 : 1; });
  return static_cast<double>(std::ranges::count(lost, char{1})) / static_cast<double>(points.size());
}

std::uint32_t resolution_that_keeps_most(const voml::Bounds& box, double padding, std::uint32_t from,
                                         const SignedValue& value, std::span<const BoundaryPoint> points) {
  constexpr double may_be_lost = 0.01;
  constexpr std::size_t points_of_search = 4000;
  const auto suffices = [&](std::uint32_t resolution, std::size_t most_points) {
    const auto some = points.subspan(0, std::min(points.size(), most_points));
    return share_lost(empty_grid(box, resolution, padding), value, some) <= may_be_lost;
  };
  std::uint32_t too_coarse = from, enough = from;
  do {
    too_coarse = enough;
    enough += std::max(1u, enough / 4);
    if (enough > finest_resolution_tried) return 0;
  } while (!suffices(enough, points_of_search));
  while (enough - too_coarse > std::max(1u, enough / 32)) {
    const std::uint32_t middle = too_coarse + (enough - too_coarse) / 2;
    (suffices(middle, points_of_search) ? enough : too_coarse) = middle;
  }
  while (!suffices(enough, points.size())) {
    enough += std::max(1u, enough / 64);
    if (enough > finest_resolution_tried) return 0;
  }
  return enough;
}

}  // namespace dmvv::authoring
