// The shapes of the orange and its parts: signed distances in orange units, negative inside.
//
// One unit is about 43 mm: the standard cube of object ORANGE, y the stem axis. Each shape lives in the frame of its
// object, around that object's origin; its `extent` is half the edges of the object's cube, which orange.voml or a seed
// file gives as `scale`. Distances are true to first order near the surface.
#pragma once

#include <glm/vec3.hpp>

namespace orange {

using glm::dvec3;

/// How far the skin is from the centre in direction `d` (unit): an oblate, slightly lumpy body with a dent at the stem,
/// in which the calyx sits, and a shallow navel at the blossom end.
double skin_radius(dvec3 d);
/// The skin's unit normal in direction `d`, outwards.
dvec3 skin_normal(dvec3 d);
double skin_distance(dvec3 p);

/// One segment: a wedge of 36 degrees around +x, its back along the rind, its inner edge along the core.
const dvec3 section_centre(0.46, 0.0, 0.0);  ///< in the orange, before the segment is turned to its place
const dvec3 section_extent(0.38, 0.76, 0.27);
double section_distance(dvec3 p);

/// A vesicle (juice sac): a plump drop along y; its thin end, at -y, points to the core.
const dvec3 vesicle_extent(0.034, 0.165, 0.034);
double vesicle_distance(dvec3 p);

/// A pip: a flattened drop along y, pointed to the core.
const dvec3 pip_extent(0.060, 0.110, 0.045);
double pip_distance(dvec3 p);

/// The core: a pithy spindle around the axis.
const dvec3 core_extent(0.10, 0.80, 0.10);
double core_distance(dvec3 p);

/// The hollow in its middle: drawn out along the axis, torn into lobes.
const dvec3 hollow_extent(0.075, 0.52, 0.075);
double hollow_distance(dvec3 p);

/// A gland and the dimple above it share one frame: the origin lies on the skin, +y points outwards.
const dvec3 gland_extent(0.036);
double gland_distance(dvec3 p);
double dimple_distance(dvec3 p);

/// The calyx: what is left of the five sepals, around the scar of the stem.
const dvec3 calyx_extent(0.12, 0.06, 0.12);
double calyx_distance(dvec3 p);

}  // namespace orange
