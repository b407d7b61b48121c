#include "compiler/snippet/macros.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "compiler/snippet/condition.h"
#include "compiler/snippet/glsl_words.h"

namespace dmvv::compiler::snippet {
namespace {

constexpr std::size_t max_work = 2 * max_tokens;  ///< tokens that may be read and made on the way
constexpr std::size_t max_word = 1024;            ///< bytes of a word, as glslang has it
constexpr std::size_t max_arguments_nested = 60;

constexpr std::array<std::string_view, 14> directives = {"define",  "undef",     "if",    "ifdef",  "ifndef",
                                                         "elif",    "else",      "endif", "error",  "pragma",
                                                         "version", "extension", "line",  "include"};

bool is_condition(std::string_view name) {
  return name == "if" || name == "ifdef" || name == "ifndef" || name == "elif" || name == "else" || name == "endif";
}

bool is_predefined(std::string_view name) {
  return name == "__LINE__" || name == "__FILE__" || name == "__VERSION__" || name == "GL_core_profile" ||
         name == "GL_FRAGMENT_PRECISION_HIGH";
}

std::string unknown_directive(std::string_view name) {
  const auto near = nearest_name(name, {directives.begin(), directives.end()});
  std::string message = fmt::format("'#{}' is no directive", name);
  if (name == "elseif" || name == "elsif") return message + "; did you mean '#elif'?";
  if (name == "elifdef" || name == "elifndef") {
    return fmt::format("{}; write '#elif {}defined(NAME)'", message, name == "elifdef" ? "" : "!");
  }
  return near ? fmt::format("{}; did you mean '#{}'?", message, *near) : message;
}

}  // namespace

Preprocessor::Preprocessor(const Sources& sources, Prepared& result)
    : sources_(sources), result_(result), names_(sources.imports.size()), seen_imports_(sources.imports.size()) {}

void Preprocessor::fault(Code code, const Token& token, std::string message, std::vector<FaultNote> notes) {
  result_.faults.push_back({code, token, std::move(message), std::move(notes)});
  result_.complete = false;
}

std::vector<Token> Preprocessor::run(std::uint32_t text, std::span<const Token> tokens) {
  text_ = text;
  line_ends_.clear();
  see_imports(sources_.texts[text]);
  Tokens out;
  push({{}, tokens, 0, none, true});
  expand(out, true);
  frames_.pop_back();
  for (const Condition& condition : open_) {
    fault(Code::snippet_syntax, condition.token, fmt::format("this #{} has no #endif", condition.token.word));
  }
  open_.clear();
  return out;
}

// ---- what names stand for ----

void Preprocessor::declare(const Token& name) {
  Meaning& meaning = names_[sources_.texts[name.text].scope][name.author];
  if (!meaning.is_own) meaning = {name, none, true, false, {}};
}

void Preprocessor::see_imports(const SourceText& text) {
  const std::vector<std::uint32_t>& imports = sources_.imports[text.scope];
  std::uint32_t& seen = seen_imports_[text.scope];
  for (; seen < text.imports; ++seen) see(text.scope, imports[seen]);
}

bool Preprocessor::is_same(const Meaning& a, const Meaning& b) const {
  if (a.macro == none || b.macro == none) return a.macro == b.macro;  // declared names: names.h looks after them
  return a.macro == b.macro || macros_[a.macro].means_the_same(macros_[b.macro]);
}

/// An import without texts has seen nothing yet, and may import others.
void Preprocessor::see(std::uint32_t scope, std::uint32_t imported) {
  see_imports({{}, imported, static_cast<std::uint32_t>(sources_.imports[imported].size())});
  for (const auto& [name, meaning] : names_[imported]) {
    if (++work_ > max_work) throw Stop{meaning.place, "the files that import each other hold too many names"};
    const auto [known, is_new] = names_[scope].try_emplace(name, meaning);
    if (is_new) {
      known->second.is_own = false;
    } else if (Meaning& own = known->second; !own.is_own && !own.is_ambiguous && !is_same(own, meaning)) {
      own.is_ambiguous = true;
      own.other = meaning.place;
    }
  }
}

// ---- directives ----

void Preprocessor::directive(std::span<const Token> line) {
  if (line.size() == 1) return;  // a lone '#' is allowed
  const std::string_view name = line[1].word;
  if (is_condition(name)) return condition(line);
  if (is_skipping()) return skipped_directive(line);
  if (name == "include") return include(line);
  if (name == "define") return define(line);
  if (name == "undef") return undefine(line);
  if (name == "error") return author_error(line);
  if (name == "pragma") return pragma(line);
  if (name == "version") {
    return fault(
        Code::snippet_refused, line[1],
        "'#version' belongs at the top of a whole shader; the functions of a scene are GLSL 4.60, leave this line out");
  }
  if (name == "extension") {
    return fault(
        Code::snippet_refused, line[1],
        "'#extension' is refused: a distance function is plain GLSL 4.60, the same on every device; leave this line "
        "out, and do without what it asks for");
  }
  if (name == "line") {
    return fault(Code::snippet_refused, line[1],
                 "'#line' is refused: mistakes are reported where they stand in this file; leave this line out");
  }
  fault(Code::snippet_syntax, line[1], unknown_directive(name));
}

/// Of what is skipped only conditions count. A word like theirs that is none would change what is skipped.
void Preprocessor::skipped_directive(std::span<const Token> line) {
  const std::string_view name = line[1].word;
  const bool is_known = std::find(directives.begin(), directives.end(), name) != directives.end();
  if (is_known) return;
  const auto near = nearest_name(name, {directives.begin(), directives.end()});
  if (name.starts_with("el") || (near && is_condition(*near))) {
    fault(Code::snippet_syntax, line[1], unknown_directive(name));
  }
}

/// Whether the directive ends with its first `size` tokens; if not, that is a fault.
bool Preprocessor::ends_after(std::span<const Token> line, std::size_t size) {
  if (line.size() <= size) return true;
  fault(Code::snippet_syntax, line[size],
        fmt::format("'#{}' ends before '{}'; what follows it stands on the next line", line[1].word, line[size].word));
  return false;
}

bool Preprocessor::asks_for_name(std::span<const Token> line) {
  if (line.size() < 3 || !line[2].is_identifier()) {
    fault(Code::snippet_syntax, line[std::min<std::size_t>(line.size() - 1, 2)],
          fmt::format("'#{}' needs the name of a macro", line[1].word));
    return false;
  }
  return ends_after(line, 3);
}

void Preprocessor::condition(std::span<const Token> line) {
  const std::string_view name = line[1].word;
  if (name == "if" || name == "ifdef" || name == "ifndef") return begin_condition(line);
  if (open_.empty()) {
    return fault(Code::snippet_syntax, line[1], fmt::format("there is no #if that this #{} could belong to", name));
  }
  if (name != "endif") return next_branch(line);
  if (ends_after(line, 2)) open_.pop_back();
}

void Preprocessor::begin_condition(std::span<const Token> line) {
  if (is_skipping()) return open_.push_back({line[1], false, true});
  std::optional<bool> holds;
  if (line[1].is("if")) {
    holds = evaluate(line);
  } else if (asks_for_name(line)) {
    const auto found = names().find(line[2].word);
    const bool is_macro = found != names().end() && (found->second.macro != none || found->second.is_ambiguous);
    holds = (is_macro || is_predefined(line[2].word)) == line[1].is("ifdef");
  }
  open_.push_back({line[1], holds.value_or(false), holds.value_or(true)});  // of an unknown condition no branch counts
}

void Preprocessor::next_branch(std::span<const Token> line) {
  Condition& condition = open_.back();
  if (condition.has_else) {
    return fault(Code::snippet_syntax, line[1],
                 fmt::format("this #{} stands behind the #else of its condition", line[1].word),
                 {{condition.token, "the condition begins here"}});
  }
  if (line[1].is("else")) {
    condition.has_else = true;
    if (!ends_after(line, 2)) condition.is_decided = true;
    condition.is_live = !condition.is_decided;
    condition.is_decided = true;
  } else if (condition.is_decided) {
    condition.is_live = false;
  } else {
    const std::optional<bool> holds = evaluate(line);
    open_.back().is_live = holds.value_or(false);
    open_.back().is_decided = holds.value_or(true);
  }
}

std::optional<bool> Preprocessor::evaluate(std::span<const Token> line) {
  if (line.size() == 2) {
    fault(Code::snippet_syntax, line[1], fmt::format("'#{}' needs a condition", line[1].word));
    return std::nullopt;
  }
  const std::size_t faults = result_.faults.size();
  in_condition_ = true;
  const Tokens tokens = expand_alone(line.subspan(2));
  in_condition_ = false;
  if (result_.faults.size() != faults) return std::nullopt;
  const auto value = evaluate_condition(tokens);
  if (const auto* number = std::get_if<std::int64_t>(&value)) return *number != 0;
  const auto& wrong = std::get<ConditionFault>(value);
  fault(Code::snippet_syntax, wrong.token != nullptr ? *wrong.token : line.back(), wrong.message);
  return std::nullopt;
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

void Preprocessor::author_error(std::span<const Token> line) {
  const std::string_view glsl = sources_.texts[text_].glsl;
  const std::string_view words =
      line.size() > 2 ? glsl.substr(line[2].begin, line.back().end - line[2].begin) : std::string_view("#error");
  fault(Code::snippet_author_error, line[line.size() > 2 ? 2 : 1], std::string(words));
}

/// Pragmas that ask for what is so anyway are obeyed.
void Preprocessor::pragma(std::span<const Token> line) {
  const auto is_word = [&](std::size_t i, std::string_view word) { return i < line.size() && line[i].is(word); };
  if (line.size() == 3 && is_word(2, "once")) return;  // a file is read once
  const bool is_hint = line.size() == 6 && (is_word(2, "optimize") || is_word(2, "debug")) && is_word(3, "(") &&
                       (is_word(4, "on") || is_word(4, "off")) && is_word(5, ")");
  if (is_hint) return;  // neither changes a value
  fault(Code::snippet_refused, line[std::min<std::size_t>(line.size() - 1, 2)],
        "this #pragma is not known, so it could not be obeyed; 'once', 'optimize(on)' and 'debug(on)' are (and 'off'): "
        "leave it out");
}

/// Whether a macro may have this name; if not, that is a fault.
bool Preprocessor::is_free(const Token& name) {
  if (!is_predefined(name.word) && !name.is("defined") && !name.word.starts_with("GL_")) return true;
  fault(Code::snippet_syntax, name, reserved_sentence(name.word));
  return false;
}

void Preprocessor::undefine(std::span<const Token> line) {
  if (asks_for_name(line) && is_free(line[2])) {
    const auto found = names().find(line[2].word);
    if (found != names().end() && (found->second.macro != none || found->second.is_ambiguous)) names().erase(found);
  }
}

void Preprocessor::define(std::span<const Token> line) {
  if (line.size() < 3 || !line[2].is_identifier()) {
    return fault(Code::snippet_syntax, line.back(), "#define needs a name");
  }
  if (!is_free(line[2])) return;
  Macro macro;
  macro.name = line[2];
  const auto body = read_parameters(line, macro);
  if (!body || !read_body(line.subspan(*body), macro)) return;
  Meaning& meaning = names()[line[2].word];
  if (meaning.is_own && meaning.macro != none) {
    if (macros_[meaning.macro].means_the_same(macro)) return;
    return fault(Code::snippet_syntax, line[2],
                 fmt::format("the macro '{0}' is defined twice, and not the same; '#undef {0}' before, or another name",
                             line[2].word),
                 {{meaning.place, "it is defined here"}});
  }
  meaning = {line[2], macros_.size(), true, false, {}};
  macros_.push_back(std::move(macro));
  result_.macros.push_back(line[2]);
}

/// Where the body begins. A '(' that touches the name opens parameters.
std::optional<std::size_t> Preprocessor::read_parameters(std::span<const Token> line, Macro& macro) {
  std::size_t i = 3;
  if (i == line.size() || !line[i].is("(") || line[i].begin != line[2].end) return i;
  macro.is_function = true;
  std::unordered_map<std::string_view, bool> known;
  for (++i; i < line.size() && !line[i].is(")"); ++i) {
    const bool wants_comma = !macro.parameters.empty();
    if (wants_comma && line[i].is(","))
      ++i;
    else if (wants_comma)
      break;
    if (i == line.size() || !line[i].is_identifier()) break;
    if (!known.emplace(line[i].word, true).second) {
      fault(Code::snippet_syntax, line[i], fmt::format("this macro has two parameters of the name '{}'", line[i].word));
      return std::nullopt;
    }
    macro.parameters.push_back(line[i].word);
  }
  if (i < line.size() && line[i].is(")") && !line[i - 1].is(",")) return i + 1;
  if (i < line.size()) {
    fault(Code::snippet_syntax, line[i],
          fmt::format("'{}' cannot stand among the parameters of a macro, which are names with ',' between them",
                      line[i].word));
  } else {
    fault(Code::snippet_syntax, line.back(), "the parameters of this macro are never closed by ')'");
  }
  return std::nullopt;
}

bool Preprocessor::read_body(std::span<const Token> body, Macro& macro) {
  std::unordered_map<std::string_view, std::size_t> parameters;
  for (std::size_t k = 0; k < macro.parameters.size(); ++k) parameters.emplace(macro.parameters[k], k);
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i].is("#")) {
      fault(Code::snippet_syntax, body[i], "GLSL has no strings, so '#' makes none of a macro's argument");
      return false;
    }
    if (body[i].is("##")) {
      if (i == 0 || i + 1 == body.size() || body[i + 1].is("##")) {
        fault(Code::snippet_syntax, body[i], "'##' joins two words, and stands between them");
        return false;
      }
      macro.body.back().pastes = true;
      continue;
    }
    const auto parameter = parameters.find(body[i].word);
    macro.body.push_back({body[i], parameter == parameters.end() ? none : parameter->second, false});
  }
  return true;
}

