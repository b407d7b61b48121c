// Writing a mesh as PLY, so that what `dmvv sdf` fitted can be a support mesh.
#pragma once

#include <string>

#include "voml/assets/mesh.h"

namespace dmvv::cli {

/// Binary little-endian PLY: float32 positions, one list of three int32 a triangle.
std::string write_ply(const voml::Mesh& mesh);

}  // namespace dmvv::cli
