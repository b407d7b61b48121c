// A line of the log is a token of the author; of the errors in a statement the first counts, of unknown names each.
#include "compiler/snippet/report_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "compiler/snippet/built_ins.h"
#include "compiler/snippet/explain.h"
#include "compiler/snippet/glsl_words.h"
#include "compiler/snippet/library.h"
#include "compiler/snippet/names.h"
#include "compiler/snippet/report_functions.h"

namespace dmvv::compiler::snippet {

namespace {

/// Goes through a log once. What it reported decides what of the rest is a consequence.
class LogReport {
 public:
  LogReport(const Prepared& prepared, const Shader& shader, Definitions& definitions, Reporter& reporter)
      : prepared_(prepared), shader_(shader), definitions_(definitions), reporter_(reporter) {}

  void run(const std::vector<LogEntry>& log);

 private:
  void report_parsing(const LogEntry& entry);
  const Token* head_of_call(const Token* bracket) const;
  const Token* behind_next(const Token* token, std::string_view mark) const;
  const Token* culprit(const Token* token, const LogEntry& entry) const;

  void report_twice(const LogEntry& entry, const Line& line);
  void pass_over_body(std::size_t line);
  const Token* defined_before(const Token& token);

  void report_name(const LogEntry& entry, const Line& line, const Explanation& why);
  bool report_ambiguous(const Token& token);
  bool report_order(const Token& token);
  bool report_elsewhere(const Token& token, bool is_call);
  std::string prototype_of(const Token& name) const;
  std::vector<std::string_view> known_names(bool functions) const;
  bool is_known(std::string_view name) const;

  void be_doubtful(const Line& line);
  bool is_doubtful(std::uint32_t statement);

