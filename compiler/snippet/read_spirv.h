// SPIR-V -> Program: calls inlined, values scalar, control flow structured.
#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// Reads the module's entry point as `float f(vec3 p, float t)`. The shader's interface:
///
///   layout(location = 0) in vec3 p;       // any names; a vertex shader is best: it knows neither derivatives
///   layout(location = 1) in float t;      // nor discard
///   layout(location = 0) out float f;
///   void main() { f = snippet(p, t); }
///
/// In:     a module that glslang made (SPIR-V 1.0 to 1.5, spirv-val accepts it), unoptimised; calls are inlined, early
///         returns merged and variables turned into values here, by the passes of SPIRV-Tools.
/// Errors (input): recursion; what a distance function cannot use or this reader does not know (names the SPIR-V
///         instruction or built-in); control flow nested deeper than 200; more than 2^20 instructions after inlining,
///         2^19 instructions of the program or 4,096 scalars in local arrays.
/// Cost:   that of spirv-opt's inlining and SSA passes, linear otherwise. The same words give the same program.
Result<Program> read_spirv(std::span<const std::uint32_t> spirv);

}  // namespace dmvv::compiler::snippet
