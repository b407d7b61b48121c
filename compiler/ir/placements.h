// Where seeds and embedded objects lie: boxes in the frame in which they are asked.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "compiler/ir/affine.h"
#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// A placed box: the points p whose local point lies in [lo, hi].
struct PlacedBox {
  Affine local_from_frame;
  glm::dvec3 local_error{0.0};  ///< bound of the float32 error of the local point
  glm::dvec3 lo{-1.0};
  glm::dvec3 hi{1.0};
  bool everywhere = false;  ///< tiled: holds every point
};

/// The part of the standard cube in which an SDF's source is defined.
LocalBox local_box(const Sdf& sdf, const Module& module);
/// The part of it in which a seed is asked: beyond it nothing is.
LocalBox asked_box(const Sdf& sdf, const Module& module);

/// Seeds of an SDF as boxes in the object's frame.
std::vector<PlacedBox> placed_boxes(const Sdf& sdf, const Module& module);
/// Candidates of a group as boxes in its lookup frame (the INDEX box if it has one, else the object).
std::vector<PlacedBox> placed_boxes(const CandidateGroup& group, const Module& module);
/// Bound of the float32 error of a point in the group's lookup frame.
glm::dvec3 lookup_frame_error(const CandidateGroup& group);

/// Do all placements of the seeds only scale, alike along all axes, and move?
bool only_scale(const Sdf& sdf);

}  // namespace dmvv::compiler
