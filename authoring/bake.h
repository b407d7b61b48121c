// A field of a scene -> distance grid.
#pragma once

#include "authoring/distance_grid.h"
#include "authoring/field.h"

namespace dmvv::authoring {

struct BakeOptions {
  std::uint32_t resolution = 64;  ///< samples along the longest side of the grid's box, 4..512
  double padding = 0.05;          ///< border around what is inside, as a share of its longest side, 0..1
  bool distance = false;          ///< write distances to the field's boundary instead of its values
  unsigned threads = 0;           ///< 0: as many as there are cores; never changes the result
};

struct BakeReport {
  std::size_t not_finite = 0;  ///< samples at which the source gave no finite number (Field)
};

/// Samples a field over the box of what is inside and its padding (clipped to the cube).
///
/// Values: the field's own; or, with `distance`, in cube units with the field's sign, the distances to triangles whose
/// corners lie on its boundary, a voxel apart (Gibson 1998, corners moved to the boundary): too great or small by up to
/// voxel^2 / 2 times the boundary's curvature, and edges are cut off by up to a voxel. Beyond two voxels from the
/// boundary the nearest triangle is searched from those of the neighbours on, and may, rarely, be another one. Errors
/// (input): options out of range; nothing is inside, or no sample; with `distance`, no boundary. Errors (environment):
/// not enough memory. Cost: one evaluation a sample; with `distance` some 50 more a voxel on the boundary, and some 60
/// distances to triangles a sample. 4 bytes a sample; with `distance` 8, and some 700 bytes a voxel on the boundary.
Result<voml::Grid> bake(const Field& field, const BakeOptions& options, BakeReport& report,
                        const Progress& progress = {});

}  // namespace dmvv::authoring
