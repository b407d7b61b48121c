// Where the parts of the orange are: the seeds of its embedded objects.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "examples/assets.h"

namespace orange {

using glm::dvec3;

using assets::Placement;

struct Gland {
  dvec3 direction;  ///< unit, from the orange's centre
  double size;      ///< about 1
};
/// Directions spread over the skin by dart throwing: irregular, but nowhere crowded; none under the calyx.
std::vector<Gland> place_glands(std::size_t count);
/// The frames of the glands and of the dimples above them.
std::vector<Placement> gland_placements(const std::vector<Gland>& glands);

/// Vesicles fill the segment, all pointed to the core. They overlap a little; the first in the file wins, which gives
/// the flattened walls of real ones. At most `count`.
std::vector<Placement> vesicle_placements(std::size_t count);

/// Chromoplasts in the juice of a vesicle, round in orange units.
std::vector<Placement> chromoplast_placements(std::size_t count);

/// Pips near the inner edges of some segments, pointed to the core.
std::vector<Placement> pip_placements();

}  // namespace orange
