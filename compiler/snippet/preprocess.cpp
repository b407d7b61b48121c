#include "compiler/snippet/preprocess.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "compiler/snippet/glsl_words.h"
#include "compiler/snippet/macros.h"
#include "compiler/snippet/names.h"

namespace dmvv::compiler::snippet {
namespace {

using Tokens = std::vector<Token>;

// ---- checks ----

using Names = std::unordered_set<std::string_view>;

/// The name of an entity of XML that came through as it is: "lt" of "&lt;". Empty if there is none.
std::string_view entity_at(const Tokens& tokens, std::size_t i) {
  if (!tokens[i].is("&") || i + 2 >= tokens.size() || tokens[i + 1].begin != tokens[i].end) return {};
  const Token& name = tokens[i + 1];
  const bool is_known = name.is("lt") || name.is("gt") || name.is("amp") || name.is("quot") || name.is("apos");
  const bool is_entity = is_known && tokens[i + 2].is(";") && tokens[i + 2].begin == name.end;
  return is_entity ? name.word : std::string_view();
}

/// Entities that are no operator before a name of the author.
void check_entities(const Tokens& tokens, Prepared& result) {
  Names names;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string_view entity = entity_at(tokens, i);
    if (entity.empty()) continue;
    if (names.empty()) {
      const std::vector<std::string_view> declared = declared_names(tokens);
      names.insert(declared.begin(), declared.end());
    }
    if (names.contains(entity)) continue;
    const std::string_view character = entity == "lt"     ? "'<'"
                                       : entity == "gt"   ? "'>'"
                                       : entity == "amp"  ? "'&'"
                                       : entity == "quot" ? "'\"'"
                                                          : "an apostrophe";
    Token token = tokens[i];
    token.end = tokens[i + 2].end;
    result.faults.push_back(
        {Code::snippet_syntax,
         token,
         fmt::format("'&{};' stands for {} outside of CDATA alone; here write {}", entity, character, character),
         {}});
    result.complete = false;
    return;
  }
}

/// Tokens that GLSL does not have.
void check_tokens(const Tokens& tokens, Prepared& result) {
  for (const Token& token : tokens) {
    if (token.kind != Token::Kind::other || is_operator(token.word)) continue;
    const std::string message = token.word.starts_with("/*") ? "this comment is never closed by '*/'"
                                : token.is("##")             ? "'##' joins words within a macro alone"
                                : token.is("#")              ? "a directive stands on a line of its own"
                                : token.word.size() == 1 && (token.word[0] < ' ' || token.word[0] == 127)
                                    ? "a control character has no meaning in GLSL"
                                    : fmt::format("'{}' has no meaning in GLSL", token.word);
    result.faults.push_back({Code::snippet_syntax, token, message, {}});
    result.complete = false;
  }
}

std::string_view closing_of(std::string_view opening) { return opening == "(" ? ")" : opening == "[" ? "]" : "}"; }

/// Every bracket closes the one it should, within the text: a body cannot end early, and no fault moves to another
/// text.
void check_brackets(const Tokens& tokens, Prepared& result) {
  const auto fault = [&](const Token& token, std::string message) {
    result.faults.push_back({Code::snippet_syntax, token, std::move(message), {}});
    result.complete = false;
  };
  Tokens open;
  for (const Token& token : tokens) {
    if (token.is("(") || token.is("[") || token.is("{")) {
      open.push_back(token);
      if (open.size() > max_brackets) {
        return fault(token, fmt::format("brackets are nested more than {} deep", max_brackets));
      }
    } else if (token.is(")") || token.is("]") || token.is("}")) {
      if (open.empty()) return fault(token, fmt::format("'{}' closes nothing", token.word));
      if (closing_of(open.back().word) != token.word) {
        return fault(token, fmt::format("'{}' does not close '{}', which is open", token.word, open.back().word));
      }
      open.pop_back();
    }
  }
  if (!open.empty()) {
    fault(open.back(), fmt::format("'{}' is never closed by '{}'", open.back().word, closing_of(open.back().word)));
  }
}

/// How deep the recursive parts of a compiler go in a text: bounds of the nesting of expressions and of statements.
class Depth {
 public:
  /// Takes the next token; what is too deep there, empty if nothing.
  std::string take(const Token* before, const Token& token, const Token* next) {
    if (token.is("(") || token.is("[") || token.is("{")) {
      open_.push_back({operators_, statements_, token.is("{"), is_list(before, token)});
    } else if (token.is(")") || token.is("]") || token.is("}")) {
      operators_ = open_.back().operators + 1;
      if (token.is("}")) end_statement(open_.back().statements, next);
      open_.pop_back();
    } else if (token.is(";")) {
      if (open_.empty() || open_.back().is_block) end_statement(open_.empty() ? 0 : open_.back().statements, next);
    } else if (token.is(",") && !open_.empty() && open_.back().is_list) {
      operators_ = open_.back().operators;
    } else if (token.kind == Token::Kind::other) {
      ++operators_;
    } else if (nests(before, token)) {
      ++statements_;
    }
    if (operators_ > max_operators) {
      return fmt::format("this expression has more than {} operators that may nest; compute parts of it before",
                         max_operators);
    }
    if (statements_ > max_chain) {
      return fmt::format("more than {} 'if', 'else' and loops are nested here", max_chain);
    }
    return {};
  }

