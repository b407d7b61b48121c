// Single things are written in GLSL here: operations, constants, time values, types. It is the one definition for
// snippets that are written out and for tapes.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// How tightly an expression binds (GLSL 4.60, section 5.1), the tightest first.
namespace ranks {
inline constexpr int primary = 0, unary = 1, product = 2, sum = 3, shift = 4, relation = 5, equality = 6, bit_and = 7,
                     bit_xor = 8, bit_or = 9, logic_and = 10, logic_xor = 11, loosest = 12;
}  // namespace ranks

/// How an operation is written: $0 $1 $2 are operands, @ begins the name of a function of our own
/// (device_functions.h), and how tightly it binds. $r is where the result goes if GLSL gives it back by a parameter,
/// and $x where it puts what is not wanted.
/// Of an infix operation the right operand must bind more tightly, so the order of evaluation stays.
struct Form {
  std::string_view pattern;
  int rank;  ///< of ranks
};

/// Loads and stores have an empty pattern: they need to know their array.
Form form_of(Op op);

/// A pattern with everything in its place; `result` is the name of $r, and $x that of the result not wanted.
std::string filled(std::string_view pattern, const std::array<std::string, 3>& operands,
                   std::string_view function_prefix, std::string_view result);

/// A constant as an expression that reads back as the same bits; only a negative number begins with '-'.
std::string literal(const Constant& constant);

/// An operation on operands that are names or bracketed, `function_prefix` before a function of our own.
/// Empty: it cannot be written as one expression.
std::string operation_text(Op op, const std::array<std::string, 3>& operands, std::string_view function_prefix);

/// A time value of a type from its slots in `time_values`; an int or uint takes two.
std::string time_value_text(Type type, std::string_view slot, std::string_view next_slot);

/// "float", "int", "uint", "bool".
std::string_view type_name(Type type);

}  // namespace dmvv::compiler::snippet
