// What the tests of emitted GLSL share: snippets from text, and emitted text read back.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "compiler/snippet/glslang_front.h"
#include "compiler/snippet/program.h"
#include "compiler/snippet/read_spirv.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::tests {

using compiler::snippet::Snippet;

/// The program of a shader: declarations, then `float NAME(...)` called by `call`.
inline compiler::snippet::Program read_shader(const std::string& declarations, const std::string& call) {
  const std::string text = fmt::format(
      "#version 460\n"
      "layout(location = 0) in vec3 place;\nlayout(location = 1) in float time;\nlayout(location = 0) out float "
      "value;\n"
      "{}\nvoid main() {{ value = {}; }}\n",
      declarations, call);
  const auto compiled = compiler::snippet::compile_vertex_shader(text, {}, {});
  for (const auto& error : compiled.errors) FAIL_CHECK(error.line << ": " << error.word << ": " << error.reason);
  REQUIRE_MESSAGE(compiled.errors.empty(), text);
  auto program = compiler::snippet::read_spirv(compiled.spirv);
  REQUIRE_MESSAGE(program, program.error().message << "\n" << text);
  return *program;
}

/// A snippet `float f(vec3 p, float t) { BODY }`, with helpers, without the legacy spellings that scenes may use.
inline compiler::snippet::Program read_body(const std::string& body, const std::string& helpers = "") {
  return read_shader(fmt::format("{}\nfloat f(vec3 p, float t) {{\n{}\n}}", helpers, body), "f(place, time)");
}

inline Snippet snippet(compiler::snippet::Program program) {
  return Snippet(std::make_shared<const compiler::snippet::Program>(std::move(program)));
}

/// A float as GLSL, any value.
inline std::string glsl_constant(float value) {
  if (!std::isfinite(value)) return std::isnan(value) ? "uintBitsToFloat(2143289344u)" : "uintBitsToFloat(2139095040u)";
  return fmt::format("{:.9e}", value);
}

/// What a snippet emits, with the time values of one moment as constants, as a program again.
inline compiler::snippet::Program read_back(const Snippet& original, double t_ms) {
  std::vector<std::string> values = {"0.0"};
  for (const float value : original.time_values(t_ms)) values.push_back(glsl_constant(value));
  return read_shader(fmt::format("const float time_values[{0}] = float[{0}]({1});\n{2}", values.size(),
                                 fmt::join(values, ", "), original.glsl("emitted", 1)),
                     "emitted(place)");
}

/// Points of the standard cube whose coordinates are floats, so a device gets them unchanged. The same each time.
inline std::vector<glm::dvec3> points_of_cube(std::size_t count) {
  std::mt19937 random(20161);
  const auto coordinate = [&random] { return static_cast<double>(static_cast<int>(random() % 2001u) - 1000) / 1024.0; };
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = coordinate(), y = coordinate();
    points.push_back({x, y, coordinate()});
  }
  return points;
}

}  // namespace dmvv::tests
