// Codegen::thesis: a module stored as the published implementation of the thesis stores it, errors included
// (spec/thesis.md). A baseline for comparisons; nothing else uses it.
#pragma once

#include <cstdint>

#include "compiler/layout/atlas.h"
#include "compiler/layout/flatten.h"

namespace dmvv::compiler {

/// Entries of the published implementation's fixed buffers.
struct ThesisLimits {
  std::uint32_t sdfs = 64;
  std::uint32_t regions = 64;
  std::uint32_t nodes = 128;         ///< leaves included
  std::uint32_t instances = 262144;  ///< objects, and each seed or candidate once for every cell that lists it
  std::uint32_t cells = 262144;      ///< of all index grids together
};
inline constexpr ThesisLimits thesis_limits;

/// Refuses a module that a fixed buffer cannot hold. Errors: E0305, one for each buffer, with both numbers.
/// Cost: that of counting the entries of every index.
bool fits_thesis(const Module& module, Diagnostics& diagnostics);

/// Packs the grids in one row, along the axis whose largest grid is smallest, largest volume first, without borders;
/// each side is rounded up to a power of two. A texel is round(255 (v / 2 + 1/2)), v cut to [-1, 1]; what is left over
/// is 1.
///
/// Errors: E0303 a side exceeds max_extent.
/// Source: thesis section 4.3.2; the published packTexture3D.
std::optional<Atlas> pack_thesis_atlas(std::span<const voml::Grid> grids, std::uint32_t max_extent,
                                       Diagnostics& diagnostics);

/// Records for shaders/walk_thesis.glsl. They differ from flatten's: a region has one group at most; placements stand
/// in the order of the cells that list them; cells are pairs (first placement, count), z fastest; lists are not used.
Records flatten_thesis(const Module& module, const Atlas& grid_atlas, const Atlas& bitmap_atlas);

}  // namespace dmvv::compiler
