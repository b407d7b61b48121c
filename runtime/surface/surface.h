// Inside the runtime only: support mesh -> vertices with normals, ready to be drawn.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/result.h"
#include "voml/assets/mesh.h"

namespace dmvv::runtime {

struct SurfaceVertex {
  glm::vec3 position;  ///< root coordinates
  glm::vec3 normal;    ///< unit, outward
};
static_assert(sizeof(SurfaceVertex) == 24);

struct Surface {
  std::vector<SurfaceVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three a triangle, counter-clockwise from outside
  voml::Bounds bounds;
};

/// Normals are means of the faces at a vertex, weighted by their angle there (Thuermer and Wuethrich 1998), over faces
/// that hang together by edges bent at most 40 degrees; at sharper edges the vertex is split. The copies of a vertex
/// keep its position to the bit, so a closed mesh stays closed.
///
/// Errors (input): no triangle, an index beyond the positions, a coordinate that is not finite or beyond 1e15.
/// Cost: O(n log d), d being the triangles at one vertex.
Result<Surface> make_surface(const voml::Mesh& mesh);

}  // namespace dmvv::runtime
