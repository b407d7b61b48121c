// Inside compiler/snippet: what the texts of a function define outside of functions is found by its name.
#pragma once

#include <string_view>
#include <unordered_map>
#include <vector>

#include "compiler/snippet/preprocess.h"

namespace dmvv::compiler::snippet {

/// In:   prepared texts, which must outlive it.
/// Cost: linear in the declarations, once, when first asked for a name.
class Definitions {
 public:
  explicit Definitions(const Prepared& prepared) : prepared_(prepared) {}

  /// The tokens that name what glslang knows by this word, where it is defined.
  const std::vector<const Token*>& of(std::string_view word);

  /// The first that the author calls so; null if there is none.
  const Token* first_of_author(std::string_view name);

  /// Null for a token that is not the name of a declaration.
  const Declaration* declaration_of(const Token& name) const;

 private:
  void index();

  const Prepared& prepared_;
  std::unordered_map<std::string_view, std::vector<const Token*>> by_word_;
  std::unordered_map<std::string_view, const Token*> by_author_;  // the first of each name
  bool is_indexed_ = false;
};

}  // namespace dmvv::compiler::snippet