// ---- reading ----

void Preprocessor::push(Frame frame) {
  if (frame.macro != none) {
    macros_[frame.macro].is_active = true;
    work_ += frame.made.size();
    frames_.push_back(std::move(frame));
    frames_.back().tokens = frames_.back().made;
  } else {
    frames_.push_back(std::move(frame));
  }
}

/// Obeys the directives that stand next in a text, and passes over what is skipped.
void Preprocessor::read_directives() {
  const std::size_t at = frames_.size() - 1;
  const std::span<const Token> tokens = frames_[at].tokens;
  for (std::size_t& i = frames_[at].next; i < tokens.size();) {
    const bool starts_line = i == 0 || tokens[i - 1].line != tokens[i].line;
    if (tokens[i].is("#") && starts_line) {
      const std::size_t begin = i;
      while (frames_[at].next < tokens.size() && tokens[frames_[at].next].line == tokens[begin].line)
        ++frames_[at].next;
      directive(tokens.subspan(begin, frames_[at].next - begin));
      return;  // a condition may have moved the frames
    }
    if (!is_skipping()) return;
    ++i;
  }
}

/// The next token; null at the end of a text, or of what is read on its own.
const Token* Preprocessor::front() {
  for (;;) {
    Frame& frame = frames_.back();
    if (frame.is_text) {
      const std::size_t before = frame.next;
      read_directives();
      if (frames_.back().next != before) continue;
    }
    if (frames_.back().next < frames_.back().tokens.size()) return &frames_.back().tokens[frames_.back().next];
    if (frames_.back().macro == none) return nullptr;
    macros_[frames_.back().macro].is_active = false;
    frames_.pop_back();
  }
}

