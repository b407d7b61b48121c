// Inside compiler/snippet: an author is told what glslang says of a shader, in the author's words and once.
#pragma once

#include <vector>

#include "compiler/snippet/assemble_shader.h"
#include "compiler/snippet/definitions.h"
#include "compiler/snippet/glslang_front.h"
#include "compiler/snippet/reporter.h"

namespace dmvv::compiler::snippet {

/// Reports the errors of a log, at most 100 in all, without those that are consequences of others or of the faults in
/// `prepared`, which are reported before.
/// In:   the log of that very shader, made of `prepared`; `definitions` of it.
/// Cost: linear in the tokens, and for each error reported.
void report_log(const std::vector<LogEntry>& log, const Prepared& prepared, const Shader& shader,
                Definitions& definitions, Reporter& reporter);

}  // namespace dmvv::compiler::snippet
