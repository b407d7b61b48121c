// Inside compiler/snippet: names belong to the scope that defines them.
//
// glslang knows one scope for all texts outside of functions, so names that would meet there are given others: what a
// file defines is named after it, and a file that sees several definitions gets functions of its own that forward to
// them. By the time a Program is read they are gone.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "compiler/snippet/preprocess.h"

namespace dmvv::compiler::snippet {

/// What a text declares outside of functions, in order. In: brackets match. Cost: linear.
std::vector<Declaration> global_declarations(std::span<const Token> tokens);

/// Whether what stands in scope `from` may use what is defined in scope `to`: its own, or seen through imports.
class Visibility {
 public:
  explicit Visibility(const Sources& sources);
  bool operator()(std::uint32_t from, std::uint32_t to) const { return sees_[from][to]; }

 private:
  std::vector<std::vector<bool>> sees_;
};

/// Gives tokens the words under which glslang keeps definitions apart, so that each scope means what it would mean
/// alone:
///   - a scope sees what it defines, and what the scopes it sees define;
///   - functions of one name with different parameters are overloads, wherever they stand, those of GLSL among them;
///   - a definition hides what its scope sees of the same name: of functions those with the same parameters;
///   - a function with the parameters of one of the library hides all that the library calls so;
///   - two definitions of which neither hides the other are ambiguous (Prepared::ambiguous).
/// Token::author stays. Fills PreparedText::forwards. Cost: linear in the tokens, and in the functions that scopes see
/// of names that several define; throws Stop (macros.h) beyond 2^16 of these.
void settle_names(const Sources& sources, const Visibility& sees, Prepared& prepared);

/// What the author calls a word that settle_names made.
std::string_view author_word(std::string_view word);

}  // namespace dmvv::compiler::snippet
