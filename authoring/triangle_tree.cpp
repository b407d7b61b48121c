#include "authoring/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

namespace dmvv::authoring {

namespace {

constexpr std::uint32_t leaf_size = 8;
constexpr int max_depth = 64;  // halving 2^32 triangles takes 32 levels; a traversal keeps one node a level

double square(double x) { return x * x; }
double length2(const glm::dvec3& v) { return glm::dot(v, v); }

double squared_distance_to_box(const glm::dvec3& p, const glm::dvec3& lo, const glm::dvec3& hi) {
  return length2(glm::max(glm::max(lo - p, p - hi), 0.0));
}

/// A unit vector across the unit vector `x`, as near to `wish` as can be.
glm::dvec3 perpendicular(const glm::dvec3& x, glm::dvec3 wish) {
  for (int pass = 0; pass < 2; ++pass) {  // the second pass removes what rounding left along x
    wish -= glm::dot(wish, x) * x;
    const double length = glm::length(wish);
    if (!(length > std::numeric_limits<double>::min())) {
      return perpendicular(x, std::abs(x.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
    }
    wish /= length;
  }
  return wish;
}

}  // namespace

// ---- one triangle ----

Triangle::Triangle(const Corners& corners) {
  const double edge2[3] = {length2(corners[1] - corners[0]), length2(corners[2] - corners[1]),
                           length2(corners[0] - corners[2])};
  const std::size_t longest = std::max_element(edge2, edge2 + 3) - edge2;
  const glm::dvec3 to_b = corners[(longest + 1) % 3] - corners[longest];
  const glm::dvec3 to_c = corners[(longest + 2) % 3] - corners[longest];
  origin_ = corners[longest];
  base_ = glm::length(to_b);
  x_ = base_ > std::numeric_limits<double>::min() ? to_b / base_ : glm::dvec3(1, 0, 0);
  y_ = perpendicular(x_, to_c);
  z_ = glm::cross(x_, y_);
  apex_x_ = std::clamp(glm::dot(to_c, x_), 0.0, base_);
  apex_y_ = std::max(glm::dot(to_c, y_), 0.0);
}

glm::dvec3 Triangle::to_local(const glm::dvec3& p) const {
  const glm::dvec3 d = p - origin_;
  return {glm::dot(d, x_), glm::dot(d, y_), glm::dot(d, z_)};
}

double Triangle::squared_distance(const glm::dvec3& p, double limit) const {
  const glm::dvec3 d = p - origin_;
  const double above2 = square(glm::dot(d, z_));
  if (above2 >= limit) return above2;
  const glm::dvec2 q(glm::dot(d, x_), glm::dot(d, y_));
  // The angles at a and b are acute: what is nearest to a point below the base lies on the base.
  if (q.y <= 0.0) return above2 + square(q.y) + square(q.x - std::clamp(q.x, 0.0, base_));

  const auto squared_distance_to_edge = [](double x, double y, double edge_x, double edge_y) {
    const double edge2 = square(edge_x) + square(edge_y);
    const double t = edge2 > 0.0 ? std::clamp((x * edge_x + y * edge_y) / edge2, 0.0, 1.0) : 0.0;
    return square(x - t * edge_x) + square(y - t * edge_y);
  };
  double beside2 = std::numeric_limits<double>::infinity();
  const double from_b = q.x - base_, apex_from_b = apex_x_ - base_;
  if (apex_x_ * q.y >= apex_y_ * q.x) beside2 = squared_distance_to_edge(q.x, q.y, apex_x_, apex_y_);
  if (apex_from_b * q.y <= apex_y_ * from_b) {
    beside2 = std::min(beside2, squared_distance_to_edge(from_b, q.y, apex_from_b, apex_y_));
  }
  return std::isfinite(beside2) ? above2 + beside2 : above2;
}

double Triangle::solid_angle(const glm::dvec3& p) const {
  const glm::dvec3 q = to_local(p);
  const glm::dvec3 a = -q, b(base_ - q.x, -q.y, -q.z), c(apex_x_ - q.x, apex_y_ - q.y, -q.z);
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double determinant = -q.z * base_ * apex_y_;
  return 2.0 * std::atan2(determinant, la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

// ---- building ----

namespace {

struct Range {
  std::uint32_t begin, end;
  std::uint32_t count() const { return end - begin; }
  std::uint32_t middle() const { return begin + count() / 2; }
  bool is_leaf() const { return count() <= leaf_size; }
};

/// Orders triangle numbers so that halving the range again and again gives compact halves: each range is split at the
/// median along the longest side of its centroids' box.
void order_by_medians(std::vector<std::uint32_t>& order, const std::vector<glm::dvec3>& centroids, Range range) {
  if (range.is_leaf()) return;
  glm::dvec3 lo = centroids[order[range.begin]], hi = lo;
  for (std::uint32_t i = range.begin; i < range.end; ++i) {
    lo = glm::min(lo, centroids[order[i]]);
    hi = glm::max(hi, centroids[order[i]]);
  }
  const glm::dvec3 side = hi - lo;
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  std::nth_element(order.begin() + range.begin, order.begin() + range.middle(), order.begin() + range.end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double x = centroids[a][axis], y = centroids[b][axis];
                     return x != y ? x < y : a < b;
                   });
  order_by_medians(order, centroids, {range.begin, range.middle()});
  order_by_medians(order, centroids, {range.middle(), range.end});
}

}  // namespace

TriangleTree::TriangleTree(const std::vector<Corners>& triangles) {
  std::vector<glm::dvec3> centroids;
  centroids.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) centroids.push_back((a + b + c) / 3.0);
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  order_by_medians(order, centroids, {0, static_cast<Index>(triangles.size())});

  triangles_.reserve(triangles.size());
  for (const std::uint32_t i : order) triangles_.emplace_back(triangles[i]);
  build(0, static_cast<Index>(triangles_.size()));
}

TriangleTree::Index TriangleTree::build(Index begin, Index end) {
  const Range range{begin, end};
  const auto index = static_cast<Index>(nodes_.size());
  nodes_.emplace_back();
  moments_.push_back(moments(begin, end));
  if (range.is_leaf()) {
    const glm::dvec3 corner_of_all = triangles_[begin].corners()[0];
    Node leaf{corner_of_all, corner_of_all, begin, range.count()};
    for (Index i = begin; i < end; ++i) {
      for (const glm::dvec3& corner : triangles_[i].corners()) {
        leaf.lo = glm::min(leaf.lo, corner);
        leaf.hi = glm::max(leaf.hi, corner);
      }
    }
    nodes_[index] = leaf;
  } else {
    const Index first = build(begin, range.middle());
    const Index second = build(range.middle(), end);
    nodes_[index] = {glm::min(nodes_[first].lo, nodes_[second].lo), glm::max(nodes_[first].hi, nodes_[second].hi),
                     second, 0};
  }
  return index;
}

TriangleTree::Moments TriangleTree::moments(Index begin, Index end) const {
  const std::span<const Triangle> triangles(triangles_.data() + begin, end - begin);

  Moments m;
  double area = 0.0;
  for (const Triangle& triangle : triangles) {
    m.area += triangle.area_vector();
    m.centre += triangle.area() * triangle.centroid();
    area += triangle.area();
  }
  m.centre = area > 0.0 ? m.centre / area : triangles[0].centroid();

  for (const Triangle& triangle : triangles) {
    const glm::dvec3 a = triangle.area_vector();
    const glm::dvec3 d = triangle.centroid() - m.centre;
    m.diagonal += d * a;
    m.mixed += glm::dvec3(d.x * a.y + d.y * a.x, d.y * a.z + d.z * a.y, d.z * a.x + d.x * a.z);
    for (const glm::dvec3& corner : triangle.corners()) m.radius2 = std::max(m.radius2, length2(corner - m.centre));
  }
  return m;
}

// ---- queries ----

double TriangleTree::distance(const glm::dvec3& p, Index& guess) const {
  struct Pending {
    Index node;
    double box2;
  };
  Pending stack[max_depth];
  int pending = 0;
  double nearest2 = triangles_[guess].squared_distance(p, std::numeric_limits<double>::infinity());
  const auto box2 = [&](Index node) { return squared_distance_to_box(p, nodes_[node].lo, nodes_[node].hi); };

  stack[pending++] = {0, box2(0)};
  while (pending > 0) {
    const Pending top = stack[--pending];
    if (top.box2 >= nearest2) continue;
    const Node& node = nodes_[top.node];
    for (Index i = node.first; i < node.first + node.count; ++i) {
      const double d2 = triangles_[i].squared_distance(p, nearest2);
      if (d2 < nearest2) {
        nearest2 = d2;
        guess = i;
      }
    }
    if (node.count > 0) continue;
    Pending nearer{top.node + 1, box2(top.node + 1)}, farther{node.first, box2(node.first)};
    if (farther.box2 < nearer.box2) std::swap(nearer, farther);
    if (farther.box2 < nearest2) stack[pending++] = farther;
    if (nearer.box2 < nearest2) stack[pending++] = nearer;
  }
  return std::sqrt(nearest2);
}

double TriangleTree::winding_number(const glm::dvec3& p, double accuracy) const {
  const double accuracy2 = square(accuracy);
  Index stack[max_depth];
  int pending = 0;
  double sum = 0.0;

  stack[pending++] = 0;
  while (pending > 0) {
    const Index index = stack[--pending];
    const Moments& m = moments_[index];
    const glm::dvec3 r = m.centre - p;
    const double r2 = length2(r);
    if (r2 > accuracy2 * m.radius2) {
      const double inverse2 = 1.0 / r2, inverse3 = inverse2 / std::sqrt(r2);
      const double trace = m.diagonal.x + m.diagonal.y + m.diagonal.z;
      const double along =
          glm::dot(m.diagonal, r * r) + m.mixed.x * r.x * r.y + m.mixed.y * r.y * r.z + m.mixed.z * r.z * r.x;
      sum += inverse3 * (glm::dot(m.area, r) + trace - 3.0 * inverse2 * along);
      continue;
    }
    const Node& node = nodes_[index];
    for (Index i = node.first; i < node.first + node.count; ++i) sum += triangles_[i].solid_angle(p);
    if (node.count > 0) continue;
    stack[pending++] = node.first;
    stack[pending++] = index + 1;
  }
  return sum / (4.0 * std::numbers::pi);
}

double TriangleTree::signed_volume() const {
  double volume = 0.0;
  for (const Triangle& triangle : triangles_) {
    volume += glm::dot(triangle.area_vector(), triangle.centroid() - moments_[0].centre) / 3.0;
  }
  return volume;
}

}  // namespace dmvv::authoring
