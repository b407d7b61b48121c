// Inside compiler/snippet: functions that can end without a value; glslang lets them pass.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dmvv::compiler::snippet {

/// The functions of a module, as glslang made it, that have a path to their end without a `return`: their names, in the
/// order of the module. A loop whose condition is the constant true ends by `break` or `return` alone.
/// Cost: linear.
std::vector<std::string> functions_without_return(std::span<const std::uint32_t> spirv);

}  // namespace dmvv::compiler::snippet
