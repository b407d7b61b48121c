// The kernels through glslang and the SPIR-V validator.
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <spirv-tools/libspirv.hpp>

#include "compiler/compile.h"
#include "compiler/glslang_process.h"

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

}  // namespace

Result<void> to_spirv(Program& program, Kernel kernel) {
  use_glslang();
  const std::string& glsl = program.glsl[static_cast<std::size_t>(kernel)];
  const char* text = glsl.c_str();

  glslang::TShader shader(EShLangCompute);
  shader.setStrings(&text, 1);
  shader.setEnvInput(glslang::EShSourceGlsl, EShLangCompute, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_2);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
  constexpr auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);
  if (!shader.parse(GetDefaultResources(), 460, false, messages)) {
    return generator_bug("glslang", shader.getInfoLog(), glsl);
  }
  glslang::TProgram linked;
  linked.addShader(&shader);
  if (!linked.link(messages)) return generator_bug("glslang", linked.getInfoLog(), glsl);

  glslang::SpvOptions options;
  options.disableOptimizer = true;  // it speeds up neither the driver's compiler nor the frame
  std::vector<std::uint32_t> spirv;
  glslang::GlslangToSpv(*linked.getIntermediate(EShLangCompute), spirv, &options);
  if (const std::string log = validate(spirv); !log.empty()) return generator_bug("spirv-val", log, glsl);
  program.spirv[static_cast<std::size_t>(kernel)] = std::move(spirv);
  return {};
}

}  // namespace dmvv::compiler
