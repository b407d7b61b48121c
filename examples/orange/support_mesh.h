// The support mesh of the orange: the surface at which the renderer asks the scene for colours.
#pragma once

#include <string>
#include <vector>

#include "parts.h"

namespace orange {

/// A closed mesh as binary PLY. It lies inside the skin everywhere, dimples included, so that none of its points falls
/// into the empty outside; it has the dimples in its shape, so that they catch the light.
std::string support_mesh(const std::vector<Gland>& glands);

}  // namespace orange
