// Lookup grids: which seeds or candidates can hold a point. They change the cost of a search, never its answer.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "compiler/ir/affine.h"
#include "compiler/ir/placements.h"

namespace dmvv::compiler {

/// A uniform grid over [lo, hi] of the frame. A point outside belongs to the nearest cell.
///
/// lists[cells[c] .. cells[c + 1]) are the placements, ascending, whose box can hold a point of cell c; x runs fastest.
struct Lookup {
  glm::dvec3 lo{-1.0};
  glm::dvec3 hi{1.0};
  glm::uvec3 size{1};
  std::vector<std::uint32_t> cells;
  std::vector<std::uint32_t> lists;
  std::uint32_t longest = 0;  ///< most entries in one cell
  /// If asked for: of each cell how many cells all around are empty, itself included; 0: it is not.
  std::vector<std::uint32_t> gaps;

  glm::uvec3 cell_of(const glm::dvec3& p) const;
  std::span<const std::uint32_t> at(const glm::dvec3& p) const;
};

/// Builds the grid for placements in a frame whose points lie in the standard cube.
///
/// Boxes and cells are widened by the float32 error of the shader's arithmetic, so that rounding never loses a
/// placement: `frame_error` bounds the error of the point in the frame, PlacedBox::local_error that in the local box.
/// `wish` is the author's size (0: chosen from number and extent of the placements); at most 2^21 cells,
/// and fewer where the lists would exceed 512 entries a placement or 2^24 in all.
/// A wish of (1,1,1) gives the plain list. With `refine`, any other wish counts only if it has more cells than would be
/// chosen. `widened`: a cell's list holds also what comes so near to it, in cells; if not 0, there are gaps.
/// Cost: linear in the cells that the placements' bounds touch, at most 2^25 (or 8 a placement) of them.
/// Source: thesis section 3.2.1; separating axes of box faces (Gottschalk 2000), the edge pairs left out
/// (conservative).
Lookup build_lookup(std::span<const PlacedBox> placements, const glm::uvec3& wish,
                    const glm::dvec3& frame_error = glm::dvec3(0.0), bool refine = false, double widened = 0.0);

}  // namespace dmvv::compiler
