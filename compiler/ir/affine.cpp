#include "compiler/ir/affine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace dmvv::compiler {

namespace {

struct SinCos {
  double sin;
  double cos;
};

SinCos sin_cos_deg(double degrees) {
  const double turn = std::remainder(degrees, 360.0);  // exact, in [-180, 180]
  if (turn == 0.0) return {0.0, 1.0};
  if (turn == 90.0) return {1.0, 0.0};
  if (turn == -90.0) return {-1.0, 0.0};
  if (std::abs(turn) == 180.0) return {0.0, -1.0};
  const double radians = turn * (std::numbers::pi / 180.0);
  return {std::sin(radians), std::cos(radians)};
}

// glm matrices are given column by column.
glm::dmat3 rotation_xyz(const glm::dvec3& degrees) {
  const auto [sx, cx] = sin_cos_deg(degrees.x);
  const auto [sy, cy] = sin_cos_deg(degrees.y);
  const auto [sz, cz] = sin_cos_deg(degrees.z);
  const glm::dmat3 rx{1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx};
  const glm::dmat3 ry{cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy};
  const glm::dmat3 rz{cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0};
  return rz * ry * rx;
}

}  // namespace

Affine operator*(const Affine& a_from_b, const Affine& b_from_c) {
  return {a_from_b.linear * b_from_c.linear, a_from_b(b_from_c.translation)};
}

Affine inverse(const Affine& a_from_b) {
  const glm::dmat3 linear = glm::inverse(a_from_b.linear);
  return {linear, -(linear * a_from_b.translation)};
}

double largest_stretch(const glm::dmat3& linear) {
  // That of rows at right angles is the longest row; Gershgorin's bound for any others.
  const glm::dmat3 rows = glm::transpose(linear);
  const double xy = std::abs(glm::dot(rows[0], rows[1])), xz = std::abs(glm::dot(rows[0], rows[2])),
               yz = std::abs(glm::dot(rows[1], rows[2]));
  return std::sqrt(std::max({glm::dot(rows[0], rows[0]) + xy + xz, glm::dot(rows[1], rows[1]) + xy + yz,
                             glm::dot(rows[2], rows[2]) + xz + yz}));
}

Affine object_from_local(const voml::Transform& transform) {
  glm::dmat3 linear = rotation_xyz(transform.rotate_deg);
  for (int column = 0; column < 3; ++column) linear[column] *= transform.scale[column];
  return {linear, transform.translate};
}

Affine local_from_object(const voml::Transform& transform) {
  // S^-1 R^T (p - T): the inverse of a rotation is its transpose, so no determinant is ever formed and scales as small
  // as 1e-300 invert without loss.
  glm::dmat3 linear = glm::transpose(rotation_xyz(transform.rotate_deg));
  for (int column = 0; column < 3; ++column) linear[column] /= transform.scale;
  return {linear, -(linear * transform.translate) + 0.0};  // + 0.0 turns -0 into 0
}

voml::Transform combine(const voml::Transform& transform, const voml::Seed& seed) {
  return {2.0 * seed.position + transform.translate, seed.rotate_deg + transform.rotate_deg,
          seed.scale * transform.scale};
}

glm::dvec3 abs_times(const glm::dmat3& linear, const glm::dvec3& v) {
  return glm::abs(linear[0]) * v.x + glm::abs(linear[1]) * v.y + glm::abs(linear[2]) * v.z;
}

}  // namespace dmvv::compiler
