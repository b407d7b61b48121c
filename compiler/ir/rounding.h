// What float32 does to a point on its way through the frames (spec/accuracy.md).
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "compiler/ir/affine.h"

namespace dmvv::compiler {

/// Unit roundoff of float32.
inline constexpr double float_unit = 0x1p-24;
/// What a device may flush to zero.
inline constexpr double float_denormal = 0x1p-126;

/// Bound of the float32 rounding error of each component of affine(p) for |p| <= reach, relative to the double result:
/// the rounded matrix entry, the product and at most three sums, each half an ulp, and one to spare; and what a device
/// flushes.
glm::dvec3 float_error(const Affine& affine, const glm::dvec3& reach);

/// A bound of a point's float32 error: component by component, and of its length. Rotations mix components, so sums of
/// magnitudes would grow with every frame where the length does not.
struct ErrorBound {
  glm::dvec3 component{0.0};
  double length = 0.0;
};

/// What becomes of it in a frame: that much is carried, and the arithmetic adds its own.
inline ErrorBound carry(const Affine& affine, const ErrorBound& error, const glm::dvec3& added) {
  const glm::dmat3 rows = glm::transpose(affine.linear);
  const glm::dvec3 lengths{glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2])};
  glm::dvec3 carried;
  for (int i = 0; i < 3; ++i) {
    carried[i] = std::min(glm::dot(glm::abs(rows[i]), error.component), lengths[i] * error.length);
  }
  const double magnified = largest_stretch(affine.linear) * error.length;
  ErrorBound out{carried + added, 0.0};
  out.length = std::min(glm::length(out.component), magnified + glm::length(added));
  return out;
}

/// A point in double with the bound of its float32 error.
struct Approximate {
  glm::dvec3 p;
  ErrorBound bound;
  const glm::dvec3& error() const { return bound.component; }
  void add_error(const glm::dvec3& e) {
    bound.component += e;
    bound.length += glm::length(e);
  }
};

/// A point given in double, rounded once.
inline Approximate rounded(const glm::dvec3& p) {
  const glm::dvec3 error = float_unit * glm::abs(p) + float_denormal;
  return {p, {error, glm::length(error)}};
}

inline Approximate apply(const Affine& affine, const Approximate& from) {
  return {affine(from.p), carry(affine, from.bound, float_error(affine, glm::abs(from.p)))};
}

/// The bound in a placement's frame, wherever the point is whose local point lies in the standard cube (tiled: anywhere
/// in the cube around the placement).
inline ErrorBound carry_anywhere(const Affine& affine, bool tiled, const ErrorBound& error) {
  const glm::dmat3& m = affine.linear;
  if (tiled) {
    const glm::dvec3 farthest = glm::abs(m[0]) + glm::abs(m[1]) + glm::abs(m[2]) + glm::abs(affine.translation);
    return carry(affine, error, float_error(affine, glm::dvec3(1.0)) + 4.0 * float_unit * (farthest + 1.0));
  }
  const Affine back = inverse(affine);
  const glm::dvec3 half = glm::abs(back.linear[0]) + glm::abs(back.linear[1]) + glm::abs(back.linear[2]);
  return carry(affine, error, float_error(affine, glm::min(glm::abs(back.translation) + half, glm::dvec3(1.0))));
}

}  // namespace dmvv::compiler
