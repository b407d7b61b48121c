// The surface of anything that can say whether points lie in it: support meshes of scenes.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/result.h"
#include "voml/assets/mesh.h"

namespace dmvv::authoring {

/// For each point of the standard cube, 1 if it lies inside, else 0.
using InsideTest = std::function<Result<std::vector<char>>(std::span<const glm::dvec3>)>;

inline constexpr std::uint32_t max_surface_resolution = 512;

struct SurfaceOptions {
  std::uint32_t resolution = 128;  ///< cells along each axis of the cube, 8..max_surface_resolution
};

/// A closed mesh round what is inside, within the standard cube, whose vertices lie inside, at most 1/512 of a cell
/// from the boundary, or up to 0.2 cells where it is hollow, so that triangles do not pass outside there; without
/// triangles if nothing is found. Coordinates are numbers of float32, no two vertices stand at the same place, and
/// every triangle has an area. Every edge is passed as often in one direction as in the other: once, but where parts of
/// the surface touch.
///
/// Cells four times as large are looked at first; what they miss, and no surface that they find leads to, is not there:
/// things thinner than 4 cells that stand alone. Where the boundary bends sharply the mesh may still pass outside, by
/// less than a cell. Errors: those of `inside`, and (input) a resolution out of range. Cost: some (resolution/4)^3
/// points, then some 70 a cell of the surface, asked for in blocks; memory: a byte a cell. Source: marching tetrahedra
/// (Doi and Koide 1991) over the six of a cube round its diagonal (Kuhn 1960), whose surface is a manifold; crossings
/// by bisection.
Result<voml::Mesh> surface_mesh(const InsideTest& inside, const SurfaceOptions& options);

}  // namespace dmvv::authoring
