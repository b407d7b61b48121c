// GLSL functions of our own, where a device's are too far off or the Vulkan specification promises too little.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// Is the operation written as a call of a function of our own?
bool has_device_function(Op op);

/// The functions that instructions call, each named PREFIX and its own name; empty if they call none.
std::string device_functions(std::span<const Instruction> instructions, std::string_view prefix);

}  // namespace dmvv::compiler::snippet
