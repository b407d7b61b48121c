// Triangle mesh -> distance grid: exact distances, signs by the generalised winding number.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "base/result.h"
#include "voml/assets/grid.h"
#include "voml/assets/mesh.h"

namespace dmvv::authoring {

struct GridOptions {
  std::uint32_t resolution = 64;  ///< samples along the longest side of the grid's box, 4..512
  double padding = 0.05;          ///< empty border around the mesh, as a share of its longest side, 0..1
  bool fit = true;       ///< scale the mesh (uniformly, centred) so that it with its padding fills the standard cube
  unsigned threads = 0;  ///< 0: as many as there are cores; never changes the result
};

/// Tells how far a function is: `done` of `total` steps, rising to all of them; called on the calling thread.
using Progress = std::function<void(std::size_t done, std::size_t total)>;

struct GridReport {
  voml::EdgeFaults edges;             ///< of the mesh; nothing if it is closed
  double padding = 0.0;               ///< GridOptions::padding
  double cube_from_mesh_scale = 1.0;  ///< cube = scale * mesh + offset
  glm::dvec3 cube_from_mesh_offset{0.0};
};

/// "a resolution of 212 would keep 99 % of the boundary"; for GridCheck::resolution_needed.
std::string resolution_needed_text(std::uint32_t resolution);

inline constexpr std::uint32_t max_grid_resolution = 512;

/// Distances in units of the standard cube, negative inside, at the cell centres of a box that holds the mesh and its
/// padding (clipped to the cube).
///
/// Sign: negative where the generalised winding number exceeds 1/2 (Jacobson et al. 2013), evaluated hierarchically
/// (Barill et al. 2018); holes and stray shells do not flip it, a mesh turned inside out as a whole is turned back.
/// Box: voxels are cubes, sizes are rounded up; its corners are values that an LXN file holds exactly.
/// A self-intersecting mesh is solid wherever it winds around; distances are to the nearest triangle all the same, be
/// it one inside the solid. Errors (input): options out of range; a mesh without extent or too small for its
/// coordinates' precision; a mesh that leaves the cube when `fit` is off; a mesh without inside, because of its edges'
/// faults (counted, each kind with its first edge; a quarter of all edges between triangles wound against each other is
/// enough) or because it is thinner than a voxel (with a resolution that would do). Errors (environment): not enough
/// memory. Cost: O(samples * log triangles); 4 bytes a sample and some 300 bytes a triangle.
Result<voml::Grid> distance_grid(const voml::Mesh& mesh, const GridOptions& options, GridReport& report,
                                 const Progress& progress = {});

}  // namespace dmvv::authoring
