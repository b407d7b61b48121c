// The kernels through glslang and the SPIR-V validator.
#include <spirv-tools/libspirv.hpp>

#include "base/parallel.h"
#include "compiler/compile.h"
#include "compiler/glsl/kernel.h"
#include "compiler/spirv/glsl_compiler.h"

namespace dmvv::compiler {

std::string validate_spirv(std::span<const std::uint32_t> spirv) {
  std::string log;
  spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_2);
  tools.SetMessageConsumer([&log](spv_message_level_t, const char*, const spv_position_t&, const char* message) {
    log += message;
    log += '\n';
  });
  return tools.Validate(spirv.data(), spirv.size()) ? std::string() : "spirv-val: " + log;
}

namespace {

tl::unexpected<Error> generator_bug(const char* stage, const std::string& log, const std::string& glsl) {
  return fail(Fault::environment, std::string("a generated shader was refused by ") + stage + "; this is a bug of dmvv",
              {log, "the shader:", glsl});
}

Result<void> compile_shader(Shader& shader, const CodeCache& cache) {
  const std::string key = code_key(ShaderStage::compute, shader.glsl);
  shader.spirv = find_code(cache, key);
  if (!shader.spirv.empty()) return {};
  CompiledGlsl compiled = compile_glsl(ShaderStage::compute, shader.glsl);
  if (compiled.spirv.empty()) return generator_bug("glslang", compiled.log, shader.glsl);
  if (const std::string log = validate_spirv(compiled.spirv); !log.empty())
    return generator_bug("spirv-val", log, shader.glsl);
  shader.spirv = std::move(compiled.spirv);
  if (cache.keep) cache.keep(key, shader.spirv);
  return {};
}

/// Pictures by rays are coloured like all others.
bool asks_about(const KernelSpec& kernel, Source source) {
  return kernel.source == source ||
         (source == Source::rays && (kernel.source == Source::hits || kernel.name == pixels_kernel.name));
}

}  // namespace

Result<void> to_spirv(Program& program, Source source, const CodeCache& cache) {
  std::vector<Shader*> shaders;
  for (Kernel& kernel : program.kernels) {
    if (!asks_about(kernel.spec, source)) continue;
    for (Shader& shader : kernel.shaders) shaders.push_back(&shader);
  }
  std::vector<Result<void>> made(shaders.size());
  in_parallel(shaders.size(), [&](std::size_t i) { made[i] = compile_shader(*shaders[i], cache); });
  for (Result<void>& one : made) {
    if (!one) return std::move(one);
  }
  return {};
}

}  // namespace dmvv::compiler
