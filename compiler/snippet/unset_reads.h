// Inside compiler/snippet: where the distance hangs on what a variable holds before it is set.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "compiler/snippet/literals.h"
#include "compiler/snippet/snippet.h"
#include "compiler/snippet/unset_variables.h"

namespace dmvv::compiler::snippet {

/// A variable whose value matters before it is set, and a point and time at which it does.
struct UnsetRead {
  UnsetVariable variable;
  glm::dvec3 p{0.0};
  double t_ms = 0.0;
};

/// Gives the variables that control flow leaves open (unset_variables.h) different values, and keeps those that change
/// the result at one of some 270 points: what conditions exclude is not reported, nor what the result does not need.
/// In:   the text of a vertex shader (read_spirv.h), its literals, and what compile_vertex_shader made of it.
/// Cost: linear where control flow leaves nothing open, as in nearly all texts; else the shader is compiled once more,
///       for the lines, and read three times, and three times a variable where it matters.
std::vector<UnsetRead> find_unset_reads(const std::string& glsl, const Literals& literals,
                                        const std::vector<std::uint32_t>& spirv);

}  // namespace dmvv::compiler::snippet
