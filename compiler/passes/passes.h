// Passes: Module -> Module, smaller, with the same answer at every point. Each is idempotent.
#pragma once

#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// `merge-assets`: grids with the same samples and box, bitmaps with the same texels, and snippets with the same
/// program are stored once.
void merge_assets(Module& module);

/// `prune-sides`: a decision whose two sides are the same tree of the same regions is replaced by that side.
void prune_sides(Module& module);

/// `drop-unreachable`: nodes, SDFs, regions, objects and assets that no path from the root reaches are removed. Region
/// numbers stay as they are.
void drop_unreachable(Module& module);

}  // namespace dmvv::compiler
