// How steep distance sources are: what an answer needs to tell how far it holds (shaders/reach.glsl).
#pragma once

#include <vector>

#include "compiler/grids/storage.h"
#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// Bounds each SDF's source over the standard cube of its local frame, at any time: what two of its points may differ
/// by, and what a device that stores and filters grids like that may get wrong. Infinite where nothing is known. Cost:
/// a pass over the grids, on all cores, and one over the instructions of each function.
std::vector<snippet::Steepness> source_steepness(const Module& module, TexelFormat format, Filter filter);

}  // namespace dmvv::compiler
