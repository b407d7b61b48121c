// Inside compiler/snippet: directives obeyed, macros expanded.
//
// glslang's preprocessor would do the same, but says of a token that a macro's argument brought only where the macro
// ends, knows no files with macros of their own, and makes as many tokens as it is asked for.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "compiler/snippet/preprocess.h"

namespace dmvv::compiler::snippet {

/// Thrown where a text cannot be read on; prepare makes a fault of it.
struct Stop {
  Token token;
  std::string message;
};

/// The preprocessor of GLSL 4.60, section 3.3, over the texts of one snippet: #define, #undef, #if, #ifdef, #ifndef,
/// #elif, #else, #endif, #error, `defined`, `##`, macros with and without parameters; and #include <sdf>. What the
/// other directives ask for is refused, with the reason. Of macros with one name the own scope's counts; two different
/// ones of imports are a fault where the name is used. Faults: E0401, E0404, E0410, E0411. Cost: linear in the tokens
/// read and made.
class Preprocessor {
 public:
  Preprocessor(const Sources& sources, Prepared& result);

  /// The text without directives and macros. Texts are read in their order. Throws Stop.
  std::vector<Token> run(std::uint32_t text, std::span<const Token> tokens);

  /// Says that the text's scope declares this name: a macro of an import does not replace it any more.
  void declare(const Token& name);

 private:
  using Tokens = std::vector<Token>;
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  struct Element {
    Token token;
    std::size_t parameter = none;  ///< that stands here
    bool pastes = false;           ///< `##` follows
    friend bool operator==(const Element& a, const Element& b) {
      return a.token.word == b.token.word && a.parameter == b.parameter && a.pastes == b.pastes;
    }
  };
  struct Macro {
    Token name;
    bool is_function = false;
    std::vector<std::string_view> parameters;
    std::vector<Element> body;
    bool is_active = false;  ///< its expansion is being read
    bool means_the_same(const Macro& other) const {
      return is_function == other.is_function && parameters == other.parameters && body == other.body;
    }
  };
  /// What a name stands for in a scope.
  struct Meaning {
    Token place;
    std::size_t macro = none;  ///< none: a declared name
    bool is_own = false;       ///< defined in this scope, not in an import
    bool is_ambiguous = false;
    Token other;  ///< ambiguous: the second definition
  };
  struct Condition {
    Token token;
    bool is_live;     ///< what stands here counts
    bool is_decided;  ///< no branch that follows counts
    bool has_else = false;
  };
  /// Tokens that are being read: a text, an argument or condition on its own, or what a macro made.
  struct Frame {
    Tokens made;
    std::span<const Token> tokens;
    std::size_t next = 0;
    std::size_t macro = none;
    bool is_text = false;
  };
  void fault(Code code, const Token& token, std::string message, std::vector<FaultNote> notes = {});
  std::unordered_map<std::string_view, Meaning>& names() { return names_[sources_.texts[text_].scope]; }
  void see_imports(const SourceText& text);
  void see(std::uint32_t scope, std::uint32_t imported);
  bool is_same(const Meaning& a, const Meaning& b) const;

  // directives
  void directive(std::span<const Token> line);
  void skipped_directive(std::span<const Token> line);
  void condition(std::span<const Token> line);
  void begin_condition(std::span<const Token> line);
  void next_branch(std::span<const Token> line);
  bool asks_for_name(std::span<const Token> line);
  std::optional<bool> evaluate(std::span<const Token> line);
  void include(std::span<const Token> line);
  void define(std::span<const Token> line);
  std::optional<std::size_t> read_parameters(std::span<const Token> line, Macro& macro);
  bool read_body(std::span<const Token> body, Macro& macro);
  void undefine(std::span<const Token> line);
  void author_error(std::span<const Token> line);
  void pragma(std::span<const Token> line);
  bool is_free(const Token& name);
  bool ends_after(std::span<const Token> line, std::size_t size);
  bool is_skipping() const { return !open_.empty() && !open_.back().is_live; }

  // reading and expanding
  void push(Frame frame);
  const Token* front();
  Token take();
  void read_directives();
  void expand(Tokens& out, bool is_whole_text);
  Tokens expand_alone(std::span<const Token> tokens);
  bool replace(const Meaning& meaning, const Token& name);
  void read_defined(Tokens& out, const Token& word);
  std::vector<Tokens> read_arguments(const Macro& macro, const Token& name);
  Tokens substitute(std::size_t macro, const std::vector<Tokens>& arguments, const Token& use);
  Token paste(const Token& left, const Token& right, const Token& use);
  std::optional<Token> predefined(const Token& use);
  std::size_t line_of(const Token& token);

  const Sources& sources_;
  Prepared& result_;
  std::deque<Macro> macros_;
  std::vector<std::unordered_map<std::string_view, Meaning>> names_;  // of each scope
  std::vector<std::uint32_t> seen_imports_;                           // of each scope: how many its names hold
  std::uint32_t text_ = 0;
  std::vector<std::uint32_t> line_ends_;  // of the text; made when asked for
  std::vector<Condition> open_;
  std::vector<Frame> frames_;
  std::size_t work_ = 0;
  std::size_t depth_ = 0;  // of arguments within arguments
  bool in_condition_ = false;
};

}  // namespace dmvv::compiler::snippet
