// The support mesh of the skin: the surface at which the renderer asks the scene for colours.
#pragma once

#include <string>

namespace skin {

/// Closed meshes as binary PLY: the block with the furrows of its surface, and the hairs that stand out of it. They lie
/// inside the scene everywhere, so that no point falls into the empty outside.
std::string support_mesh();

}  // namespace skin
