#include "compiler/snippet/preprocess.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "compiler/snippet/glsl_words.h"

namespace dmvv::compiler::snippet {
namespace {

using Tokens = std::vector<Token>;

// ---- directives and macros ----

struct Macro {
  bool is_function = false;
  std::vector<std::string_view> parameters;
  Tokens body;
};

/// Thrown where a macro makes too much of a text; prepare turns it into a fault.
struct TooLarge {
  Token token;
  std::string message;
};

class Preprocessor {
 public:
  explicit Preprocessor(Prepared& result) : result_(result) {}

  /// One text without directives and macros.
  Tokens run(std::span<const Token> tokens);

 private:
  using Names = std::vector<std::string_view>;

  void fault(Code code, const Token& token, std::string message) {
    result_.faults.push_back({code, token, std::move(message)});
  }
  void directive(std::span<const Token> line);
  void include(std::span<const Token> line);
  void define(std::span<const Token> line);
  void condition(std::span<const Token> line);
  bool is_skipping() const {
    return std::any_of(open_.begin(), open_.end(), [](const Condition& c) { return !c.taken; });
  }

  void expand(std::span<const Token> tokens, Tokens& out, Names& active);
  std::size_t expand_call(const Macro& macro, std::span<const Token> tokens, std::size_t at, Tokens& out,
                          Names& active);
  Tokens substitute(const Macro& macro, const std::vector<Tokens>& arguments, const Token& use) const;

  struct Condition {
    Token token;
    bool taken;
    bool seen_else = false;
  };

