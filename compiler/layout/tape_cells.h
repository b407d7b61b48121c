// A straight line, shortened for the cells of the standard cube from coarse to fine.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "compiler/layout/tapes.h"
#include "compiler/snippet/straight_line.h"

namespace dmvv::compiler {

/// What a device compares the value with: f <= iso for each iso from lo to hi.
struct IsoRange {
  double lo = 0.0;
  double hi = 0.0;
};

struct TapeCells {
  std::uint32_t cells_a_side = 1;
  std::vector<std::uint32_t> cells;  ///< x fastest; DMVV_TAPE_POSITIVE, DMVV_TAPE_NEGATIVE, or a line's number + 2
  std::deque<snippet::StraightLine> lines;  ///< all different
};

/// Halves cells whose side is not known, the longest lines first, until there is nothing left to decide or a budget of
/// the options is used up.
/// In:    hoisted holds what a device reads at any time.
/// Cost:  options.most_work steps at most, and those of one more level's first cells; on all cores.
TapeCells shorten_for_cells(const snippet::StraightLine& whole, std::span<const snippet::BoxValue> hoisted,
                            const IsoRange& iso, const TapeOptions& options);

}  // namespace dmvv::compiler
