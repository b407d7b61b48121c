// Inside compiler/snippet: what an #if or #elif asks -> yes or no.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "compiler/snippet/glsl_tokens.h"

namespace dmvv::compiler::snippet {

/// What is wrong with a condition. Without a token: it ends too early.
struct ConditionFault {
  const Token* token = nullptr;
  std::string message;
};

/// The value of an integer expression, its macros expanded and each `defined` replaced by 1 or 0.
///
/// Operators, by precedence: unary + - ~ !; * / %; + -; << >>; < > <= >=; == !=; &; ^; |; &&; ||. Numbers are decimal,
/// octal or hexadecimal, and computed with in 64 bits. The right side of && and || counts only where the left one does
/// not decide. Faults: a name (none is taken for 0), what is no whole number, division by zero, a shift by less than 0
/// or more than 63 bits, brackets and signs nested more than max_brackets deep.
/// Cost: linear.
/// Source: GLSL 4.60, section 3.3.
std::variant<std::int64_t, ConditionFault> evaluate_condition(std::span<const Token> tokens);

}  // namespace dmvv::compiler::snippet
