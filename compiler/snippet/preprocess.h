// Inside compiler/snippet: the author's texts -> tokens that are safe to give to glslang.
//
// Macros are expanded here, not by glslang: their size is bounded, and every token keeps its place.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/snippet/glsl_tokens.h"
#include "voml/scene.h"

namespace dmvv::compiler::snippet {

// Where hostile text is stopped.
inline constexpr std::size_t max_text_bytes = std::size_t{1} << 25;  ///< of all texts of one snippet
inline constexpr std::size_t max_tokens = std::size_t{1} << 22;      ///< after macros; some 100,000s of lines
inline constexpr std::size_t max_brackets = 100;                     ///< nested
inline constexpr std::size_t max_operators = 4000;                   ///< of one expression: each may nest in the next
inline constexpr std::size_t max_chain = 100;                        ///< nested statements, without or with braces

/// What is wrong with a token.
struct Fault {
  Code code;
  Token token;
  std::string message;
};

/// One text, ready for glslang but for the faults found in it.
struct PreparedText {
  std::vector<Token> tokens;
};

struct Prepared {
  std::vector<PreparedText> texts;  ///< in the order given
  std::vector<Fault> faults;        ///< E0401, E0404
  bool complete = true;             ///< false: a fault makes everything that follows meaningless
  bool uses_library = false;        ///< #include <sdf>
  bool uses_legacy_functions = false;
};

/// Reads directives (#include <sdf>, #define, #undef, #ifdef, #ifndef, #else, #endif), expands macros, gives words of
/// Cg their GLSL spelling, checks brackets and limits, and refuses what a distance function cannot use. Words that the
/// author declares are left alone. The last text is the body of a function, the others stand outside of functions.
/// Cost: linear in the tokens; macros may make at most max_tokens.
Prepared prepare(std::span<const std::string_view> texts);

/// The names that these tokens declare: functions, variables, types.
std::vector<std::string_view> declared_names(std::span<const Token> tokens);

/// Whether token i stands where its name is declared.
bool is_declaration(std::span<const Token> tokens, std::size_t i);

}  // namespace dmvv::compiler::snippet
