#include "shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <vector>

#include "examples/noise.h"

namespace orange {

using namespace assets;

namespace {

using glm::dvec2;
using std::numbers::pi;

/// Intersection of half-spaces and bodies whose common edges are rounded with radius `r`.
template <std::size_t N>
double rounded_intersection(const std::array<double, N>& distances, double r) {
  double outside_squared = 0.0, largest = distances[0];
  for (const double distance : distances) {
    const double outside = std::max(0.0, distance + r);  // of the half-space drawn back by r
    outside_squared += outside * outside;
    largest = std::max(largest, distance);
  }
  return std::min(0.0, largest + r) + std::sqrt(outside_squared) - r;
}

/// Distance to a body of revolution around y whose outline is given as points (radius, y) from end to end.
double revolved_distance(dvec2 p, const std::vector<dvec2>& outline) {
  double nearest = 1e30;
  bool inside = false;
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    const dvec2 a = outline[i], b = outline[i + 1];
    const dvec2 edge = b - a, to = p - a;
    const double t = glm::clamp(glm::dot(to, edge) / glm::dot(edge, edge), 0.0, 1.0);
    nearest = std::min(nearest, glm::length(to - t * edge));
    if ((a.y <= p.y) != (b.y <= p.y)) inside = p.x < a.x + (p.y - a.y) / edge.y * edge.x;
  }
  return inside ? -nearest : nearest;
}

/// A drop from y = -h to h with its greatest radius r above the middle; `taper` 1 is an ellipsoid, less is more
/// pointed.
std::vector<dvec2> drop_outline(double r, double h, double taper) {
  std::vector<dvec2> outline;
  for (int i = 0; i <= 96; ++i) {
    const double angle = pi * (i / 96.0 - 0.5);
    const double y = std::sin(angle);  // -1..1
    outline.emplace_back(r * std::cos(angle) * (taper + (1.0 - taper) * (0.5 + 0.5 * y)), h * y);
  }
  const auto widest = std::max_element(outline.begin(), outline.end(), [](dvec2 a, dvec2 b) { return a.x < b.x; });
  const double to_full = r / widest->x;
  for (dvec2& point : outline) point.x *= to_full;
  return outline;
}

}  // namespace

double skin_radius(dvec3 d) {
  const double body = 1.0 / std::sqrt((d.x * d.x + d.z * d.z) / (0.93 * 0.93) + d.y * d.y / (0.885 * 0.885));
  const double from_axis = std::sqrt(d.x * d.x + d.z * d.z);
  const double lumps = 0.010 * noise(d * 1.7 + 9.0, 1) + 0.004 * noise(d * 4.1 + 9.0, 2);
  if (d.y > 0.0) {
    const double furrows = 1.0 + 0.22 * std::cos(5.0 * std::atan2(d.z, d.x)) * (1.0 - bell(from_axis / 0.14));
    return body + lumps - 0.040 * furrows * bell(from_axis / 0.27) + 0.020 * bell(from_axis / 0.11);
  }
  return body + lumps - 0.014 * bell(from_axis / 0.22) - 0.010 * bell(from_axis / 0.035);
}

/// Distance to a star-shaped surface, to first order: radial distance over the length of its gradient.
double skin_distance(dvec3 p) {
  const double length = std::max(glm::length(p), 1e-9);
  const dvec3 d = p / length;
  const double radius = skin_radius(d);
  const dvec3 side = glm::normalize(glm::cross(d, std::abs(d.y) < 0.7 ? dvec3(0, 1, 0) : dvec3(1, 0, 0)));
  const double step = 1e-3;
  const double slope_u = (skin_radius(glm::normalize(d + step * side)) - radius) / step;
  const double slope_v = (skin_radius(glm::normalize(d + step * glm::cross(d, side))) - radius) / step;
  return (length - radius) / std::sqrt(1.0 + (slope_u * slope_u + slope_v * slope_v) / (radius * radius));
}

dvec3 skin_normal(dvec3 d) {
  const dvec3 p = d * skin_radius(d);
  const double h = 1e-3;
  const auto slope = [&](dvec3 axis) { return skin_distance(p + h * axis) - skin_distance(p - h * axis); };
  return glm::normalize(dvec3(slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})));
}

