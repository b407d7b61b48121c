// The author's text -> Snippet: prepared, put together as a shader with one token a line (glslang knows lines only, so
// that a line is a place), compiled, read, and tried at points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <set>

#include "compiler/snippet/explain.h"
#include "compiler/snippet/glsl_words.h"
#include "compiler/snippet/glslang_front.h"
#include "compiler/snippet/library.h"
#include "compiler/snippet/literals.h"
#include "compiler/snippet/missing_return.h"
#include "compiler/snippet/preprocess.h"
#include "compiler/snippet/probe_points.h"
#include "compiler/snippet/read_spirv.h"
#include "compiler/snippet/snippet.h"
#include "compiler/snippet/unset_reads.h"

namespace dmvv::compiler::snippet {
namespace {

// ---- the shader ----

/// What a line of the shader is: a token of the author, or something of ours behind one.
struct Line {
  const Token* token = nullptr;  ///< null: before any token
  bool behind = false;
  std::uint32_t statement = 0;
};

struct Shader {
  std::string glsl;
  Literals literals;                ///< of the author's functions, in long texts
  std::vector<Line> lines;          ///< line k + 1 of the text
  std::string_view function = "f";  ///< the name of the author's function
};

class Assembler {
 public:
  explicit Assembler(const Prepared& prepared) : prepared_(prepared) {}

  Shader run() {
    std::set<std::string_view> words;
    for (const PreparedText& text : prepared_.texts) {
      for (const Token& token : text.tokens) words.insert(token.word);
    }
    add("#version 460\n"
        "layout(location = 0) in vec3 dmvv_p;\n"
        "layout(location = 1) in float dmvv_t;\n"
        "layout(location = 0) out float dmvv_distance;\n");
    std::size_t numbers = 0;
    for (const PreparedText& text : prepared_.texts) {
      numbers += static_cast<std::size_t>(std::ranges::count(text.tokens, Token::Kind::number, &Token::kind));
    }
    keeps_literals_ = numbers >= Literals::least;
    const std::size_t declarations = shader_.glsl.size();
    if (keeps_literals_) add("\n");  // of the array, which is known at the end
    if (prepared_.uses_legacy_functions) add(legacy_functions());
    if (prepared_.uses_library) add(library_for(words));
    const std::size_t body = prepared_.texts.size() - 1;
    for (std::size_t i = 0; i < body; ++i) {
      add_text(prepared_.texts[i]);
      add(fmt::format("const int dmvv_end_{} = 0;\n", i));  // where a text ends in the middle, its fault stands here
      const auto declared = declared_names(prepared_.texts[i].tokens);
      if (std::find(declared.begin(), declared.end(), "f") != declared.end()) shader_.function = "dmvv_f";
    }
    last_ = nullptr;
    add(fmt::format("float {}(vec3 p, float t) {{\n", shader_.function));
    depth_ = 1;
    add_text(prepared_.texts[body]);
    if (keeps_literals_) shader_.glsl.replace(declarations, 1, shader_.literals.empty() ? "\n" : shader_.literals.declaration());
    add(fmt::format("}}\nvoid main() {{ dmvv_distance = {}(dmvv_p, dmvv_t); }}\n", shader_.function));
    return std::move(shader_);
  }

 private:
  /// A number may stand in the array of literals where GLSL does not ask for a constant: in a function, but not in the
  /// value of a constant nor in the size of an array.
  bool may_be_kept(const Token& token) {
    if (!keeps_literals_) return false;
    depth_ += token.is("{") ? 1 : token.is("}") ? -1 : 0;
    brackets_ += token.is("[") ? 1 : token.is("]") ? -1 : 0;
    if (token.is("const")) in_constant_ = true;
    if (token.is(";") || token.is("{")) in_constant_ = false;
    return depth_ > 0 && brackets_ == 0 && !in_constant_ && token.kind == Token::Kind::number && is_float_literal(token.word);
  }

  void add(std::string_view ours) {
    shader_.glsl += ours;
    shader_.lines.insert(shader_.lines.end(), static_cast<std::size_t>(std::count(ours.begin(), ours.end(), '\n')),
                         {last_, true, statement_});
  }

