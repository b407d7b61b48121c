// Exits of a block become the other side of a branch: what a switch for every early return would cost is saved.
#pragma once

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// Does anything inside leave the block or loop that the sequence is the inside of?
bool leaves(const Sequence& sequence);

/// Turns `if (c) { A; break; } B` into `if (c) A else B`, in a sequence with which its block ends: a switch for every
/// early return would cost the driver more. Exits for which that does not suffice stay.
/// In:   `depth`, the branches of the block around the sequence; beyond 60 nothing is changed.
/// Cost: linear in the nodes, times the depth of the branches that take what followed them.
void nest(Sequence& sequence, int depth);

}  // namespace dmvv::compiler::snippet
