// Which regions a ray ends on, and which it goes through.
#pragma once

#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// A region is opaque if its opacity reaches this: a ray ends on it. Below, it is a medium: it absorbs and emits along
/// the ray's length in the region's object, in units of that object.
inline constexpr double least_opaque = 1.0 - 0x1p-24;

/// Whether a ray ends on it, wherever it meets it; a bitmap must be opaque in all its texels.
bool is_opaque(const Module& module, const Region& region);

/// Whether a region is neither opaque nor empty.
bool is_medium(const Module& module, const Region& region);

/// Whether some region is a medium.
bool has_media(const Module& module);

}  // namespace dmvv::compiler
