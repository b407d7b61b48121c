// Inside compiler: GLSL -> SPIR-V by glslang.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/spirv/code_cache.h"

namespace dmvv::compiler {

enum class ShaderStage : std::uint8_t { vertex, compute };

struct CompiledGlsl {
  std::vector<std::uint32_t> spirv;  ///< 1.5 for Vulkan 1.2, unoptimised; empty if there are errors
  std::string log;                   ///< glslang's errors, all of them
};

/// Does the SPIR-V tell the lines of the text (OpLine)? Drivers need none.
enum class Lines : std::uint8_t { dropped, kept };

/// Cost: some 60 ms once a process (glslang reads its own declarations), then milliseconds for 1,000 lines.
CompiledGlsl compile_glsl(ShaderStage stage, const std::string& glsl, Lines lines = Lines::dropped);

/// What the SPIR-V of this text depends on.
std::string code_key(ShaderStage stage, const std::string& glsl);

/// What `cache` has under the key; empty if nothing.
std::vector<std::uint32_t> find_code(const CodeCache& cache, const std::string& key);

}  // namespace dmvv::compiler
