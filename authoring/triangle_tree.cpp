#include "authoring/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

namespace dmvv::authoring {

namespace {

constexpr std::uint32_t leaf_size = 8;  // of the nodes for winding numbers
constexpr std::uint32_t wide_leaf_size = 2;
// Halving 2^32 triangles takes 32 levels. A traversal keeps one node a level, or three at every other.
constexpr int max_pending = 64;
// The distance to a box is computed in float32 and must not exceed the exact one. Rounding adds some 2^-24 of the box's
// coordinates, for which boxes have room, and of the distance, which is taken off the result.
constexpr double box_room = 0x1p-21;
constexpr float box_share = 1.0f - 0x1p-20f;
constexpr float infinity = std::numeric_limits<float>::infinity();

double square(double x) { return x * x; }
double length2(const glm::dvec3& v) { return glm::dot(v, v); }

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
  bool is_leaf(std::uint32_t size) const { return count() <= size; }
};

/// Orders triangle numbers so that halving the range again and again gives compact halves: each range is split at the
/// median along the longest side of its centroids' box.
void order_by_medians(std::vector<std::uint32_t>& order, const std::vector<glm::dvec3>& centroids, Range range) {
  if (range.is_leaf(wide_leaf_size)) return;
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
  order_.resize(triangles.size());
  std::iota(order_.begin(), order_.end(), 0u);
  order_by_medians(order_, centroids, {0, static_cast<Index>(triangles.size())});
  centroids = {};

  double reach = 0.0;
  triangles_.reserve(triangles.size());
  for (const std::uint32_t i : order_) {
    triangles_.emplace_back(triangles[i]);
    for (const glm::dvec3& corner : triangles[i]) {
      reach = std::max({reach, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
    }
  }
  build(0, static_cast<Index>(triangles_.size()));
  build_wide(0, static_cast<Index>(triangles_.size()), reach * box_room);
}

TriangleTree::Index TriangleTree::build(Index begin, Index end) {
  const Range range{begin, end};
  const auto index = static_cast<Index>(nodes_.size());
  nodes_.push_back({begin, range.count()});
  moments_.push_back(moments(begin, end));
  if (!range.is_leaf(leaf_size)) {
    build(begin, range.middle());
    const Index second = build(range.middle(), end);
    nodes_[index] = {second, 0};
  }
  return index;
}

namespace {

/// The parts of a range, halved twice; those that are leaves stay whole.
std::vector<Range> quarters(Range range) {
  std::vector<Range> parts;
  const auto halve = [](Range r) { return std::array{Range{r.begin, r.middle()}, Range{r.middle(), r.end}}; };
  if (range.is_leaf(wide_leaf_size)) return {range};
  for (const Range half : halve(range)) {
    if (half.is_leaf(wide_leaf_size)) {
      parts.push_back(half);
    } else {
      for (const Range quarter : halve(half)) parts.push_back(quarter);
    }
  }
  return parts;
}

}  // namespace

TriangleTree::Index TriangleTree::build_wide(Index begin, Index end, double room) {
  const auto index = static_cast<Index>(wide_nodes_.size());
  wide_nodes_.emplace_back();
  WideNode wide;
  std::ranges::fill(std::span(&wide.lo[0][0], 12), infinity);
  std::ranges::fill(std::span(&wide.hi[0][0], 12), infinity);
  std::ranges::fill(wide.first, 0u);
  std::ranges::fill(wide.count, 0u);
  std::size_t lane = 0;
  for (const Range part : quarters({begin, end})) {
    glm::dvec3 lo = triangles_[part.begin].corners()[0], hi = lo;
    for (Index i = part.begin; i < part.end; ++i) {
      for (const glm::dvec3& corner : triangles_[i].corners()) {
        lo = glm::min(lo, corner);
        hi = glm::max(hi, corner);
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      wide.lo[axis][lane] = static_cast<float>(lo[axis] - room);
      wide.hi[axis][lane] = static_cast<float>(hi[axis] + room);
    }
    wide.count[lane] = part.is_leaf(wide_leaf_size) ? part.count() : 0;
    wide.first[lane] = part.is_leaf(wide_leaf_size) ? part.begin : build_wide(part.begin, part.end, room);
    ++lane;
  }
  wide_nodes_[index] = wide;
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

namespace {

/// Four numbers that are computed together (an extension of g++ and clang, on any processor).
using Lanes = float __attribute__((vector_size(16)));

Lanes greater_of(Lanes a, Lanes b) { return a > b ? a : b; }

/// From q to each of four boxes.
Lanes squared_distances(const float (&lo)[3][4], const float (&hi)[3][4], const float (&q)[3]) {
  Lanes sum{};
  for (int axis = 0; axis < 3; ++axis) {
    Lanes low, high;
    std::memcpy(&low, lo[axis], sizeof low);
    std::memcpy(&high, hi[axis], sizeof high);
    const Lanes outside = greater_of(greater_of(low - q[axis], q[axis] - high), Lanes{});
    sum += outside * outside;
  }
  return sum * box_share;
}

}  // namespace

double TriangleTree::distance(const glm::dvec3& p, Index& guess) const {
  struct Pending {
    float box2;
    Index first, count;
  };
  Pending stack[max_pending];
  int pending = 0;
  double nearest2 = triangles_[guess].squared_distance(p, std::numeric_limits<double>::infinity());
  const float q[3] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};

  stack[pending++] = {0.0f, 0, 0};
  while (pending > 0) {
    const Pending top = stack[--pending];
    if (top.box2 >= nearest2) continue;
    for (Index i = top.first; i < top.first + top.count; ++i) {
      const double d2 = triangles_[i].squared_distance(p, nearest2);
      if (d2 < nearest2) {
        nearest2 = d2;
        guess = i;
      }
    }
    if (top.count > 0) continue;
    const WideNode& node = wide_nodes_[top.first];
    const Lanes box2 = squared_distances(node.lo, node.hi, q);
    const auto limit = static_cast<float>(nearest2);  // rounded by less than box_share
    for (int lane = 0; lane < 4; ++lane) {
      stack[pending] = {box2[lane], node.first[lane], node.count[lane]};
      pending += box2[lane] <= limit ? 1 : 0;
    }
  }
  return std::sqrt(nearest2);
}

double TriangleTree::distance(const glm::dvec3& p) const {
  const float q[3] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  Index first = 0, count = 0;
  while (count == 0) {  // down to the nearest box of each node: a good guess
    const WideNode& node = wide_nodes_[first];
    const Lanes box2 = squared_distances(node.lo, node.hi, q);
    int nearest = 0;
    for (int lane = 1; lane < 4; ++lane) nearest = box2[lane] < box2[nearest] ? lane : nearest;
    first = node.first[nearest];
    count = node.count[nearest];
  }
  return distance(p, first);
}

double TriangleTree::winding_number(const glm::dvec3& p, double accuracy) const {
  const double accuracy2 = square(accuracy);
  Index stack[max_pending];
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
