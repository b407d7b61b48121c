// Decisions that ask for seeds of the same shape, one after the other: one search can tell which is the first to find
// one.
#pragma once

#include <vector>

#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// SDFs of decisions of which each stands on the positive side of the one before. All are seeded with one source and
/// have one iso; nothing else uses them, and no other way leads to the decisions behind the first.
using SeedChain = std::vector<Id<Sdf>>;

/// All chains of two SDFs and more, each as long as can be. An SDF whose author wants one list (index 1 1 1) is in
/// none. Cost: linear.
std::vector<SeedChain> find_seed_chains(const Module& module);
}  // namespace dmvv::compiler
