#include "compiler/spirv/glsl_compiler.h"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <string_view>

namespace dmvv::compiler {
namespace {

/// glslang wants one initialisation a process.
void use_glslang() {
  struct Process {
    Process() { glslang::InitializeProcess(); }
    ~Process() { glslang::FinalizeProcess(); }
  };
  static const Process process;
}

}  // namespace

CompiledGlsl compile_glsl(ShaderStage stage, const std::string& glsl, Lines lines) {
  use_glslang();
  const EShLanguage language = stage == ShaderStage::vertex ? EShLangVertex : EShLangCompute;
  const char* text = glsl.c_str();
  glslang::TShader shader(language);
  shader.setStrings(&text, 1);
  shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_2);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
  constexpr auto messages = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules | EShMsgCascadingErrors);
  if (!shader.parse(GetDefaultResources(), 460, false, messages)) return {{}, shader.getInfoLog()};
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages)) return {{}, program.getInfoLog()};

  CompiledGlsl result;
  glslang::SpvOptions options;
  options.disableOptimizer = true;  // it speeds up neither drivers nor frames, and hides what the author wrote
  options.generateDebugInfo = lines == Lines::kept;
  glslang::GlslangToSpv(*program.getIntermediate(language), result.spirv, &options);
  return result;
}

std::string code_key(ShaderStage stage, const std::string& glsl) {
  const glslang::Version version = glslang::GetVersion();
  return "SPIR-V 1.5, Vulkan 1.2, glslang " + std::to_string(version.major) + "." + std::to_string(version.minor) +
         "." + std::to_string(version.patch) + (stage == ShaderStage::vertex ? ", vertex\n" : ", compute\n") + glsl;
}

std::vector<std::uint32_t> find_code(const CodeCache& cache, const std::string& key) {
  if (!cache.find) return {};
  return cache.find(key).value_or(std::vector<std::uint32_t>{});
}

}  // namespace dmvv::compiler
