// A token's place is that of its text in the file; what a macro made has two.
#include "compiler/snippet/reporter.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace dmvv::compiler::snippet {

Reporter::Reporter(const voml::Function& function, const Prepared& prepared, Diagnostics& diagnostics)
    : function_(function), prepared_(prepared), diagnostics_(diagnostics) {
  for (const voml::GlslText& helper : function.helpers) texts_.push_back(&helper);
  texts_.push_back(&function.body);
}

void Reporter::report(Code code, const Token& token, std::string message, std::vector<Note> notes) {
  ++errors_;
  if (token.macro != 0) {
    const Token& macro = prepared_.macros[token.macro - 1];
    notes.push_back(
        {span_of(macro), fmt::format("'{}' comes from the macro '{}', defined here", token.author, macro.word)});
  }
  diagnostics_.report(code, span_of(token), std::move(message), std::move(notes));
}

void Reporter::report(Code code, const Span& span, std::string message) {
  ++errors_;
  diagnostics_.report(code, span, std::move(message));
}

void Reporter::warn(Code code, const Span& span, std::string message, std::vector<Note> notes) {
  diagnostics_.report(code, span, std::move(message), std::move(notes));
}

Span Reporter::body_words() const {
  const std::vector<Token>& tokens = prepared_.texts.back().tokens;
  if (tokens.empty()) return function_.span;
  const Span first = span_of(tokens.front()), last = span_of(tokens.back());
  return {first.source, first.begin, std::max(first.end, last.end)};
}

Span Reporter::loop() const {
  const Token* found = nullptr;
  for (const PreparedText& text : prepared_.texts) {
    for (const Token& token : text.tokens) {
      if (!token.is("for") && !token.is("while")) continue;
      if (found != nullptr) return body_words();
      found = &token;
    }
  }
  return found != nullptr ? span_of(*found) : body_words();
}

}  // namespace dmvv::compiler::snippet