  Prepared& result_;
  std::map<std::string_view, Macro> macros_;
  std::vector<Condition> open_;
  std::size_t work_ = 0;
};

Tokens Preprocessor::run(std::span<const Token> tokens) {
  Tokens out;
  Names active;
  for (std::size_t i = 0; i < tokens.size();) {
    const bool starts_line = i == 0 || tokens[i - 1].line != tokens[i].line;
    std::size_t end = i + 1;
    if (tokens[i].is("#") && starts_line) {
      while (end < tokens.size() && tokens[end].line == tokens[i].line) ++end;
      directive(tokens.subspan(i, end - i));
    } else {
      while (end < tokens.size() && (!tokens[end].is("#") || tokens[end - 1].line == tokens[end].line)) ++end;
      if (!is_skipping()) expand(tokens.subspan(i, end - i), out, active);
    }
    i = end;
  }
  for (const Condition& condition : open_) fault(Code::snippet_syntax, condition.token, "this condition has no #endif");
  open_.clear();
  return out;
}

void Preprocessor::directive(std::span<const Token> line) {
  if (line.size() == 1) return;  // a lone '#' is allowed
  const std::string_view name = line[1].word;
  if (name == "ifdef" || name == "ifndef" || name == "else" || name == "endif") return condition(line);
  if (is_skipping()) return;
  if (name == "include") return include(line);
  if (name == "define") return define(line);
  if (name == "undef" && line.size() == 3) {
    macros_.erase(line[2].word);
    return;
  }
  fault(Code::snippet_refused, line[1],
        fmt::format("'#{}' is not available in a function; #include <sdf>, #define, #undef, #ifdef, #ifndef, #else and "
                    "#endif are",
                    name));
}

void Preprocessor::include(std::span<const Token> line) {
  if (line.size() == 5 && line[2].is("<") && line[3].is("sdf") && line[4].is(">")) {
    result_.uses_library = true;
    return;
  }
  fault(Code::snippet_refused, line.size() > 3 ? line[3] : line[1],
        "only the library can be included, by #include <sdf>; functions of your own stand in FUNCTIONS, also of a file "
        "that IMPORT names");
}

void Preprocessor::define(std::span<const Token> line) {
  if (line.size() < 3 || !line[2].is_identifier()) {
    fault(Code::snippet_syntax, line.back(), "#define needs a name");
    return;
  }
  Macro macro;
  std::size_t i = 3;
  if (i < line.size() && line[i].is("(") && line[i].begin == line[2].end) {
    macro.is_function = true;
    for (++i; i < line.size() && !line[i].is(")"); ++i) {
      if (line[i].is_identifier()) macro.parameters.push_back(line[i].word);
    }
    if (i == line.size()) {
      fault(Code::snippet_syntax, line.back(), "the parameters of this macro are never closed by ')'");
      return;
    }
    ++i;
  }
  macro.body.assign(line.begin() + static_cast<std::ptrdiff_t>(i), line.end());
  macros_[line[2].word] = std::move(macro);
}

void Preprocessor::condition(std::span<const Token> line) {
  const std::string_view name = line[1].word;
  if (name == "ifdef" || name == "ifndef") {
    const bool defined = line.size() > 2 && macros_.contains(line[2].word);
    open_.push_back({line[1], defined == (name == "ifdef")});
  } else if (open_.empty() || (name == "else" && open_.back().seen_else)) {
    fault(Code::snippet_syntax, line[1], fmt::format("there is no #ifdef that this #{} could belong to", name));
  } else if (name == "else") {
    open_.back().taken = !open_.back().taken;
    open_.back().seen_else = true;
  } else {
    open_.pop_back();
  }
}

/// Macros are named in `active` while their own expansion is read: a macro never expands in itself.
void Preprocessor::expand(std::span<const Token> tokens, Tokens& out, Names& active) {
  constexpr std::size_t max_depth = 60;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& token = tokens[i];
    if (++work_ > 8 * max_tokens || out.size() > max_tokens || active.size() > max_depth) {
      throw TooLarge{token,
                     fmt::format("the text is too long here: with its macros it has more than {} tokens, or they "
                                 "are nested more than {} deep",
                                 max_tokens, max_depth)};
    }
    const auto found = token.is_identifier() ? macros_.find(token.word) : macros_.end();
    if (found == macros_.end() || std::find(active.begin(), active.end(), token.word) != active.end()) {
      out.push_back(token);
      continue;
    }
    const Macro macro = found->second;
    if (macro.is_function) {
      i = expand_call(macro, tokens, i, out, active);
      continue;
    }
    active.push_back(token.word);
    expand(substitute(macro, {}, token), out, active);
    active.pop_back();
  }
}

/// Reads the arguments of the macro named at `at` and expands it; the last token it used. Without '(' it is a name.
std::size_t Preprocessor::expand_call(const Macro& macro, std::span<const Token> tokens, std::size_t at, Tokens& out,
                                      Names& active) {
  const Token& name = tokens[at];
  if (at + 1 == tokens.size() || !tokens[at + 1].is("(")) {
    out.push_back(name);
    return at;
  }
  std::vector<Tokens> raw(1);
  std::size_t i = at + 2;
  for (std::size_t depth = 0; i < tokens.size() && (depth != 0 || !tokens[i].is(")")); ++i) {
    if (tokens[i].is("(")) ++depth;
    if (tokens[i].is(")")) --depth;
    if (depth == 0 && tokens[i].is(",")) {
      raw.emplace_back();
    } else {
      raw.back().push_back(tokens[i]);
    }
  }
  if (i == tokens.size()) throw TooLarge{name, "the arguments of this macro are never closed by ')'"};
  if (macro.parameters.empty() && raw.size() == 1 && raw[0].empty()) raw.clear();
  if (raw.size() != macro.parameters.size()) {
    throw TooLarge{name, fmt::format("the macro '{}' takes {} arguments, but gets {}", name.word,
                                     macro.parameters.size(), raw.size())};
  }
  active.push_back("");  // counts as depth, names nothing
  std::vector<Tokens> arguments(raw.size());
  for (std::size_t k = 0; k < raw.size(); ++k) expand(raw[k], arguments[k], active);
  active.back() = name.word;
  expand(substitute(macro, arguments, name), out, active);
  active.pop_back();
  return i;
}

Tokens Preprocessor::substitute(const Macro& macro, const std::vector<Tokens>& arguments, const Token& use) const {
  Tokens result;
  for (Token token : macro.body) {
    const auto parameter = std::find(macro.parameters.begin(), macro.parameters.end(), token.word);
    if (parameter != macro.parameters.end()) {
      const Tokens& argument = arguments[static_cast<std::size_t>(parameter - macro.parameters.begin())];
      result.insert(result.end(), argument.begin(), argument.end());
    } else {
      token.text = use.text;
      token.begin = use.begin;
      token.end = use.end;
      result.push_back(token);
    }
    if (result.size() > max_tokens)
      throw TooLarge{use, fmt::format("this macro makes more than {} tokens", max_tokens)};
  }
  return result;
}

// ---- checks ----

/// Tokens that GLSL does not have.
void check_tokens(const Tokens& tokens, Prepared& result) {
  for (const Token& token : tokens) {
    if (token.kind != Token::Kind::other || is_operator(token.word)) continue;
    const std::string message = token.word.starts_with("/*") ? "this comment is never closed by '*/'"
                                : token.is("#")              ? "a directive stands on a line of its own"
                                : token.word.size() == 1 && (token.word[0] < ' ' || token.word[0] == 127)
                                    ? "a control character has no meaning in GLSL"
                                    : fmt::format("'{}' has no meaning in GLSL", token.word);
    result.faults.push_back({Code::snippet_syntax, token, message});
    result.complete = false;
  }
}

std::string_view closing_of(std::string_view opening) { return opening == "(" ? ")" : opening == "[" ? "]" : "}"; }

/// Every bracket closes the one it should, within the text: a body cannot end early, and no fault moves to another
/// text.
void check_brackets(const Tokens& tokens, Prepared& result) {
  const auto fault = [&](const Token& token, std::string message) {
    result.faults.push_back({Code::snippet_syntax, token, std::move(message)});
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
    result.faults.push_back({Code::snippet_syntax, tokens[i], std::move(message)});
    result.complete = false;
    return;
  }
}

using Names = std::set<std::string_view>;

void check_refused(const Tokens& tokens, bool is_body, const Names& declared, Prepared& result) {
  std::size_t depth = 0;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& token = tokens[i];
    if (token.is("(") || token.is("{")) ++depth;
    if (token.is(")") || token.is("}")) --depth;
    if (!token.is_identifier() || (i > 0 && tokens[i - 1].is(".")) || declared.contains(token.word)) continue;
    std::string_view why = why_refused(token.word, i + 1 < tokens.size() && tokens[i + 1].is("("));
    if (why.empty() && depth == 0 && !is_body) why = why_refused_globally(token.word);
    if (!why.empty()) result.faults.push_back({Code::snippet_refused, token, fmt::format("'{}' {}", token.word, why)});
  }
}