Token Preprocessor::take() {
  ++work_;
  Token token = frames_.back().tokens[frames_.back().next++];
  if (token.is_identifier() && !token.is_final) {
    const auto found = names().find(token.word);
    token.is_final = found != names().end() && found->second.macro != none && macros_[found->second.macro].is_active;
  }
  return token;
}

// ---- expanding ----

/// Everything up to the end of the frame on top, expanded.
void Preprocessor::expand(Tokens& out, bool is_whole_text) {
  std::size_t open = 0;
  while (front() != nullptr) {
    const Token token = take();
    if (work_ > max_work || out.size() >= max_tokens) {
      throw Stop{token,
                 fmt::format("the text is too long here: with its macros it has more than {} tokens", max_tokens)};
    }
    if (token.is("(") || token.is("{")) ++open;
    if (open > 0 && (token.is(")") || token.is("}"))) --open;
    out.push_back(token);
    if (!token.is_identifier() || token.is_final) continue;
    if (in_condition_ && token.is("defined")) {
      out.pop_back();
      read_defined(out, token);
      continue;
    }
    if (const auto value = predefined(token)) {
      out.back() = *value;
      continue;
    }
    const auto found = names().find(token.word);
    if (found == names().end() || (found->second.macro == none && !found->second.is_ambiguous)) continue;
    const bool declares = is_whole_text && open == 0 && !found->second.is_own && is_declaration(out, out.size() - 1);
    if (declares) {
      declare(token);  // the file's own name, not the macro of an import
      continue;
    }
    if (replace(found->second, token)) out.pop_back();
  }
}