 private:
  struct Open {
    std::size_t operators, statements;
    bool is_block, is_list;
  };

  /// Whether the commas in this bracket separate values: of a call, an initialiser, an array.
  static bool is_list(const Token* before, const Token& bracket) {
    if (bracket.is("{")) return true;
    return before != nullptr && (before->is_identifier() || before->is("]"));
  }

  static bool nests(const Token* before, const Token& token) {
    const bool goes_on = before != nullptr && before->is("else") && token.is("if");
    return !goes_on && (token.is("if") || token.is("else") || token.is("for") || token.is("while") || token.is("do"));
  }

  void end_statement(std::size_t statements, const Token* next) {
    operators_ = open_.empty() ? 0 : open_.back().operators;
    if (next == nullptr || !next->is("else")) statements_ = statements;
  }

  std::vector<Open> open_;
  std::size_t operators_ = 0;
  std::size_t statements_ = 0;
};

void check_depth(const Tokens& tokens, Prepared& result) {
  Depth depth;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token* const before = i > 0 ? &tokens[i - 1] : nullptr;
    const Token* const next = i + 1 < tokens.size() ? &tokens[i + 1] : nullptr;
    std::string message = depth.take(before, tokens[i], next);
    if (message.empty()) continue;
    result.faults.push_back({Code::snippet_syntax, tokens[i], std::move(message), {}});
    result.complete = false;
    return;
  }
}

// ---- names ----

/// Which names the author has taken, text by text: a word of GLSL's surroundings or of Cg may be his own.
class TakenNames {
 public:
  TakenNames(const Sources& sources, const Visibility& sees, const Prepared& prepared)
      : sources_(sources), sees_(sees) {
    for (std::size_t i = 0; i < prepared.texts.size(); ++i) {
      const Tokens& tokens = prepared.texts[i].tokens;
      const std::vector<std::string_view> names = declared_names(tokens);
      of_text_.emplace_back(names.begin(), names.end());
      for (const Declaration& declaration : prepared.texts[i].declarations) {
        std::vector<std::uint32_t>& scopes = scopes_[tokens[declaration.name].word];
        if (scopes.empty() || scopes.back() != sources.texts[i].scope) scopes.push_back(sources.texts[i].scope);
      }
    }
  }

  bool contains(std::string_view word, std::size_t text) const {
    if (of_text_[text].contains(word)) return true;
    const auto found = scopes_.find(word);
    return found != scopes_.end() && std::any_of(found->second.begin(), found->second.end(), [&](std::uint32_t scope) {
             return sees_(sources_.texts[text].scope, scope);
           });
  }

 private:
  const Sources& sources_;
  const Visibility& sees_;
  std::vector<Names> of_text_;
  std::unordered_map<std::string_view, std::vector<std::uint32_t>> scopes_;
};

/// Words that cannot be names, each once.
void check_reserved(const Tokens& tokens, Prepared& result) {
  Names known;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string_view word = tokens[i].word;
    if (!tokens[i].is_identifier() || (i > 0 && tokens[i - 1].is(".")) || !is_reserved(word)) continue;
    const bool has_use = is_type(word) || is_keyword(word) || !legacy_spelling(word).empty() ||
                         !why_refused(word, false).empty();  // as what it is
    const bool follows_fault = i > 0 && known.contains(tokens[i - 1].word);
    if (follows_fault || (has_use && !is_declaration(tokens, i)) || !known.insert(word).second) continue;
    result.faults.push_back({Code::snippet_syntax, tokens[i], reserved_sentence(word), {}});
    result.complete = false;
  }
}

