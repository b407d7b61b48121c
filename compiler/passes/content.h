// What lies in the cubes of seeds and objects: boxes beyond which nothing does, on any device.
#pragma once

#include "compiler/grids/storage.h"
#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// `trim-cubes`: sets Sdf::content and Object::content, for devices that store and filter grids like that.
/// Proven by intervals over boxes for snippets, at any time, and by the samples of grids.
/// Cost: a pass over the grids, and some 500 evaluations of a function over boxes, on all cores.
void trim_cubes(Module& module, TexelFormat format, Filter filter);

}  // namespace dmvv::compiler
