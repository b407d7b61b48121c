// Affine maps in double precision, named by direction: `local_from_object(p_object)` is a point in local coordinates.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "voml/scene.h"

namespace dmvv::compiler {

struct Affine {
  glm::dmat3 linear{1.0};
  glm::dvec3 translation{0.0};

  glm::dvec3 operator()(const glm::dvec3& p) const { return linear * p + translation; }
  friend bool operator==(const Affine&, const Affine&) = default;
};

/// a_from_c = a_from_b * b_from_c.
Affine operator*(const Affine& a_from_b, const Affine& b_from_c);

Affine inverse(const Affine& a_from_b);

/// The largest magnitudes that linear * u can have, component by component, if |u| <= v.
glm::dvec3 abs_times(const glm::dmat3& linear, const glm::dvec3& v);

/// The largest singular value, or somewhat more: no step gets longer than that many times.
double largest_stretch(const glm::dmat3& linear);

/// T * Rz * Ry * Rx * S (spec/voml.md section 2). Quarter turns are exact: sin and cos of multiples of 90 degrees are
/// the integers they should be.
Affine object_from_local(const voml::Transform& transform);

/// The inverse of object_from_local, from the factors: exact for axis-aligned transforms with power-of-two scales.
Affine local_from_object(const voml::Transform& transform);

/// The transform of one seed: position 2*seed + translate, angles and scales combined component by component.
voml::Transform combine(const voml::Transform& transform, const voml::Seed& seed);

}  // namespace dmvv::compiler
