// GLSL text -> Program, for tests: no scene, no diagnostics.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>

#include "compiler/snippet/glslang_front.h"
#include "compiler/snippet/read_spirv.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler::snippet {

/// `body` is that of float f(vec3 p, float t), `helpers` stand before it. Throws what went wrong.
inline Program program_of(const std::string& body, const std::string& helpers = "") {
  const Compiled compiled = compile_vertex_shader(
      fmt::format("#version 460\nlayout(location = 0) in vec3 p_in;\nlayout(location = 1) in float t_in;\n"
                  "layout(location = 0) out float f_out;\n{}\nfloat f(vec3 p, float t) {{\n{}\n}}\n"
                  "void main() {{ f_out = f(p_in, t_in); }}\n",
                  helpers, body));
  for (const LogEntry& error : compiled.errors) {
    throw std::runtime_error(fmt::format("{}: '{}' {} in:\n{}", error.line, error.word, error.reason, body));
  }
  auto program = read_spirv(compiled.spirv);
  if (!program) throw std::runtime_error(program.error().message + " in:\n" + body);
  return std::move(*program);
}

inline Snippet snippet_of(const std::string& body, const std::string& helpers = "") {
  return Snippet(std::make_shared<const Program>(program_of(body, helpers)));
}

}  // namespace dmvv::compiler::snippet
