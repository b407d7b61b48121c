// Inside compiler/snippet: GLSL -> SPIR-V by glslang, with its log as data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/snippet/literals.h"
#include "compiler/spirv/code_cache.h"

namespace dmvv::compiler::snippet {

/// An error of glslang.
struct LogEntry {
  std::uint32_t line = 0;  ///< from 1; 0: of linking, no line
  std::string word;        ///< what glslang names in quotes; may be empty
  std::string reason;
};

struct Compiled {
  std::vector<std::uint32_t> spirv;  ///< 1.5, unoptimised; empty if there are errors
  std::vector<LogEntry> errors;      ///< all of them, in the order of the log
};

/// Compiles a vertex shader: that stage knows neither derivatives nor discard. The text's literals are put back.
/// `cache` is asked first, and told of what compiled.
Compiled compile_vertex_shader(const std::string& glsl, const Literals& literals = {}, const CodeCache& cache = {});

}  // namespace dmvv::compiler::snippet
