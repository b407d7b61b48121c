// Inside compiler/snippet: the functions of GLSL that a distance function can call, with their parameters.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dmvv::compiler::snippet {

/// One function of GLSL: `sin(vec3)`.
struct BuiltIn {
  struct Parameter {
    std::string type;
    bool is_out = false;
  };
  std::string name;
  std::string result;
  std::vector<Parameter> parameters;

  /// The types of its parameters, as Declaration::signature has them.
  std::string signature() const;
};

/// The overloads of a name; empty if GLSL has no such function.
/// Source: GLSL 4.60, sections 8.1 to 8.8, without 64-bit types.
const std::vector<BuiltIn>& built_in_overloads(std::string_view name);

/// All names, in the order of the specification.
const std::vector<std::string_view>& built_in_functions();

}  // namespace dmvv::compiler::snippet