// ---- Cg ----

void respell(Tokens& tokens, const Names& declared, Prepared& result) {
  std::erase_if(tokens, [](const Token& token) { return token.is("static") || token.is("inline"); });
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    Token& token = tokens[i];
    if (token.kind == Token::Kind::number && (token.word.ends_with('h') || token.word.ends_with('H'))) {
      token.word.remove_suffix(1);  // 0.5h: a half
    }
    if (token.is("main")) token.word = "dmvv_author_main";  // the entry point has that name
    if (!token.is_identifier() || declared.contains(token.word) || (i > 0 && tokens[i - 1].is("."))) continue;
    const std::string_view spelling = legacy_spelling(token.word);
    if (spelling.empty()) continue;
    token.word = spelling;
    result.uses_legacy_functions |= spelling.starts_with("dmvv_");
  }
}

}  // namespace

bool is_declaration(std::span<const Token> tokens, std::size_t i) {
  if (i == 0 || !tokens[i].is_identifier()) return false;
  std::size_t type = i - 1;
  while (type > 0 && tokens[type].is("]")) {  // float[3] a
    while (type > 0 && !tokens[type].is("[")) --type;
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

Prepared prepare(std::span<const std::string_view> texts) {
  Prepared result;
  Preprocessor preprocessor(result);
  Names declared;
  std::size_t count = 0;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const Tokens raw = tokenize(texts[i], static_cast<std::uint32_t>(i));
    result.texts.emplace_back();
    try {
      result.texts.back().tokens = preprocessor.run(raw);
    } catch (const TooLarge& fault) {
      result.faults.push_back({Code::snippet_syntax, fault.token, fault.message});
      result.complete = false;
      return result;
    }
    count += result.texts.back().tokens.size();
    if (count > max_tokens) {
      result.faults.push_back(
          {Code::snippet_syntax, raw.back(), fmt::format("the text has more than {} tokens up to here", max_tokens)});
      result.complete = false;
      return result;
    }
    for (const std::string_view name : declared_names(result.texts.back().tokens)) declared.insert(name);
  }
  for (std::size_t i = 0; i < texts.size(); ++i) {
    Tokens& tokens = result.texts[i].tokens;
    const std::size_t faults = result.faults.size();
    check_tokens(tokens, result);
    if (result.faults.size() == faults) check_brackets(tokens, result);
    if (result.faults.size() == faults) check_depth(tokens, result);
    if (result.faults.size() != faults) continue;
    check_refused(tokens, i + 1 == texts.size(), declared, result);
    respell(tokens, declared, result);
  }
  return result;
}

}  // namespace dmvv::compiler::snippet
