// Inside compiler/snippet: GLSL text as tokens, each with its place.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace dmvv::compiler::snippet {

/// A token of one of the texts a snippet is made of. Of a token that a macro put there, the place is the macro's use.
struct Token {
  enum class Kind : std::uint8_t { identifier, number, other };
  Kind kind = Kind::other;
  std::string_view word;    ///< what glslang is given
  std::string_view author;  ///< what the author wrote
  std::uint32_t text = 0;   ///< number of the text
  std::uint32_t begin = 0;  ///< bytes of it
  std::uint32_t end = 0;
  std::uint32_t line = 0;  ///< of a directive: lines that end in a backslash are one

  bool is(std::string_view w) const { return word == w; }
  bool is_identifier() const { return kind == Kind::identifier; }
};

/// Splits GLSL into tokens; comments are gone. Nothing is refused: what is no token of GLSL (a quote, an accented
/// letter, the "/*" of a comment that never ends) becomes one of kind `other`.
/// Cost: linear.
std::vector<Token> tokenize(std::string_view glsl, std::uint32_t text);

/// Whether a token of kind `other` exists in GLSL. '#' does not: directives are read before.
bool is_operator(std::string_view word);

}  // namespace dmvv::compiler::snippet
