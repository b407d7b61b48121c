// Inside compiler/snippet: the library of distance functions, shaders/sdf.glsl.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace dmvv::compiler::snippet {

/// The functions of the library, in its order; overloads once each.
const std::vector<std::string_view>& library_functions();

/// The functions among `names` and those that they call, as GLSL in the library's order: what a snippet does not use
/// is not compiled.
std::string library_for(const std::set<std::string_view>& names);

}  // namespace dmvv::compiler::snippet
