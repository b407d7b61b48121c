#include "compiler/ir/placements.h"

#include <algorithm>
#include <glm/common.hpp>

#include "compiler/ir/rounding.h"

namespace dmvv::compiler {

LocalBox local_box(const Sdf& sdf, const Module& module) {
  const auto* id = std::get_if<Id<voml::Grid>>(&sdf.source);
  if (!id) return {};
  const voml::Grid& grid = at(module.grids, *id);
  return {glm::max(grid.box_lo, glm::dvec3(-1.0)), glm::min(grid.box_hi, glm::dvec3(1.0))};
}

LocalBox asked_box(const Sdf& sdf, const Module& module) {
  const LocalBox box = local_box(sdf, module);
  return {glm::max(box.lo, sdf.content.lo), glm::min(box.hi, sdf.content.hi)};
}

bool only_scale(const Sdf& sdf) {
  return sdf.placement == voml::Placement::seeded && std::ranges::all_of(sdf.local_from_object, [](const Affine& a) {
           return a.linear == glm::dmat3(a.linear[0].x);
         });
}

std::vector<PlacedBox> placed_boxes(const Sdf& sdf, const Module& module) {
  const LocalBox box = asked_box(sdf, module);
  std::vector<PlacedBox> boxes;
  boxes.reserve(sdf.local_from_object.size());
  for (const Affine& affine : sdf.local_from_object) {
    boxes.push_back({affine, float_error(affine, glm::dvec3(1.0)), box.lo, box.hi, false});
  }
  return boxes;
}

std::vector<PlacedBox> placed_boxes(const CandidateGroup& group, const Module& module) {
  const Affine object_from_frame = group.box_from_object ? inverse(*group.box_from_object) : Affine{};
  std::vector<PlacedBox> boxes;
  boxes.reserve(group.candidates.size());
  for (const Candidate& candidate : group.candidates) {
    const LocalBox& content = at(module.objects, candidate.object).content;
    boxes.push_back({candidate.local_from_parent * object_from_frame,
                     float_error(candidate.local_from_parent, glm::dvec3(1.0)), content.lo, content.hi,
                     candidate.tiled});
  }
  return boxes;
}

glm::dvec3 lookup_frame_error(const CandidateGroup& group) {
  return group.box_from_object ? float_error(*group.box_from_object, glm::dvec3(1.0)) : glm::dvec3(0.0);
}

}  // namespace dmvv::compiler
