// The kernels through glslang and the SPIR-V validator.
#include <spirv-tools/libspirv.hpp>

#include "compiler/compile.h"
#include "compiler/glsl/kernel.h"
#include "compiler/spirv/glsl_compiler.h"

namespace dmvv::compiler {

namespace {

tl::unexpected<Error> generator_bug(const char* stage, const std::string& log, const std::string& glsl) {
  return fail(Fault::environment, std::string("a generated shader was refused by ") + stage + "; this is a bug of dmvv",
              {log, "the shader:", glsl});
}

std::string validate(const std::vector<std::uint32_t>& spirv) {
  std::string log;
  spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_2);
  tools.SetMessageConsumer([&log](spv_message_level_t, const char*, const spv_position_t&, const char* message) {
    log += message;
    log += '\n';
  });
  return tools.Validate(spirv) ? std::string() : "spirv-val: " + log;
}

Result<void> compile_text(const std::string& glsl, std::vector<std::uint32_t>& code, const CodeCache& cache) {
  const std::string key = code_key(ShaderStage::compute, glsl);
  code = find_code(cache, key);
  if (!code.empty()) return {};
  CompiledGlsl compiled = compile_glsl(ShaderStage::compute, glsl);
  if (compiled.spirv.empty()) return generator_bug("glslang", compiled.log, glsl);
  if (const std::string log = validate(compiled.spirv); !log.empty()) return generator_bug("spirv-val", log, glsl);
  code = std::move(compiled.spirv);
  if (cache.keep) cache.keep(key, code);
  return {};
}

Result<void> compile_kernel(Program& program, Kernel kernel, const CodeCache& cache) {
  const auto k = static_cast<std::size_t>(kernel);
  return compile_text(program.glsl[k], program.spirv[k], cache);
}

Result<void> compile_stages(Program& program, const CodeCache& cache) {
  for (Stage& stage : program.stages) {
    if (auto made = compile_text(stage.glsl, stage.spirv, cache); !made) return made;
  }
  return {};
}

}  // namespace

Result<void> to_spirv(Program& program, Kernel kernel, const CodeCache& cache) {
  const bool has_leaders = !program.glsl[static_cast<std::size_t>(Kernel::leaders)].empty();
  if (kernel == Kernel::pixels && has_leaders) {
    if (auto made = compile_kernel(program, Kernel::leaders, cache); !made) return made;
  }
  const bool in_stages = kernel == Kernel::pixels && !program.stages.empty();
  return in_stages ? compile_stages(program, cache) : compile_kernel(program, kernel, cache);
}

}  // namespace dmvv::compiler