/// What stands in a condition or is an argument, on its own.
std::vector<Token> Preprocessor::expand_alone(std::span<const Token> tokens) {
  if (++depth_ > max_arguments_nested) {
    throw Stop{tokens.front(), fmt::format("arguments of macros are nested more than {} deep", max_arguments_nested)};
  }
  Tokens out;
  push({{}, tokens, 0, none, false});
  expand(out, false);
  frames_.pop_back();
  --depth_;
  return out;
}

/// Puts what the macro makes in front of what is read next. False where it is only a name: without its '('.
bool Preprocessor::replace(const Meaning& meaning, const Token& name) {
  if (meaning.is_ambiguous) {
    fault(
        Code::snippet_ambiguous_name, name,
        fmt::format(
            "'{0}' means different things in the files that are imported here, at least once a macro; '#undef {0}' or "
            "define it here, or give one another name",
            name.author),
        {{meaning.place, "it is defined here"}, {meaning.other, "and here"}});
    return false;
  }
  const std::size_t id = meaning.macro;
  std::vector<Tokens> arguments;
  if (macros_[id].is_function) {
    const Token* const next = front();
    if (next == nullptr || !next->is("(")) return false;
    take();
    arguments = read_arguments(macros_[id], name);
  }
  Tokens made = substitute(id, arguments, name);
  push({std::move(made), {}, 0, id, false});
  return true;
}

