// Inside compiler/snippet: an author is told what is wrong with a function, at its place in the VOML file.
#pragma once

#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "compiler/snippet/preprocess.h"
#include "voml/scene.h"

namespace dmvv::compiler::snippet {

/// Knows where the tokens of a function stand, and counts the errors that it reports.
/// In: all that it is made of must outlive it.
class Reporter {
 public:
  Reporter(const voml::Function& function, const Prepared& prepared, Diagnostics& diagnostics);

  Span span_of(const Token& token) const { return voml::locate(text_of(token), token.begin, token.end); }
  /// The place behind a token, without width.
  Span behind(const Token& token) const {
    const Span span = span_of(token);
    return {span.source, span.end, span.end};
  }
  bool in_body(const Token& token) const { return token.text + 1 == texts_.size(); }

  /// From the first token of the body to its last; the whole function if the body has none.
  Span body_words() const;

  /// The loop, if there is one alone; else the body.
  Span loop() const;

  /// A fault in what a macro made stands where the macro is used; a note says where its text stands.
  void report(Code code, const Token& token, std::string message, std::vector<Note> notes = {});
  void report(Code code, const Span& span, std::string message);

  /// Is not counted.
  void warn(Code code, const Span& span, std::string message, std::vector<Note> notes = {});

  std::size_t errors() const { return errors_; }

 private:
  const voml::GlslText& text_of(const Token& token) const { return *texts_[token.text]; }

  const voml::Function& function_;
  const Prepared& prepared_;
  Diagnostics& diagnostics_;
  std::vector<const voml::GlslText*> texts_;
  std::size_t errors_ = 0;
};

}  // namespace dmvv::compiler::snippet