  const Prepared& prepared_;
  const Shader& shader_;
  Definitions& definitions_;
  Reporter& reporter_;
  mutable std::unordered_set<std::string_view> declared_;  // all names of all texts; made when asked for
  std::unordered_set<std::uint32_t> refused_;      // statements with something refused: glslang does not know it either
  std::unordered_set<std::uint32_t> faulty_;       // statements with an error: what else they bring is a consequence
  std::unordered_set<std::string_view> unknown_;   // names reported as such
  std::unordered_set<std::string_view> twice_;     // names reported as defined twice
  std::unordered_set<std::string_view> doubtful_;  // names whose type glslang had to guess
};

void LogReport::run(const std::vector<LogEntry>& log) {
  constexpr std::size_t most_reported = 100;
  std::set<std::pair<std::uint32_t, std::uint32_t>> places;
  for (const Fault& fault : prepared_.faults) places.emplace(fault.token.text, fault.token.begin);
  for (const Line& line : shader_.lines) {
    if (places.empty()) break;
    const bool is_author = line.token != nullptr && !line.behind;
    if (is_author && places.contains({line.token->text, line.token->begin})) refused_.insert(line.statement);
  }
  for (LogEntry entry : log) {
    if (reporter_.errors() >= most_reported) return;
    entry.word = author_word(entry.word);
    if (entry.line != 0) {
      report_parsing(entry);
    } else if (reporter_.errors() == 0) {
      report_linking(entry, prepared_, definitions_, reporter_);
    }
  }
}

/// glslang puts the errors of a call at its ')' or '('; the author looks for the name before it.
const Token* LogReport::head_of_call(const Token* bracket) const {
  const std::vector<Token>& tokens = prepared_.texts[bracket->text].tokens;
  auto i = static_cast<std::size_t>(bracket - tokens.data());
  for (std::size_t depth = 0; i > 0; --i) {
    if (tokens[i].is(")")) ++depth;
    if (tokens[i].is("(") && (depth == 0 || --depth == 0)) break;
  }
  if (i == 0) return bracket;
  --i;
  for (; i > 0 && tokens[i].is("]"); --i) {  // float[2](...)
    while (i > 0 && !tokens[i].is("[")) --i;
  }
  return tokens[i].is_identifier() ? &tokens[i] : bracket;
}

/// The token behind the next `mark` of the statement; `token` if there is none.
const Token* LogReport::behind_next(const Token* token, std::string_view mark) const {
  const std::vector<Token>& tokens = prepared_.texts[token->text].tokens;
  const Token* const end = tokens.data() + tokens.size();
  for (const Token* next = token; next + 1 < end && !next->is(";"); ++next) {
    if (next->is(mark)) return next + 1;
  }
  return token;
}

/// The token that an author would point at; glslang names brackets, and the variable in front of its value.
const Token* LogReport::culprit(const Token* token, const LogEntry& entry) const {
  if (entry.reason.find("syntax error") != std::string::npos) return token;
  if (token->is("(") || token->is(")")) return head_of_call(token);
  if (token->is("[")) return behind_next(token, "[");
  if (entry.reason.find("cannot convert from") != std::string::npos) return behind_next(token, "=");
  return token;
}

void LogReport::report_parsing(const LogEntry& entry) {
  Line line = entry.line <= shader_.lines.size() ? shader_.lines[entry.line - 1] : Line{};
  const bool is_syntax = entry.reason.find("syntax error") != std::string::npos;
  if (line.forwards || (refused_.contains(line.statement) && !is_syntax)) return;
  if (line.token != nullptr && !line.behind) line.token = culprit(line.token, entry);
  const bool never_returns = entry.reason.find("function does not return a value") != std::string::npos;
  if (never_returns && reporter_.errors() != 0) return;  // its `return` may be what is wrong
  if (line.token == nullptr) {                           // the head of the author's function, or text of ours
    reporter_.report(never_returns ? Code::snippet_return : Code::snippet_syntax, reporter_.body_words(),
                     explain(entry, {{}, true, false}).sentence);
    return;
  }
  const Explanation why = explain(entry, {line.token->author, reporter_.in_body(*line.token), line.behind});
  if (why.code == Code::snippet_unknown_name) return report_name(entry, line, why);
  if (faulty_.contains(line.statement) || is_doubtful(line.statement)) return;
  faulty_.insert(line.statement);
  const bool is_twice = entry.reason.find("redefinition") != std::string::npos ||
                        entry.reason.find("function already has a body") != std::string::npos ||
                        entry.reason.find("must have the same return type") != std::string::npos;
  if (is_twice && !line.behind) return report_twice(entry, line);
  if (!line.behind) return reporter_.report(why.code, *line.token, why.sentence);
  reporter_.report(why.code, reporter_.behind(*line.token), why.sentence);
}

// ---- names ----

/// Where a name that is declared again was declared before; null for what no text declares.
const Token* LogReport::defined_before(const Token& token) {
  const std::vector<Token>& tokens = prepared_.texts[token.text].tokens;
  std::size_t closed = 0;  // blocks that end before the token
  for (auto i = static_cast<std::size_t>(&token - tokens.data()); i-- > 0;) {
    if (tokens[i].is("}")) ++closed;
    if (tokens[i].is("{") && closed > 0) --closed;
    const bool follows_comma = i > 0 && tokens[i - 1].is(",") && !tokens[i + 1].is("(");
    if (closed == 0 && tokens[i].is(token.word) && (is_declaration(tokens, i) || follows_comma)) return &tokens[i];
  }
  const std::vector<const Token*>& found = definitions_.of(token.word);
  return found.empty() || found.front() == &token ? nullptr : found.front();
}

/// glslang goes on with another function than the one that it refuses: what it says of the body means nothing.
void LogReport::pass_over_body(std::size_t line) {
  const auto is = [&](std::string_view word) {
    const Line& at = shader_.lines[line];
    return at.token != nullptr && !at.behind && at.token->is(word);
  };
  for (std::size_t open = 0; line < shader_.lines.size(); ++line) {
    if (is("{")) ++open;
    if (is("}") && --open == 0) return;
    if (is(";") && open == 0) return;
    faulty_.insert(shader_.lines[line].statement);
  }
}

void LogReport::report_twice(const LogEntry& entry, const Line& line) {
  const Token& token = *line.token;
  const Token* const before = defined_before(token);
  doubtful_.insert(token.author);  // which of the two types a use has is a guess
  const std::vector<Token>& tokens = prepared_.texts[token.text].tokens;
  const bool is_function = &token + 1 < tokens.data() + tokens.size() && (&token + 1)->is("(");
  if (is_function) pass_over_body(entry.line - 1);
  if (token.kind == Token::Kind::identifier && !twice_.insert(token.word).second) return;
  if (before == nullptr && reporter_.in_body(token) && (token.is("p") || token.is("t"))) {
    return reporter_.report(
        Code::snippet_syntax, token,
        fmt::format("'{}' is what the function is given; assign to it, or take another name", token.author));
  }
  const bool other_type = entry.reason.find("must have the same return type") != std::string::npos;
  std::string message =
      other_type
          ? fmt::format("'{}' is defined before, with the same parameters and another type of result", token.author)
      : is_function ? fmt::format("the function '{}' is defined twice", token.author)
                    : fmt::format("'{}' is defined twice", token.author);
  message += "; take one away, or give it another name";
  std::vector<Note> notes;
  if (before != nullptr) notes.push_back({reporter_.span_of(*before), "it is defined here"});
  reporter_.report(Code::snippet_syntax, token, std::move(message), std::move(notes));
}

bool LogReport::report_ambiguous(const Token& token) {
  for (const AmbiguousName& name : prepared_.ambiguous) {
    if (name.word != token.word) continue;
    reporter_.report(
        Code::snippet_ambiguous_name, token,
        fmt::format(
            "'{}' is defined in two files that are imported here, and neither imports the other; define it here as "
            "well, or give one of them another name",
            token.author),
        {{reporter_.span_of(name.first), "it is defined here"}, {reporter_.span_of(name.second), "and here"}});
    return true;
  }
  return false;
}

/// The head of a function as its author wrote it: "float b(vec3 p)".
std::string LogReport::prototype_of(const Token& name) const {
  const Declaration& function = *definitions_.declaration_of(name);
  const std::vector<Token>& tokens = prepared_.texts[name.text].tokens;
  std::string head;
  for (std::size_t i = function.result; i < tokens.size() && !tokens[i].is("{"); ++i) {
    const bool joins = head.empty() || tokens[i].is("(") || tokens[i].is(")") || tokens[i].is(",") ||
                       tokens[i].is("[") || tokens[i].is("]") || tokens[i - 1].is("(") || tokens[i - 1].is("[");
    head += (joins ? "" : " ") + std::string(tokens[i].author);
  }
  return head;
}

/// What stands further down is not known yet.
bool LogReport::report_order(const Token& token) {
  const auto is_behind = [&](const Token* other) {
    return other->text > token.text || (other->text == token.text && other > &token);
  };
  const std::vector<const Token*>& definitions = definitions_.of(token.word);
  if (!definitions.empty() && std::all_of(definitions.begin(), definitions.end(), is_behind)) {
    const Token& first = *definitions.front();
    const bool is_function = definitions_.declaration_of(first)->kind == Declaration::Kind::function;
    reporter_.report(
        Code::snippet_unknown_name, token,
        is_function
            ? fmt::format(
                  "'{}' is defined further down, and a function stands before its use; move it up, or declare it "
                  "before: '{};'",
                  token.author, prototype_of(first))
            : fmt::format("'{}' is defined further down, and stands before its use in GLSL; move it up", token.author),
        {{reporter_.span_of(first), "it is defined here"}});
    return true;
  }
  for (const Token& macro : prepared_.macros) {
    const bool is_later = macro.text > token.text || (macro.text == token.text && macro.begin > token.begin);
    if (macro.word != token.word || !is_later) continue;
    reporter_.report(
        Code::snippet_unknown_name, token,
        fmt::format("the macro '{}' is defined further down, and holds from there on; move it up", token.author),
        {{reporter_.span_of(macro), "it is defined here"}});
    return true;
  }
  return false;
}

/// A name that is known, but not where the token stands.
bool LogReport::report_elsewhere(const Token& token, bool is_call) {
  if (!reporter_.in_body(token) && !is_call && (token.author == "t" || token.author == "p")) {
    reporter_.report(
        Code::snippet_unknown_name, token,
        fmt::format(
            "'{0}' is known in the text of an SDF alone; a function of FUNCTIONS gets it as a parameter: '{1}{0}'",
            token.author, token.author == "t" ? "float " : "vec3 "));
    return true;
  }
  const Token* const found = definitions_.first_of_author(token.author);
  if (found == nullptr || !definitions_.of(token.word).empty()) return false;
  if (is_call && !built_in_overloads(token.author).empty()) return false;
  reporter_.report(
      Code::snippet_unknown_name, token,
      fmt::format("'{}' is defined in a file that this one does not import; import it, or move the definition",
                  token.author),
      {{reporter_.span_of(*found), "it is defined here"}});
  return true;
}

/// A name that nothing declares, or a function that does not take these arguments.
void LogReport::report_name(const LogEntry& entry, const Line& line, const Explanation& why) {
  const Token& token = *line.token;
  const std::string_view name = token.author;
  const bool is_call = entry.reason.find("no matching overloaded function") != std::string::npos;
  const bool is_faulty = !faulty_.insert(line.statement).second;
  const bool in_library = !library_signatures(name).empty();
  const std::vector<const Token*>& definitions = definitions_.of(token.word);
  if (is_call && definitions.empty() && in_library && !prepared_.uses_library) {
    if (unknown_.insert(name).second || !is_faulty) {
      reporter_.report(why.code, token,
                       fmt::format("'{}' is a function of the library; #include <sdf> makes it known", name));
    }
    return;
  }
  const bool is_new = !unknown_.contains(token.word);
  if (is_new && (report_ambiguous(token) || report_order(token) || report_elsewhere(token, is_call))) {
    unknown_.insert(token.word);
    return be_doubtful(line);
  }
  if (is_call && (!definitions.empty() || is_known(name) || !legacy_spelling(name).empty())) {
    if (is_faulty || is_doubtful(line.statement)) return;
    std::vector<Note> notes;
    for (const Token* definition : definitions) notes.push_back({reporter_.span_of(*definition), "it is defined here"});
    return reporter_.report(Code::snippet_syntax, token, fmt::format("'{}' does not take these arguments", name),
                            std::move(notes));
  }
  if (!unknown_.insert(name).second && !is_call) return;
  be_doubtful(line);
  const auto near = nearest_name(name, known_names(is_call));
  std::string message = why.sentence;
  if (near && name.size() > 1) message += fmt::format("; did you mean '{}'?", *near);
  const bool near_is_library = near && name.size() > 1 && !library_signatures(*near).empty();
  if (near_is_library && !prepared_.uses_library) message += " (it is in the library: #include <sdf>)";
  reporter_.report(why.code, token, std::move(message));
}

/// What a statement with an unknown name declares has the type of a guess.
void LogReport::be_doubtful(const Line& line) {
  doubtful_.insert(line.token->author);
  const auto [begin, end] = std::equal_range(shader_.lines.begin(), shader_.lines.end(), line,
                                             [](const Line& a, const Line& b) { return a.statement < b.statement; });
  for (auto other = begin; other != end; ++other) {
    if (other->behind) continue;
    const std::vector<Token>& tokens = prepared_.texts[other->token->text].tokens;
    if (is_declaration(tokens, static_cast<std::size_t>(other->token - tokens.data()))) {
      doubtful_.insert(other->token->author);
    }
  }
}

// ---- what is known, and what is a guess ----

/// Whether a statement uses a name whose type is a guess. Its tokens are next to each other in the shader.
bool LogReport::is_doubtful(std::uint32_t statement) {
  if (doubtful_.empty()) return false;
  const auto [begin, end] =
      std::equal_range(shader_.lines.begin(), shader_.lines.end(), Line{nullptr, false, false, statement},
                       [](const Line& a, const Line& b) { return a.statement < b.statement; });
  const bool is = std::any_of(begin, end, [&](const Line& line) {
    return !line.behind && line.token->is_identifier() && doubtful_.contains(line.token->author);
  });
  if (is) faulty_.insert(statement);  // what else it brings is a consequence as well
  return is;
}

bool LogReport::is_known(std::string_view name) const {
  if (declared_.empty()) {
    declared_ = {"p", "t"};
    for (const PreparedText& text : prepared_.texts) {
      for (const std::string_view declared : declared_names(text.tokens)) declared_.insert(declared);
    }
  }
  if (unknown_.contains(name)) return false;
  return declared_.contains(name) || !built_in_overloads(name).empty() || !library_signatures(name).empty();
}

std::vector<std::string_view> LogReport::known_names(bool functions) const {
  std::vector<std::string_view> names = {"p", "t"};
  for (const PreparedText& text : prepared_.texts) {
    for (const std::string_view name : declared_names(text.tokens)) names.push_back(name);
  }
  std::erase_if(names, [&](std::string_view name) { return unknown_.contains(name); });
  if (!functions) {
    names.insert(names.end(), type_names().begin(), type_names().end());
    return names;
  }
  names.insert(names.end(), built_in_functions().begin(), built_in_functions().end());
  names.insert(names.end(), library_functions().begin(), library_functions().end());
  return names;
}

}  // namespace

void report_log(const std::vector<LogEntry>& log, const Prepared& prepared, const Shader& shader,
                Definitions& definitions, Reporter& reporter) {
  LogReport(prepared, shader, definitions, reporter).run(log);
}

}  // namespace dmvv::compiler::snippet