/// `defined NAME` or `defined(NAME)`, whose name no macro replaces.
void Preprocessor::read_defined(Tokens& out, const Token& word) {
  const auto next = [&] { return front() != nullptr ? take() : Token{}; };
  Token name = next();
  const bool has_bracket = name.is("(");
  if (has_bracket) name = next();
  if (!name.is_identifier() || (has_bracket && !next().is(")"))) {
    fault(Code::snippet_syntax, word, "'defined' needs the name of a macro: 'defined(NAME)'");
    return;
  }
  const auto found = names().find(name.word);
  const bool is_macro = found != names().end() && (found->second.macro != none || found->second.is_ambiguous);
  Token value = word;
  value.kind = Token::Kind::number;
  value.word = is_macro || is_predefined(name.word) ? "1" : "0";
  out.push_back(value);
}

std::vector<std::vector<Token>> Preprocessor::read_arguments(const Macro& macro, const Token& name) {
  std::vector<Tokens> arguments(1);
  for (std::size_t open = 0;;) {
    if (front() == nullptr)
      throw Stop{name, fmt::format("the arguments of the macro '{}' are never closed by ')'", name.word)};
    const Token token = take();
    if (open == 0 && token.is(")")) break;
    if (token.is("(")) ++open;
    if (token.is(")")) --open;
    if (open == 0 && token.is(",")) {
      arguments.emplace_back();
    } else {
      arguments.back().push_back(token);
    }
  }
  if (macro.parameters.empty() && arguments.size() == 1 && arguments[0].empty()) arguments.clear();
  if (arguments.size() != macro.parameters.size()) {
    throw Stop{name, fmt::format("the macro '{}' takes {} argument{}, but gets {}", name.word, macro.parameters.size(),
                                 macro.parameters.size() == 1 ? "" : "s", arguments.size())};
  }
  return arguments;
}

