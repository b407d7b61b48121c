// Triangle meshes and their files: OBJ, PLY (ascii, both binaries), STL (ascii, binary), OFF (ascii).
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "voml/diagnostics.h"

namespace dmvv::voml {

/// Triangles over shared vertices. Polygons of a file are fanned; STL corners with equal coordinates are merged.
struct Mesh {
  std::vector<glm::dvec3> positions;  ///< finite
  std::vector<glm::uvec3> triangles;  ///< counter-clockwise seen from outside; indices into positions
};

/// Parses a mesh; the format follows from the content (STL, PLY, OFF magic) and else from the name's ending (.obj).
/// Errors: a diagnostic with the line (text) or byte offset (binary), then the result is empty. Refused: unknown format,
/// truncated data, counts that exceed the file's length, indices out of range, numbers that are not finite, no triangle.
/// Cost: linear.
std::optional<Mesh> parse_mesh(const std::string& path, std::string_view bytes, Diagnostics& diagnostics);

struct Bounds {
  glm::dvec3 lo;
  glm::dvec3 hi;
};
Bounds bounds(const Mesh& mesh);

/// Edges that do not have exactly one triangle on each side (by orientation); 0 for a closed mesh.
std::size_t count_open_edges(const Mesh& mesh);

/// Of a closed mesh, for each triangle: whether its part (of triangles that hang together by vertices) holds a positive
/// volume. Then its face looks outward; voids, and what is turned inside out, hold a negative one. A part that passes
/// through itself is judged as a whole. Cost: linear.
std::vector<bool> outward_triangles(const Mesh& mesh);

/// The standard cube [-1,1]^3: 8 vertices, 12 triangles.
Mesh standard_cube();

}  // namespace dmvv::voml