double section_distance(dvec3 p) {
  const double half_angle = 18.0 * pi / 180.0;
  const dvec3 q = p + section_centre;
  const double from_axis = std::sqrt(q.x * q.x + q.z * q.z);
  const double wobble = 0.009 * noise(q * 6.0 + 40.0, 11) + 0.005 * noise(q * 14.0 + 40.0, 12);
  // The plane of the wedge's side, drawn back by half the wall between neighbours, which is here thin, there thicker.
  const double side = std::abs(q.z) * std::cos(half_angle) - q.x * std::sin(half_angle);
  const double wall = 0.0030 + 0.0025 * noise(q * 5.0 + 50.0, 13);
  const double elliptic = std::sqrt(from_axis * from_axis / (0.822 * 0.822) + q.y * q.y / (0.755 * 0.755));
  const double back = (elliptic - 1.0) * 0.79 + wobble;
  const double inner_edge = 0.092 + 0.25 * q.y * q.y - from_axis + 0.5 * wobble;
  return rounded_intersection<3>({side + wall, back, inner_edge}, 0.048);
}

double vesicle_distance(dvec3 p) {
  static const std::vector<dvec2> outline = drop_outline(0.030, 0.158, 0.36);
  const double angle = std::atan2(p.z, p.x);
  const double facets = 1.0 + 0.07 * std::cos(3.0 * angle + 5.0 * p.y) + 0.05 * std::cos(5.0 * angle + 1.0);
  return revolved_distance({std::sqrt(p.x * p.x + p.z * p.z) / facets, p.y}, outline);
}

double pip_distance(dvec3 p) {
  static const std::vector<dvec2> outline = drop_outline(0.054, 0.104, 0.35);
  const double ridges = 1.0 + 0.03 * std::cos(7.0 * std::atan2(p.z, p.x));
  return revolved_distance({std::sqrt(p.x * p.x + p.z * p.z * 1.96) / ridges, p.y}, outline);
}

double core_distance(dvec3 p) {
  const double from_axis = std::sqrt(p.x * p.x + p.z * p.z);
  const double angle = std::atan2(p.z, p.x);
  const double lobes = 0.10 * std::cos(10.0 * angle) + 0.18 * noise(p * dvec3(14.0, 4.0, 14.0) + 60.0, 21);
  return from_axis - 0.066 * (1.0 + lobes) * std::sqrt(std::max(0.0, 1.0 - p.y * p.y / (0.78 * 0.78)));
}

double hollow_distance(dvec3 p) {
  const double from_axis = std::sqrt(p.x * p.x + p.z * p.z);
  const double angle = std::atan2(p.z, p.x);
  const double lobes = 0.12 * std::cos(10.0 * angle) + 0.55 * noise(p * dvec3(26.0, 5.0, 26.0) + 70.0, 22) +
                       0.25 * noise(p * dvec3(60.0, 9.0, 60.0) + 70.0, 23);
  const double radius = 0.040 * (1.0 + lobes) * bell(p.y / 0.52);
  return from_axis - radius;
}

double dimple_distance(dvec3 p) { return glm::length(p - dvec3(0.0, 0.0345, 0.0)) - 0.040; }

double gland_distance(dvec3 p) {
  const dvec3 q = p + dvec3(0.0, 0.0225, 0.0);
  const dvec3 radii(0.0175 + 0.12 * q.y, 0.0125, 0.0175 + 0.12 * q.y);
  const double k = glm::length(q / radii);
  return (k - 1.0) * 0.0145;
}

double calyx_distance(dvec3 p) {
  const double from_axis = std::sqrt(p.x * p.x + p.z * p.z);
  const double lobe = std::abs(std::cos(2.5 * std::atan2(p.z, p.x) + 0.4));
  const double radius = 0.050 + 0.056 * lobe * lobe + 0.006 * noise(dvec3(p.x, 0.0, p.z) * 50.0 + 80.0, 31);
  const double underside = -0.040 + 0.08 * from_axis - p.y;
  return std::max(0.8 * (from_axis - radius), 1.5 * underside);
}

}  // namespace orange