void check_refused(const Tokens& tokens, bool is_body, const TakenNames& taken, Prepared& result) {
  std::size_t depth = 0;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& token = tokens[i];
    if (token.is("(") || token.is("{")) ++depth;
    if (token.is(")") || token.is("}")) --depth;
    if (!token.is_identifier() || (i > 0 && tokens[i - 1].is("."))) continue;
    std::string_view why = why_refused(token.word, i + 1 < tokens.size() && tokens[i + 1].is("("));
    if (why.empty() && depth == 0 && !is_body) why = why_refused_globally(token.word);
    if (why.empty() || taken.contains(token.word, token.text)) continue;
    result.faults.push_back({Code::snippet_refused, token, fmt::format("'{}' {}", token.word, why), {}});
  }
}

// ---- Cg ----

void respell(Tokens& tokens, const TakenNames& taken, Prepared& result) {
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    Token& token = tokens[i];
    if (token.kind == Token::Kind::number && (token.word.ends_with('h') || token.word.ends_with('H'))) {
      token.word.remove_suffix(1);  // 0.5h: a half
    }
    if (!token.is_identifier()) continue;
    const bool is_field = i > 0 && tokens[i - 1].is(".");
    if (is_vulkan_word(token.word) && (is_field || taken.contains(token.word, token.text))) {
      token.word = result.pool->keep(fmt::format("dmvv_0_{}", token.word));
    }
    if (is_field) continue;
    if (token.is("static") || token.is("inline")) token.word = "";
    const std::string_view spelling = legacy_spelling(token.word);
    if (spelling.empty() || taken.contains(token.word, token.text)) continue;
    token.word = spelling;
    result.uses_legacy_functions |= spelling.starts_with("dmvv_");
  }
}

/// Directives, macros, brackets, limits. False where what follows would be read wrongly.
bool read_text(const Sources& sources, std::uint32_t text, Preprocessor& preprocessor, Prepared& result) {
  const Tokens raw = tokenize(sources.texts[text].glsl, text, *result.pool);
  Tokens& tokens = result.texts.emplace_back().tokens;
  tokens = preprocessor.run(text, raw);
  if (!result.complete) return false;
  check_entities(tokens, result);
  if (result.complete) check_tokens(tokens, result);
  if (result.complete) check_brackets(tokens, result);
  if (result.complete) check_depth(tokens, result);
  if (result.complete) check_reserved(tokens, result);
  if (!result.complete || text + 1 == sources.texts.size()) return result.complete;
  result.texts.back().declarations = global_declarations(tokens);
  for (const Declaration& declaration : result.texts.back().declarations)
    preprocessor.declare(tokens[declaration.name]);
  return true;
}

void read_texts(const Sources& sources, Prepared& result) {
  Preprocessor preprocessor(sources, result);
  const Visibility sees(sources);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < sources.texts.size(); ++i) {
    if (!read_text(sources, i, preprocessor, result)) continue;
    const Tokens& tokens = result.texts.back().tokens;
    count += tokens.size();
    if (count > max_tokens)
      throw Stop{tokens.back(), fmt::format("the text has more than {} tokens up to here", max_tokens)};
  }
  if (!result.complete) return;
  const TakenNames taken(sources, sees, result);
  for (std::size_t i = 0; i < sources.texts.size(); ++i) {
    check_refused(result.texts[i].tokens, i + 1 == sources.texts.size(), taken, result);
    respell(result.texts[i].tokens, taken, result);
  }
  settle_names(sources, sees, result);
}

}  // namespace

bool is_declaration(std::span<const Token> tokens, std::size_t i) {
  if (i == 0 || !tokens[i].is_identifier()) return false;
  std::size_t type = i - 1;
  std::size_t steps = 0;                      // an array's size is short
  while (type > 0 && tokens[type].is("]")) {  // float[3] a
    while (type > 0 && !tokens[type].is("[") && ++steps < max_brackets) --type;
    if (type > 0) --type;
  }
  const Token& before = tokens[type];
  if (before.is("struct") || is_type(before.word)) return true;
  return before.is_identifier() && !is_keyword(before.word) && why_refused(before.word, false).empty();
}

std::vector<std::string_view> declared_names(std::span<const Token> tokens) {
  std::vector<std::string_view> names;
  for (std::size_t i = 1; i < tokens.size(); ++i) {
    const bool follows_comma = tokens[i - 1].is(",") && i + 1 < tokens.size() && tokens[i].is_identifier() &&
                               (tokens[i + 1].is("=") || tokens[i + 1].is(";"));
    if (follows_comma || is_declaration(tokens, i)) names.push_back(tokens[i].author);
  }
  return names;
}

Prepared prepare(const Sources& sources) {
  Prepared result;
  try {
    read_texts(sources, result);
  } catch (const Stop& stop) {
    result.faults.push_back({Code::snippet_syntax, stop.token, stop.message, {}});
    result.complete = false;
  }
  return result;
}

}  // namespace dmvv::compiler::snippet
