// How single things are written in GLSL: one definition for snippets that are written out and for tapes.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// An operation on operands that are names or bracketed, `function_prefix` before a function of our own.
/// Empty: it cannot be written as one expression.
std::string operation_text(Op op, const std::array<std::string, 3>& operands, std::string_view function_prefix);

/// A time value of a type from its slots in `time_values`; an int or uint takes two.
std::string time_value_text(Type type, std::string_view slot, std::string_view next_slot);

/// "float", "int", "uint", "bool".
std::string_view type_name(Type type);

}  // namespace dmvv::compiler::snippet
