// Inside compiler/snippet: prepared texts become one shader, with one token a line (glslang knows lines only, so that a
// line is a place).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/snippet/literals.h"
#include "compiler/snippet/preprocess.h"

namespace dmvv::compiler::snippet {

/// What a line of the shader is: a token of the author, or something of ours behind one.
struct Line {
  const Token* token = nullptr;  ///< null: before any token
  bool behind = false;
  bool forwards = false;  ///< text of ours that only repeats what the author declared
  std::uint32_t statement = 0;
};

struct Shader {
  std::string glsl;
  Literals literals;        ///< of the author's functions, in long texts
  std::vector<Line> lines;  ///< line k + 1 of the text
};

/// The function that the body becomes. What the author calls so has another word (names.h).
inline constexpr std::string_view body_function = "f";

/// A vertex shader whose output is what the body gives for its inputs, the point and the time (read_spirv.h).
/// In:   texts without faults that make what follows meaningless (Prepared::complete); they must outlive the shader.
/// Cost: linear in the tokens.
Shader assemble_shader(const Prepared& prepared);

}  // namespace dmvv::compiler::snippet
