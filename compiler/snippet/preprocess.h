// Inside compiler/snippet: the author's texts -> tokens that are safe to give to glslang.
//
// Macros are expanded here, not by glslang: their size is bounded, and every token keeps its place.
#pragma once

#include <memory>
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

/// A text of a snippet, and where it stands.
struct SourceText {
  std::string_view glsl;
  std::uint32_t scope = 0;
  std::uint32_t imports = 0;  ///< how many of its scope's imports stand before it
};

/// The texts of a snippet, each behind those that it may use; the last is the body of a function, the others stand
/// outside of functions. A scope is a file, an object or the body: names and macros belong to the scope that defines
/// them, and are seen in those that import it, directly or through others.
struct Sources {
  std::vector<SourceText> texts;
  std::vector<std::vector<std::uint32_t>> imports;  ///< of each scope; without cycles
};

/// What else has to do with a fault.
struct FaultNote {
  Token token;
  std::string message;
};

/// What is wrong with a token.
struct Fault {
  Code code;
  Token token;
  std::string message;
  std::vector<FaultNote> notes;
};

/// A name that a text declares outside of functions. Tokens are given by their number in the text.
struct Declaration {
  enum class Kind : std::uint8_t { function, variable, type };
  struct Parameter {
    std::size_t begin, end;  ///< its tokens
    std::size_t name;        ///< the token that is its name; `end` if it has none
  };
  Kind kind = Kind::variable;
  std::size_t name = 0;
  // Of a function:
  std::size_t result = 0;  ///< where its result type begins, which ends before the name
  std::vector<Parameter> parameters;
  std::string signature;       ///< the types of its parameters, as the author wrote them
  bool is_definition = false;  ///< it has a body
};

/// One text, ready for glslang but for the faults found in it.
struct PreparedText {
  std::vector<Token> tokens;
  std::vector<Declaration> declarations;  ///< none of the last text
  std::string forwards;                   ///< GLSL of ours that stands before it (names.h)
};

/// A name that a scope sees in two imports, with different meanings. It is a fault only where it is used.
struct AmbiguousName {
  std::string_view word;  ///< that stands for it in the scope; nothing is called so
  Token first, second;    ///< where it is defined
};

struct Prepared {
  std::vector<PreparedText> texts;  ///< in the order given
  std::vector<Fault> faults;        ///< E0401, E0404, E0410, E0411
  bool complete = true;             ///< false: a fault makes everything that follows meaningless
  bool uses_library = false;        ///< #include <sdf>
  bool uses_legacy_functions = false;
  std::vector<AmbiguousName> ambiguous;
  std::vector<Token> macros;                                      ///< the name of each macro where it is defined
  std::shared_ptr<WordPool> pool = std::make_shared<WordPool>();  ///< words that stand in no text
};

/// Obeys directives, expands macros (macros.h), gives words of Cg their GLSL spelling, checks brackets and limits,
/// gives names that would clash names of their own (names.h), and refuses what a distance function cannot use. Words
/// that the author declares are left alone. Cost: linear in the tokens; macros may make at most max_tokens.
Prepared prepare(const Sources& sources);

/// The names that these tokens declare: functions, variables, types.
std::vector<std::string_view> declared_names(std::span<const Token> tokens);

/// Whether token i stands where its name is declared.
bool is_declaration(std::span<const Token> tokens, std::size_t i);

}  // namespace dmvv::compiler::snippet
