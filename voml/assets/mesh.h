// Triangle meshes and their files: OBJ, PLY (ascii, both binaries), STL (ascii, binary), OFF (ascii); texts in UTF-8,
// or in UTF-16 or UTF-32 with a byte order mark.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"

namespace dmvv::voml {

/// Triangles over shared vertices. Polygons of a file are fanned; STL corners with equal coordinates are merged.
struct Mesh {
  std::vector<glm::dvec3> positions;  ///< finite
  std::vector<glm::uvec3> triangles;  ///< counter-clockwise seen from outside; indices into positions
};

/// Parses a mesh; the format follows from the content (STL, PLY, OFF magic) and else from the name's ending (.obj). A
/// byte order mark does not count; what stands behind the last triangle that is promised is passed over, with a warning
/// (W0600).
/// Errors: a diagnostic with the line (text) or byte offset (binary), then the result is empty. Refused: unknown
/// format, truncated data, counts that exceed the file's length, indices out of range, numbers that are not finite, no
/// triangle. Cost: linear.
std::optional<Mesh> parse_mesh(const std::string& path, std::string_view bytes, Diagnostics& diagnostics);

struct Bounds {
  glm::dvec3 lo;
  glm::dvec3 hi;
};
Bounds bounds(const Mesh& mesh);

/// Edges of one kind, and where the first of them is.
struct EdgeCount {
  std::size_t count = 0;
  glm::dvec3 from{0.0}, to{0.0};
};

/// For each position the index of the first one with equal coordinates. Cost: linear.
std::vector<std::uint32_t> first_of_equal(std::span<const glm::dvec3> positions);

/// The edges that do not have exactly one triangle on each side, wound alike, by what is wrong with them. Positions are
/// compared, not indices; triangles with a corner twice don't count.
struct EdgeFaults {
  std::size_t edges = 0;  ///< in all
  EdgeCount open;         ///< one triangle: the border of a hole, or of a sheet
  EdgeCount opposed;      ///< two triangles that pass it in the same direction: wound against each other
  EdgeCount crowded;      ///< more than two triangles: faces that are there twice, inner walls, or parts that touch
  std::size_t count() const { return open.count + opposed.count + crowded.count; }  ///< 0 for a closed mesh
};

/// Cost: O(n log n) at worst, nearly linear.
EdgeFaults find_edge_faults(const Mesh& mesh);

/// A line for each kind of fault: how many edges have it, and where the first of them is.
std::vector<std::string> describe(const EdgeFaults& edges);

/// Tells for each triangle of a closed mesh whether its part (of triangles that hang together by vertices) holds a
/// positive volume. Then its face looks outward; voids, and what is turned inside out, hold a negative one. A part that
/// passes through itself is judged as a whole. Cost: linear.
std::vector<bool> outward_triangles(const Mesh& mesh);

/// The standard cube [-1,1]^3: 8 vertices, 12 triangles.
Mesh standard_cube();

}  // namespace dmvv::voml
