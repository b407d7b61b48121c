// Where to look at a scene: anywhere, on faces and centre planes, inside what is embedded, and beside boundaries.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "compiler/reference/reference.h"

namespace dmvv::tests::random_scenes {

struct Points {
  std::vector<glm::dvec3> all;  ///< float32 values
  std::size_t uniform = 0;      ///< so many of them, first, are drawn from the whole cube
};

Points draw_points(const compiler::Module& module, const compiler::Reference& reference, double time_ms,
                   std::uint64_t seed, std::size_t count);

}  // namespace dmvv::tests::random_scenes
