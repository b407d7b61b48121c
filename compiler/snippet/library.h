// Inside compiler/snippet: the library of distance functions, shaders/sdf.glsl.
#pragma once

#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace dmvv::compiler::snippet {

/// The functions of the library, in its order; overloads once each.
const std::vector<std::string_view>& library_functions();

/// The parameters of each function of this name, as Declaration::signature has them; empty if the library has none.
const std::vector<std::string>& library_signatures(std::string_view name);

/// The functions among `names` and those that they call, as GLSL in the library's order: what a snippet does not use
/// is not compiled.
std::string library_for(const std::unordered_set<std::string_view>& names);

}  // namespace dmvv::compiler::snippet