  void add_text(const PreparedText& text) {
    ++statement_;
    for (const Token& token : text.tokens) {
      last_ = &token;
      shader_.glsl.append(may_be_kept(token) ? shader_.literals.place_of(token.word) : std::string(token.word)).append("\n");
      shader_.lines.push_back({last_, false, statement_});
      if (token.is(";") || token.is("{") || token.is("}")) ++statement_;
    }
  }

  const Prepared& prepared_;
  Shader shader_;
  const Token* last_ = nullptr;
  std::uint32_t statement_ = 0;
  bool keeps_literals_ = false;
  bool in_constant_ = false;
  int depth_ = 0;  ///< of braces
  int brackets_ = 0;
};

// ---- errors ----

class Compilation {
 public:
  Compilation(const voml::Function& function, Diagnostics& diagnostics, const CodeCache& cache)
      : function_(function), diagnostics_(diagnostics), cache_(cache) {
    for (const voml::GlslText& helper : function.helpers) texts_.push_back(&helper);
    texts_.push_back(&function.body);
  }

  std::optional<Snippet> run();

 private:
  const voml::GlslText& text_of(const Token& token) const { return *texts_[token.text]; }
  Span span_of(const Token& token) const { return voml::locate(text_of(token), token.begin, token.end); }
  Span behind(const Token& token) const {
    const Span span = span_of(token);
    return {span.source, span.end, span.end};
  }
  bool in_body(const Token& token) const { return token.text + 1 == texts_.size(); }
  Span body_words() const;
  Span loop() const;
  void report(Code code, const Token& token, std::string message, std::vector<Note> notes = {}) {
    ++errors_;
    diagnostics_.report(code, span_of(token), std::move(message), std::move(notes));
  }

  bool is_small_enough();
  void report_faults();
  void report_log(const std::vector<LogEntry>& log);
  void report_parsing(const LogEntry& entry);
  const Token* head_of_call(const Token* bracket) const;
  const Token* behind_next(const Token* token, std::string_view mark) const;
  const Token* culprit(const Token* token, const LogEntry& entry) const;
  void report_name(const LogEntry& entry, const Line& line, const Explanation& why);
  void report_linking(const LogEntry& entry);
  void report_recursion(std::string_view list);
  void report_missing_returns(const std::vector<std::uint32_t>& spirv);
  void report_unreadable(const Error& error);
  void report_unset(const std::vector<std::uint32_t>& spirv, bool uses_time);
  const Token* mention_near(std::uint32_t line, std::string_view name) const;
  const Token* declaration_before(const Token& use) const;
  void probe(const Snippet& snippet);

  std::vector<std::string_view> known_names(bool functions) const;
  std::vector<const Token*> definitions_of(std::string_view name) const;
  const Token* call_in(std::string_view caller, std::string_view callee) const;
  bool mentions(std::uint32_t statement, const std::set<std::string_view>& names) const;

