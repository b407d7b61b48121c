// Names are looked up where an error asks for them; a text without errors needs no index.
#include "compiler/snippet/definitions.h"

#include <algorithm>
#include <utility>

namespace dmvv::compiler::snippet {

void Definitions::index() {
  if (std::exchange(is_indexed_, true)) return;
  for (const PreparedText& text : prepared_.texts) {
    for (const Declaration& declaration : text.declarations) {
      if (declaration.kind == Declaration::Kind::function && !declaration.is_definition) continue;
      const Token& name = text.tokens[declaration.name];
      by_word_[name.word].push_back(&name);
      by_author_.try_emplace(name.author, &name);
    }
  }
}

const std::vector<const Token*>& Definitions::of(std::string_view word) {
  index();
  static const std::vector<const Token*> none;
  const auto found = by_word_.find(word);
  return found == by_word_.end() ? none : found->second;
}

const Token* Definitions::first_of_author(std::string_view name) {
  index();
  const auto found = by_author_.find(name);
  return found == by_author_.end() ? nullptr : found->second;
}

const Declaration* Definitions::declaration_of(const Token& name) const {
  const PreparedText& text = prepared_.texts[name.text];
  const auto at = static_cast<std::size_t>(&name - text.tokens.data());
  const auto found = std::lower_bound(text.declarations.begin(), text.declarations.end(), at,
                                      [](const Declaration& d, std::size_t token) { return d.name < token; });
  return found != text.declarations.end() && found->name == at ? &*found : nullptr;
}

}  // namespace dmvv::compiler::snippet
