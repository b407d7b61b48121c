// Inside compiler/snippet: an author is told of variables whose value matters before it is set.
#pragma once

#include <cstdint>
#include <vector>

#include "compiler/snippet/assemble_shader.h"
#include "compiler/snippet/reporter.h"

namespace dmvv::compiler::snippet {

/// Warns of each variable that find_unset_reads (unset_reads.h) finds, at a mention of it.
/// In:   what glslang made of the shader without errors, and the texts that the shader was made of.
/// Cost: that of find_unset_reads, and linear in the tokens for each variable found.
void report_unset(const std::vector<std::uint32_t>& spirv, bool uses_time, const Prepared& prepared,
                  const Shader& shader, Reporter& reporter);

}  // namespace dmvv::compiler::snippet