  const voml::Function& function_;
  Diagnostics& diagnostics_;
  const CodeCache& cache_;
  std::vector<const voml::GlslText*> texts_;
  Prepared prepared_;
  Shader shader_;
  std::size_t errors_ = 0;
  std::set<std::uint32_t> refused_;      // statements with something refused: glslang does not know it either
  std::set<std::uint32_t> faulty_;       // statements with an error: what else they bring is a consequence
  std::set<std::string_view> unknown_;   // names reported as such
  std::set<std::string_view> doubtful_;  // names whose type glslang had to guess
};

Span Compilation::body_words() const {
  const std::vector<Token>& tokens = prepared_.texts.back().tokens;
  if (tokens.empty()) return function_.span;
  const Span first = span_of(tokens.front()), last = span_of(tokens.back());
  return {first.source, first.begin, std::max(first.end, last.end)};
}

/// The loop, if there is one alone; else the body.
Span Compilation::loop() const {
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

bool Compilation::is_small_enough() {
  std::size_t bytes = 0;
  for (const voml::GlslText* text : texts_) {
    bytes += text->text.size();
    if (bytes <= max_text_bytes) continue;
    diagnostics_.report(Code::snippet_syntax, voml::locate(*text, 0, 1),
                        fmt::format("a function with its FUNCTIONS is at most {} bytes of text, up to the end of this "
                                    "element there are {}",
                                    max_text_bytes, bytes));
    return false;
  }
  return true;
}

void Compilation::report_faults() {
  for (const Fault& fault : prepared_.faults) report(fault.code, fault.token, fault.message);
}

/// The tokens of a statement are next to each other in the shader.
bool Compilation::mentions(std::uint32_t statement, const std::set<std::string_view>& names) const {
  const auto [begin, end] =
      std::equal_range(shader_.lines.begin(), shader_.lines.end(), Line{nullptr, false, statement},
                       [](const Line& a, const Line& b) { return a.statement < b.statement; });
  return std::any_of(begin, end, [&](const Line& line) {
    return !line.behind && line.token->is_identifier() && names.contains(line.token->author);
  });
}

std::vector<std::string_view> Compilation::known_names(bool functions) const {
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

/// The tokens that name the function where it is defined.
std::vector<const Token*> Compilation::definitions_of(std::string_view name) const {
  std::vector<const Token*> result;
  for (const PreparedText& text : prepared_.texts) {
    for (std::size_t i = 1; i + 1 < text.tokens.size(); ++i) {
      if (!text.tokens[i].is(name) || !text.tokens[i + 1].is("(") || !is_declaration(text.tokens, i)) continue;
      std::size_t end = i + 1;
      while (end < text.tokens.size() && !text.tokens[end].is(";") && !text.tokens[end].is("{")) ++end;
      if (end < text.tokens.size() && text.tokens[end].is("{")) result.push_back(&text.tokens[i]);
    }
  }
  return result;
}

void Compilation::report_log(const std::vector<LogEntry>& log) {
  for (const Fault& fault : prepared_.faults) {
    for (const Line& line : shader_.lines) {
      const bool here = line.token != nullptr && !line.behind && line.token->text == fault.token.text &&
                        line.token->begin == fault.token.begin;
      if (here) refused_.insert(line.statement);
    }
  }
  for (const LogEntry& entry : log) {
    if (entry.line != 0) {
      report_parsing(entry);
    } else if (errors_ == 0) {
      report_linking(entry);
    }
  }
}

/// glslang puts the errors of a call at its ')' or '('; the author looks for the name before it.
const Token* Compilation::head_of_call(const Token* bracket) const {
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
const Token* Compilation::behind_next(const Token* token, std::string_view mark) const {
  const std::vector<Token>& tokens = prepared_.texts[token->text].tokens;
  const Token* const end = tokens.data() + tokens.size();
  for (const Token* next = token; next + 1 < end && !next->is(";"); ++next) {
    if (next->is(mark)) return next + 1;
  }
  return token;
}

/// The token that an author would point at; glslang names brackets, and the variable in front of its value.
const Token* Compilation::culprit(const Token* token, const LogEntry& entry) const {
  if (entry.reason.find("syntax error") != std::string::npos) return token;
  if (token->is("(") || token->is(")")) return head_of_call(token);
  if (token->is("[")) return behind_next(token, "[");
  if (entry.reason.find("cannot convert from") != std::string::npos) return behind_next(token, "=");
  return token;
}

void Compilation::report_parsing(const LogEntry& entry) {
  Line line = entry.line <= shader_.lines.size() ? shader_.lines[entry.line - 1] : Line{};
  const bool is_syntax = entry.reason.find("syntax error") != std::string::npos;
  if (refused_.contains(line.statement) && !is_syntax) return;
  if (line.token != nullptr && !line.behind) line.token = culprit(line.token, entry);
  const bool never_returns = entry.reason.find("function does not return a value") != std::string::npos;
  if (never_returns && errors_ != 0) return;  // its `return` may be what is wrong
  if (line.token == nullptr) {                // the head of the author's function, or text of ours
    ++errors_;
    diagnostics_.report(never_returns ? Code::snippet_return : Code::snippet_syntax, body_words(),
                        explain(entry, {{}, true, false}).sentence);
    return;
  }
  const Explanation why = explain(entry, {line.token->author, in_body(*line.token), line.behind});
  if (why.code == Code::snippet_unknown_name) return report_name(entry, line, why);
  if (faulty_.contains(line.statement) || mentions(line.statement, doubtful_)) return;
  faulty_.insert(line.statement);
  if (!line.behind) return report(why.code, *line.token, why.sentence);
  ++errors_;
  diagnostics_.report(why.code, behind(*line.token), why.sentence);
}

/// A name that nothing declares, or a function that does not take these arguments.
void Compilation::report_name(const LogEntry& entry, const Line& line, const Explanation& why) {
  const std::string_view name = line.token->author;
  const bool is_call = entry.reason.find("no matching overloaded function") != std::string::npos;
  const std::vector<std::string_view> known = known_names(is_call);
  const bool is_faulty = !faulty_.insert(line.statement).second;
  const auto& library = library_functions();
  const bool in_library = std::find(library.begin(), library.end(), name) != library.end();
  if (is_call && in_library && !prepared_.uses_library) {
    if (unknown_.insert(name).second || !is_faulty) {
      report(why.code, *line.token,
             fmt::format("'{}' is a function of the library; #include <sdf> makes it known", name));
    }
    return;
  }
  if (is_call && (std::find(known.begin(), known.end(), name) != known.end() || !legacy_spelling(name).empty())) {
    if (is_faulty || mentions(line.statement, doubtful_)) return;
    std::vector<Note> notes;
    for (const Token* definition : definitions_of(name)) notes.push_back({span_of(*definition), "it is defined here"});
    return report(Code::snippet_syntax, *line.token, fmt::format("'{}' does not take these arguments", name),
                  std::move(notes));
  }
  if (!unknown_.insert(name).second && !is_call) return;
  doubtful_.insert(name);
  for (const Line& other : shader_.lines) {  // what the statement declares has the type of a guess
    if (other.statement != line.statement || other.behind) continue;
    const std::vector<Token>& tokens = prepared_.texts[other.token->text].tokens;
    if (is_declaration(tokens, static_cast<std::size_t>(other.token - tokens.data()))) {
      doubtful_.insert(other.token->author);
    }
  }
  const auto near = nearest_name(name, known);
  std::string message = why.sentence;
  if (near && name.size() > 1) message += fmt::format("; did you mean '{}'?", *near);
  const bool near_is_library =
      near && name.size() > 1 && std::find(library.begin(), library.end(), *near) != library.end();
  if (near_is_library && !prepared_.uses_library) message += " (it is in the library: #include <sdf>)";
  report(why.code, *line.token, std::move(message));
}

// ---- errors of linking ----

/// "g(vf3;" -> "g"
std::string_view plain_name(std::string_view mangled) {
  const std::size_t begin = std::min(mangled.find_first_not_of(" \t"), mangled.size());
  return mangled.substr(begin, std::min(mangled.find('(', begin), mangled.size()) - begin);
}

void Compilation::report_linking(const LogEntry& entry) {
  constexpr std::string_view no_body = "No function definition (body) found:";
  if (entry.reason.find("Recursion detected") != std::string::npos) return report_recursion(entry.reason);
  if (const std::size_t at = entry.reason.find(no_body); at != std::string::npos) {
    const std::size_t name_at =
        std::min(entry.reason.find_first_not_of(" \t\n", at + no_body.size()), entry.reason.size());
    const std::string_view name = plain_name(std::string_view(entry.reason).substr(name_at));
    for (const PreparedText& text : prepared_.texts) {
      for (const Token& token : text.tokens) {
        if (token.is(name)) {
          return report(Code::snippet_unknown_name, token,
                        fmt::format("the function '{}' is declared, but not defined", name));
        }
      }
    }
  }
  ++errors_;
  diagnostics_.report(Code::snippet_syntax, body_words(), fmt::format("the function does not link: {}", entry.reason));
}

const Token* Compilation::call_in(std::string_view caller, std::string_view callee) const {
  const auto search = [&](const std::vector<Token>& tokens, std::size_t i) -> const Token* {
    for (std::size_t depth = 0; i + 1 < tokens.size(); ++i) {
      if (tokens[i].is("{")) ++depth;
      if (tokens[i].is("}") && --depth == 0) return nullptr;
      if (depth > 0 && tokens[i].is(callee) && tokens[i + 1].is("(")) return &tokens[i];
    }
    return nullptr;
  };
  if (caller == shader_.function) {
    for (const Token& token : prepared_.texts.back().tokens) {
      if (token.is(callee)) return &token;
    }
  }
  for (const Token* definition : definitions_of(caller)) {
    const std::vector<Token>& tokens = prepared_.texts[definition->text].tokens;
    const Token* call = search(tokens, static_cast<std::size_t>(definition - tokens.data()));
    if (call != nullptr) return call;
  }
  return nullptr;
}

/// glslang lists the calls of a cycle: "g(f1; calling h(f1;".
void Compilation::report_recursion(std::string_view list) {
  constexpr std::string_view calling = " calling ";
  const std::size_t at = list.find(calling);
  if (at == std::string_view::npos) return;
  const std::string_view caller = plain_name(list.substr(list.rfind('\n', at) + 1));
  const std::string_view callee = plain_name(list.substr(at + calling.size()));
  const std::string message =
      caller == callee
          ? fmt::format("'{}' calls itself; a shader has no stack, write a loop instead", caller)
          : fmt::format("'{}' calls '{}', which calls it again; a shader has no stack, write a loop instead", caller,
                        callee);
  if (const Token* call = call_in(caller, callee)) return report(Code::snippet_recursion, *call, message);
  ++errors_;
  diagnostics_.report(Code::snippet_recursion, body_words(), message);
}

// ---- errors of a program ----

void Compilation::report_missing_returns(const std::vector<std::uint32_t>& spirv) {
  constexpr std::string_view message = "not every way through this function ends in a 'return'";
  for (const std::string& mangled : functions_without_return(spirv)) {
    const std::string_view name = plain_name(mangled);
    if (name == shader_.function) {
      ++errors_;
      diagnostics_.report(Code::snippet_return, body_words(), std::string(message));
      continue;
    }
    const std::vector<const Token*> definitions = definitions_of(name);
    if (!definitions.empty()) report(Code::snippet_return, *definitions.front(), std::string(message));
  }
}

void Compilation::report_unreadable(const Error& error) {
  std::vector<Note> notes;
  for (const std::string& reason : error.reasons) notes.push_back({Span{}, reason});
  diagnostics_.report(Code::snippet_refused, body_words(), error.message, std::move(notes));
}

// ---- variables that are read before they are set ----

/// The mention of a name that is nearest to a line of the shader, in the line's statement.
const Token* Compilation::mention_near(std::uint32_t line, std::string_view name) const {
  if (line == 0 || line > shader_.lines.size()) return nullptr;
  const auto is_here = [&](std::size_t i) {
    const Line& other = shader_.lines[i];
    return other.statement == shader_.lines[line - 1].statement && !other.behind && other.token->word == name;
  };
  for (std::size_t away = 0; away < shader_.lines.size(); ++away) {
    if (line - 1 + away < shader_.lines.size() && is_here(line - 1 + away)) return shader_.lines[line - 1 + away].token;
    if (away < line && is_here(line - 1 - away)) return shader_.lines[line - 1 - away].token;
  }
  return nullptr;
}

const Token* Compilation::declaration_before(const Token& use) const {
  const std::vector<Token>& tokens = prepared_.texts[use.text].tokens;
  for (auto i = static_cast<std::size_t>(&use - tokens.data()) + 1; i-- > 0;) {
    if (!tokens[i].is(use.word)) continue;
    const bool follows_comma = i > 0 && tokens[i - 1].is(",") && i + 1 < tokens.size() &&
                               (tokens[i + 1].is(",") || tokens[i + 1].is(";") || tokens[i + 1].is("="));
    if (follows_comma || is_declaration(tokens, i)) return &tokens[i];
  }
  return nullptr;
}

void Compilation::report_unset(const std::vector<std::uint32_t>& spirv, bool uses_time) {
  for (const UnsetRead& read : find_unset_reads(shader_.glsl, shader_.literals, spirv)) {
    const Token* mention = mention_near(read.variable.line, read.variable.name);
    const std::string where = describe(read.p, read.t_ms, uses_time);
    const std::string_view name = mention != nullptr ? mention->author : std::string_view(read.variable.name);
    std::string message =
        read.variable.is_out
            ? fmt::format("the 'out' parameter '{}' is not set on every way through its function, as at {}; set it first",
                          name, where)
            : fmt::format("the variable '{}' is read before it is set, as at {}; give it a value where it is declared", name,
                          where);
    const Token* declared = mention != nullptr ? declaration_before(*mention) : nullptr;
    std::vector<Note> notes;
    if (declared != nullptr && declared != mention) notes.push_back({span_of(*declared), "it is declared here"});
    diagnostics_.report(Code::snippet_unset_variable, mention != nullptr ? span_of(*mention) : body_words(),
                        std::move(message), std::move(notes));
  }
}

/// Tries the snippet where it will be asked: refuses loops that do not end, warns of values that are no distances.
void Compilation::probe(const Snippet& snippet) {
  std::string not_finite;
  for (const double t : probe_times(snippet.uses_time())) {
    for (const glm::dvec3& p : probe_points()) {
      const Value value = snippet.evaluate(p, t);
      if (!value.finished) {
        ++errors_;
        diagnostics_.report(Code::snippet_runs_away, loop(),
                            fmt::format("a loop does not end within {} steps at {}", Snippet::step_budget,
                                        describe(p, t, snippet.uses_time())));
        return;
      }
      if (!std::isfinite(value.f) && not_finite.empty()) {
        not_finite = fmt::format("the distance is {} at {}", std::isnan(value.f) ? "not a number" : "infinite",
                                 describe(p, t, snippet.uses_time()));
      }
    }
  }
  if (!not_finite.empty()) diagnostics_.report(Code::snippet_not_finite, body_words(), std::move(not_finite));
}

std::optional<Snippet> Compilation::run() {
  if (!is_small_enough()) return std::nullopt;

  // 1. Tokens that are safe to compile.
  std::vector<std::string_view> texts;
  for (const voml::GlslText* text : texts_) texts.emplace_back(text->text);
  prepared_ = prepare(texts);
  report_faults();
  if (!prepared_.complete) return std::nullopt;

  // 2. glslang.
  shader_ = Assembler(prepared_).run();
  const Compiled compiled = compile_vertex_shader(shader_.glsl, shader_.literals, cache_);
  report_log(compiled.errors);
  if (errors_ == 0) report_missing_returns(compiled.spirv);
  if (errors_ != 0) return std::nullopt;

  // 3. The program, tried.
  auto program = read_spirv(compiled.spirv);
  if (!program) {
    report_unreadable(program.error());
    return std::nullopt;
  }
  Snippet snippet(std::make_shared<const Program>(std::move(*program)));
  if (snippet.nesting() > Snippet::most_nested) {
    ++errors_;
    diagnostics_.report(Code::snippet_nested_too_deeply, body_words(),
                        fmt::format("conditions are nested {} deep, early returns counted; drivers follow {} with certainty: "
                                    "search by halves, or choose with ?: or min and max",
                                    snippet.nesting(), Snippet::most_nested));
    return std::nullopt;
  }
  probe(snippet);
  if (errors_ != 0) return std::nullopt;
  report_unset(compiled.spirv, snippet.uses_time());
  return snippet;
}

}  // namespace

std::optional<Snippet> compile_snippet(const voml::Function& function, Diagnostics& diagnostics,
                                       const CodeCache& cache) {
  try {
    return Compilation(function, diagnostics, cache).run();
  } catch (const std::bad_alloc&) {
    diagnostics.report(Code::snippet_refused, function.span, "there is not enough memory to compile this function");
    return std::nullopt;
  }
}

}  // namespace dmvv::compiler::snippet
