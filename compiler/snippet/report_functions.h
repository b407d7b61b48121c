// Inside compiler/snippet: functions can be wrong as a whole, which glslang tells by their mangled names.
#pragma once

#include <cstdint>
#include <vector>

#include "compiler/snippet/definitions.h"
#include "compiler/snippet/glslang_front.h"
#include "compiler/snippet/reporter.h"

namespace dmvv::compiler::snippet {

/// A function that is declared but not defined [E0402], one that calls itself [E0405], else what does not link [E0401].
/// In:   an error of linking, which has no line; the texts that the reporter knows.
/// Cost: linear in the tokens.
void report_linking(const LogEntry& entry, const Prepared& prepared, Definitions& defined, Reporter& reporter);

/// Functions that can end without a value [E0403].
/// In: what glslang made of the shader (assemble_shader.h).
void report_missing_returns(const std::vector<std::uint32_t>& spirv, Definitions& defined, Reporter& reporter);

}  // namespace dmvv::compiler::snippet
