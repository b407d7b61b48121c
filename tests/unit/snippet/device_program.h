// A snippet as a kernel, so that a device says what its value is at points.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "compiler/layout/scene_buffers.h"
#include "compiler/program.h"
#include "compiler/snippet/snippet.h"
#include "shaders/records.h"

namespace dmvv::tests {

using compiler::snippet::Snippet;

inline std::vector<float> times_of(const Snippet& snippet, double t_ms) {
  std::vector<float> values = snippet.time_values(t_ms);
  if (values.empty()) values.push_back(0.0f);  // no buffer is empty
  return values;
}

/// A kernel that answers with the bits of the value as the red of the colour.
inline compiler::Program points_program(const Snippet& snippet) {
  compiler::Program program;
  const std::vector<float> times = times_of(snippet, 0.0);
  constexpr std::uint32_t binding = compiler::scene_binding::nodes;
  compiler::Buffer buffer{"time_values", binding, std::vector<std::byte>(times.size() * sizeof(float))};
  program.buffers.push_back(std::move(buffer));
  const std::string glsl = fmt::format(
      R"(#version 460
layout(local_size_x = {}) in;
layout(set = 0, binding = {}, std430) readonly buffer TimeValues {{ float time_values[]; }};
layout(set = 1, binding = {}, std430) readonly buffer Points {{ vec4 points[]; }};
layout(set = 1, binding = {}, std430) writeonly buffer Answers {{ uint answers[]; }};
layout(push_constant) uniform Params {{ uint count; uint pad0, pad1, pad2; }};
{}
void main() {{
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  uint first = i * {}u;
  for (uint k = 0u; k < {}u; ++k) answers[first + k] = 0u;
  answers[first] = 1u;
  answers[first + 2u] = floatBitsToUint(f(points[i].xyz));
}}
)",
      DMVV_POINTS_GROUP_SIZE, binding, DMVV_BIND_POINTS, DMVV_BIND_ANSWERS, snippet.glsl("f", 0),
      DMVV_ANSWER_HEADER + 2, DMVV_ANSWER_HEADER + 2);
  program.kernels.push_back({compiler::points_kernel, {{glsl, {}}}});
  return program;
}

}  // namespace dmvv::tests