/// What the macro makes. An argument is expanded before, unless `##` takes it as it is.
std::vector<Token> Preprocessor::substitute(std::size_t id, const std::vector<Tokens>& arguments, const Token& use) {
  const Macro& macro = macros_[id];
  std::vector<std::optional<Tokens>> expanded(arguments.size());
  Tokens result;
  bool pastes = false, has_left = false;
  for (const Element& element : macro.body) {
    Token own = element.token;
    own.text = use.text, own.begin = use.begin, own.end = use.end, own.line = use.line;
    own.macro = static_cast<std::uint32_t>(id) + 1;
    std::span<const Token> piece(&own, 1);
    if (element.parameter != none) {
      const Tokens& argument = arguments[element.parameter];
      piece = argument;
      if (!pastes && !element.pastes && !argument.empty()) {
        std::optional<Tokens>& whole = expanded[element.parameter];
        if (!whole) whole = expand_alone(argument);
        piece = *whole;
      }
    }
    const bool joins = pastes && has_left && !piece.empty();
    if (joins) {
      result.back() = paste(result.back(), piece.front(), use);
      piece = piece.subspan(1);
    }
    has_left = joins || !piece.empty() || (pastes && has_left);
    result.insert(result.end(), piece.begin(), piece.end());
    pastes = element.pastes;
    if (work_ + result.size() > max_work)
      throw Stop{use, fmt::format("this macro makes more than {} tokens", max_tokens)};
  }
  return result;
}

Token Preprocessor::paste(const Token& left, const Token& right, const Token& use) {
  if (left.word.size() + right.word.size() > max_word) {
    throw Stop{use, fmt::format("'##' makes a word of more than {} bytes here", max_word)};
  }
  const std::string_view word = result_.pool->keep(std::string(left.word) + std::string(right.word));
  const Tokens tokens = tokenize(word, use.text, *result_.pool);
  if (tokens.size() != 1 || (tokens[0].kind == Token::Kind::other && !is_operator(word))) {
    throw Stop{use, fmt::format("'##' makes '{}' here, which is no single word of GLSL", word)};
  }
  Token token = left;
  token.kind = tokens[0].kind;
  token.word = token.author = word;
  token.text = use.text, token.begin = use.begin, token.end = use.end, token.line = use.line;
  token.is_final = false;
  return token;
}

/// The value of a macro that GLSL defines.
std::optional<Token> Preprocessor::predefined(const Token& use) {
  if (!is_predefined(use.word)) return std::nullopt;
  Token value = use;
  value.kind = Token::Kind::number;
  if (use.is("__LINE__")) {
    value.word = result_.pool->keep(std::to_string(line_of(use)));
  } else if (use.is("__FILE__")) {
    value.word = result_.pool->keep(std::to_string(use.text));
  } else {
    value.word = use.is("__VERSION__") ? "460" : "1";
  }
  return value;
}

/// From 1, in its text.
std::size_t Preprocessor::line_of(const Token& token) {
  const std::string_view glsl = sources_.texts[text_].glsl;
  if (line_ends_.empty()) {
    line_ends_.push_back(0);
    for (std::size_t i = 0; i < glsl.size(); ++i) {
      if (glsl[i] == '\n') line_ends_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  const auto after = std::lower_bound(line_ends_.begin() + 1, line_ends_.end(), token.begin);
  return static_cast<std::size_t>(after - line_ends_.begin());
}

}  // namespace dmvv::compiler::snippet
