// Inside compiler: what values a distance grid takes over a box.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "compiler/grids/grid_bounds.h"
#include "voml/assets/grid.h"

namespace dmvv::compiler {

struct Range {
  double lo;
  double hi;
};

/// Ranges of a grid's trilinear interpolant over boxes.
///
/// Over a box of a few voxels the range is exact: within a voxel the interpolant is linear along each axis, so it has
/// its extremes at corners. Over larger boxes it is that of the samples around it, from a pyramid of minima and maxima.
class GridRange {
 public:
  /// Keeps a reference to `grid`, which must outlive it. Cost: one pass over the samples; a seventh of their memory,
  /// twice.
  explicit GridRange(const voml::Grid& grid);

  /// Over [lo, hi], in samples: (0, 0, 0) is the centre of the first. Beyond the outer centres their values go on.
  /// Cost: 27 samples of the interpolant, or 64 reads of the pyramid, at most.
  Range over(const glm::dvec3& lo, const glm::dvec3& hi) const;

  const GridBounds& bounds() const { return bounds_; }

 private:
  struct Level {
    glm::uvec3 size;
    std::vector<float> least, most;  ///< over blocks of 2^level samples a side, x fastest
  };
  double at(const glm::dvec3& c) const;
  Range of_voxels(const glm::dvec3& lo, const glm::dvec3& hi, const glm::ivec3& first, const glm::ivec3& last) const;
  Range of_samples(const glm::ivec3& first, const glm::ivec3& last) const;

  const voml::Grid& grid_;
  GridBounds bounds_;
  std::vector<Level> levels_;  ///< levels_[k] is level k + 1; the samples themselves are level 0
};

}  // namespace dmvv::compiler
