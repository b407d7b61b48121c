// Inside compiler/snippet: GLSL text as tokens, each with its place.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace dmvv::compiler::snippet {

/// A token of one of the texts a snippet is made of. Of a token that a macro put there, the place is the macro's use.
struct Token {
  enum class Kind : std::uint8_t { identifier, number, other };
  Kind kind = Kind::other;
  bool is_final = false;    ///< the name of a macro within its own expansion: it is not expanded any more
  std::string_view word;    ///< what glslang is given
  std::string_view author;  ///< what the author wrote
  std::uint32_t text = 0;   ///< number of the text
  std::uint32_t begin = 0;  ///< bytes of it
  std::uint32_t end = 0;
  std::uint32_t line = 0;   ///< of a directive: lines that end in a backslash are one
  std::uint32_t macro = 0;  ///< 1 + the number of the macro that made it; 0: it stands in the text

  bool is(std::string_view w) const { return word == w; }
  bool is_identifier() const { return kind == Kind::identifier; }
};

/// Words that stand in no text of the author: joined from pieces, or made by macros.
class WordPool {
 public:
  std::string_view keep(std::string word) { return words_.emplace_back(std::move(word)); }

 private:
  std::deque<std::string> words_;
};

/// Splits GLSL into tokens; comments and line continuations are gone. Nothing is refused: what is no token of GLSL (a
/// quote, an accented letter, the "/*" of a comment that never ends) becomes one of kind `other`, and so does "##".
/// Words lie in `glsl`, and in `pool` where a line continuation divides the text.
/// Cost: linear.
std::vector<Token> tokenize(std::string_view glsl, std::uint32_t text, WordPool& pool);

/// Whether a token of kind `other` exists in GLSL. '#' does not: directives are read before.
bool is_operator(std::string_view word);

}  // namespace dmvv::compiler::snippet
