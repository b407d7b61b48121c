// The author's text -> Snippet: prepared, put together as a shader with one token a line (glslang knows lines only, so
// that a line is a place), compiled, read, and tried at points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "compiler/snippet/built_ins.h"
#include "compiler/snippet/explain.h"
#include "compiler/snippet/glsl_words.h"
#include "compiler/snippet/glslang_front.h"
#include "compiler/snippet/library.h"
#include "compiler/snippet/literals.h"
#include "compiler/snippet/missing_return.h"
#include "compiler/snippet/names.h"
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
  bool forwards = false;  ///< text of ours that only repeats what the author declared
  std::uint32_t statement = 0;
};

struct Shader {
  std::string glsl;
  Literals literals;        ///< of the author's functions, in long texts
  std::vector<Line> lines;  ///< line k + 1 of the text
};
/// The function that the body becomes. What the author calls so has another word (names.h).
constexpr std::string_view body_function = "f";

class Assembler {
 public:
  explicit Assembler(const Prepared& prepared) : prepared_(prepared) {}

  Shader run() {
    std::unordered_set<std::string_view> words;
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
      add_forwards(prepared_.texts[i]);
      add_text(prepared_.texts[i]);
      add(fmt::format("const int dmvv_end_{} = 0;\n", i));  // where a text ends in the middle, its fault stands here
    }
    add_forwards(prepared_.texts[body]);
    last_ = nullptr;
    add(fmt::format("float {}(vec3 p, float t) {{\n", body_function));
    depth_ = 1;
    add_text(prepared_.texts[body]);
    if (keeps_literals_)
      shader_.glsl.replace(declarations, 1, shader_.literals.empty() ? "\n" : shader_.literals.declaration());
    add(fmt::format("}}\nvoid main() {{ dmvv_distance = {}(dmvv_p, dmvv_t); }}\n", body_function));
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
    return depth_ > 0 && brackets_ == 0 && !in_constant_ && token.kind == Token::Kind::number &&
           is_float_literal(token.word);
  }

  void add(std::string_view ours) {
    shader_.glsl += ours;
    shader_.lines.insert(shader_.lines.end(), static_cast<std::size_t>(std::count(ours.begin(), ours.end(), '\n')),
                         {last_, true, false, statement_});
  }

  void add_forwards(const PreparedText& text) {
    const std::size_t first = shader_.lines.size();
    add(text.forwards);
    for (std::size_t i = first; i < shader_.lines.size(); ++i) shader_.lines[i].forwards = true;
  }

  void add_text(const PreparedText& text) {
    ++statement_;
    for (const Token& token : text.tokens) {
      last_ = &token;
      shader_.glsl.append(may_be_kept(token) ? shader_.literals.place_of(token.word) : std::string(token.word))
          .append("\n");
      shader_.lines.push_back({last_, false, false, statement_});
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

/// The texts of a function with where they stand: its files, its object, its body.
Sources sources_of(const voml::Function& function) {
  Sources sources;
  if (function.files != nullptr) {
    for (const voml::FunctionFile& file : *function.files) sources.imports.push_back(file.imports);
  }
  const auto object = static_cast<std::uint32_t>(sources.imports.size());
  sources.imports.emplace_back();
  if (object > 0) sources.imports.back().push_back(object - 1);
  sources.imports.push_back({object});
  for (std::size_t i = 0; i < function.helpers.size(); ++i) {
    const voml::HelperPlace place = function.places.empty() ? voml::HelperPlace{object, 0} : function.places[i];
    const bool is_of_object = place.file == object;
    sources.texts.push_back(
        {function.helpers[i].text, place.file,
         is_of_object ? static_cast<std::uint32_t>(sources.imports[object].size()) : place.imports});
  }
  sources.texts.push_back({function.body.text, object + 1, 1});
  return sources;
}

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
  void report(Code code, const Token& token, std::string message, std::vector<Note> notes = {});

  bool is_small_enough();
  void report_faults();
  void report_log(const std::vector<LogEntry>& log);
  void report_parsing(const LogEntry& entry);
  const Token* head_of_call(const Token* bracket) const;
  const Token* behind_next(const Token* token, std::string_view mark) const;
  const Token* culprit(const Token* token, const LogEntry& entry) const;
  void report_twice(const LogEntry& entry, const Line& line);
  void pass_over_body(std::size_t line);
  const Token* defined_before(const Token& token) const;
  bool report_ambiguous(const Token& token);
  bool report_order(const Token& token);
  bool report_elsewhere(const Token& token, bool is_call);
  std::string prototype_of(const Token& name) const;
  void be_doubtful(const Line& line);
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
  bool is_known(std::string_view name) const;
  const std::vector<const Token*>& definitions_of(std::string_view word);
  const Declaration* declaration_of(const Token& name) const;
  void index_definitions();
  const Token* call_in(std::string_view caller, std::string_view callee);
  bool is_doubtful(std::uint32_t statement);

  const voml::Function& function_;
  Diagnostics& diagnostics_;
  const CodeCache& cache_;
  std::vector<const voml::GlslText*> texts_;
  Prepared prepared_;
  Shader shader_;
  std::size_t errors_ = 0;
  std::unordered_map<std::string_view, std::vector<const Token*>>
      definitions_;                                               // by word: what stands outside of functions
  std::unordered_map<std::string_view, const Token*> by_author_;  // the first of each name
  mutable std::unordered_set<std::string_view> declared_;         // all names of all texts; made when asked for
  bool is_indexed_ = false;
  std::unordered_set<std::uint32_t> refused_;      // statements with something refused: glslang does not know it either
  std::unordered_set<std::uint32_t> faulty_;       // statements with an error: what else they bring is a consequence
  std::unordered_set<std::string_view> unknown_;   // names reported as such
  std::unordered_set<std::string_view> twice_;     // names reported as defined twice
  std::unordered_set<std::string_view> doubtful_;  // names whose type glslang had to guess
};

/// A fault in what a macro made stands where the macro is used; a note says where its text stands.
void Compilation::report(Code code, const Token& token, std::string message, std::vector<Note> notes) {
  ++errors_;
  if (token.macro != 0) {
    const Token& macro = prepared_.macros[token.macro - 1];
    notes.push_back(
        {span_of(macro), fmt::format("'{}' comes from the macro '{}', defined here", token.author, macro.word)});
  }
  diagnostics_.report(code, span_of(token), std::move(message), std::move(notes));
}

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
  for (const Fault& fault : prepared_.faults) {
    std::vector<Note> notes;
    for (const FaultNote& note : fault.notes) notes.push_back({span_of(note.token), note.message});
    report(fault.code, fault.token, fault.message, std::move(notes));
  }
}

/// Whether a statement uses a name whose type is a guess. Its tokens are next to each other in the shader.
bool Compilation::is_doubtful(std::uint32_t statement) {
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

bool Compilation::is_known(std::string_view name) const {
  if (declared_.empty()) {
    declared_ = {"p", "t"};
    for (const PreparedText& text : prepared_.texts) {
      for (const std::string_view declared : declared_names(text.tokens)) declared_.insert(declared);
    }
  }
  if (unknown_.contains(name)) return false;
  return declared_.contains(name) || !built_in_overloads(name).empty() || !library_signatures(name).empty();
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

void Compilation::index_definitions() {
  if (std::exchange(is_indexed_, true)) return;
  for (const PreparedText& text : prepared_.texts) {
    for (const Declaration& declaration : text.declarations) {
      if (declaration.kind == Declaration::Kind::function && !declaration.is_definition) continue;
      const Token& name = text.tokens[declaration.name];
      definitions_[name.word].push_back(&name);
      by_author_.try_emplace(name.author, &name);
    }
  }
}

/// The tokens that name what glslang knows by this word, where it is defined.
const std::vector<const Token*>& Compilation::definitions_of(std::string_view word) {
  index_definitions();
  static const std::vector<const Token*> none;
  const auto found = definitions_.find(word);
  return found == definitions_.end() ? none : found->second;
}

const Declaration* Compilation::declaration_of(const Token& name) const {
  const PreparedText& text = prepared_.texts[name.text];
  const auto at = static_cast<std::size_t>(&name - text.tokens.data());
  const auto found = std::lower_bound(text.declarations.begin(), text.declarations.end(), at,
                                      [](const Declaration& d, std::size_t token) { return d.name < token; });
  return found != text.declarations.end() && found->name == at ? &*found : nullptr;
}

void Compilation::report_log(const std::vector<LogEntry>& log) {
  constexpr std::size_t most_reported = 100;
  std::set<std::pair<std::uint32_t, std::uint32_t>> places;
  for (const Fault& fault : prepared_.faults) places.emplace(fault.token.text, fault.token.begin);
  for (const Line& line : shader_.lines) {
    if (places.empty()) break;
    const bool is_author = line.token != nullptr && !line.behind;
    if (is_author && places.contains({line.token->text, line.token->begin})) refused_.insert(line.statement);
  }
  for (LogEntry entry : log) {
    if (errors_ >= most_reported) return;
    entry.word = author_word(entry.word);
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
  if (line.forwards || (refused_.contains(line.statement) && !is_syntax)) return;
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
  if (faulty_.contains(line.statement) || is_doubtful(line.statement)) return;
  faulty_.insert(line.statement);
  const bool is_twice = entry.reason.find("redefinition") != std::string::npos ||
                        entry.reason.find("function already has a body") != std::string::npos ||
                        entry.reason.find("must have the same return type") != std::string::npos;
  if (is_twice && !line.behind) return report_twice(entry, line);
  if (!line.behind) return report(why.code, *line.token, why.sentence);
  ++errors_;
  diagnostics_.report(why.code, behind(*line.token), why.sentence);
}

// ---- names ----

/// Where a name that is declared again was declared before; null for what no text declares.
const Token* Compilation::defined_before(const Token& token) const {
  const std::vector<Token>& tokens = prepared_.texts[token.text].tokens;
  std::size_t closed = 0;  // blocks that end before the token
  for (auto i = static_cast<std::size_t>(&token - tokens.data()); i-- > 0;) {
    if (tokens[i].is("}")) ++closed;
    if (tokens[i].is("{") && closed > 0) --closed;
    const bool follows_comma = i > 0 && tokens[i - 1].is(",") && !tokens[i + 1].is("(");
    if (closed == 0 && tokens[i].is(token.word) && (is_declaration(tokens, i) || follows_comma)) return &tokens[i];
  }
  const auto found = definitions_.find(token.word);
  return found == definitions_.end() || found->second.front() == &token ? nullptr : found->second.front();
}

/// glslang goes on with another function than the one that it refuses: what it says of the body means nothing.
void Compilation::pass_over_body(std::size_t line) {
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

void Compilation::report_twice(const LogEntry& entry, const Line& line) {
  index_definitions();
  const Token& token = *line.token;
  const Token* const before = defined_before(token);
  doubtful_.insert(token.author);  // which of the two types a use has is a guess
  const std::vector<Token>& tokens = prepared_.texts[token.text].tokens;
  const bool is_function = &token + 1 < tokens.data() + tokens.size() && (&token + 1)->is("(");
  if (is_function) pass_over_body(entry.line - 1);
  if (token.kind == Token::Kind::identifier && !twice_.insert(token.word).second) return;
  if (before == nullptr && in_body(token) && (token.is("p") || token.is("t"))) {
    return report(Code::snippet_syntax, token,
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
  if (before != nullptr) notes.push_back({span_of(*before), "it is defined here"});
  report(Code::snippet_syntax, token, std::move(message), std::move(notes));
}

bool Compilation::report_ambiguous(const Token& token) {
  for (const AmbiguousName& name : prepared_.ambiguous) {
    if (name.word != token.word) continue;
    report(Code::snippet_ambiguous_name, token,
           fmt::format(
               "'{}' is defined in two files that are imported here, and neither imports the other; define it here as "
               "well, or give one of them another name",
               token.author),
           {{span_of(name.first), "it is defined here"}, {span_of(name.second), "and here"}});
    return true;
  }
  return false;
}

/// The head of a function as its author wrote it: "float b(vec3 p)".
std::string Compilation::prototype_of(const Token& name) const {
  const Declaration& function = *declaration_of(name);
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
bool Compilation::report_order(const Token& token) {
  const auto is_behind = [&](const Token* other) {
    return other->text > token.text || (other->text == token.text && other > &token);
  };
  const std::vector<const Token*>& definitions = definitions_of(token.word);
  if (!definitions.empty() && std::all_of(definitions.begin(), definitions.end(), is_behind)) {
    const Token& first = *definitions.front();
    const bool is_function = declaration_of(first)->kind == Declaration::Kind::function;
    report(
        Code::snippet_unknown_name, token,
        is_function
            ? fmt::format(
                  "'{}' is defined further down, and a function stands before its use; move it up, or declare it "
                  "before: '{};'",
                  token.author, prototype_of(first))
            : fmt::format("'{}' is defined further down, and stands before its use in GLSL; move it up", token.author),
        {{span_of(first), "it is defined here"}});
    return true;
  }
  for (const Token& macro : prepared_.macros) {
    const bool is_later = macro.text > token.text || (macro.text == token.text && macro.begin > token.begin);
    if (macro.word != token.word || !is_later) continue;
    report(Code::snippet_unknown_name, token,
           fmt::format("the macro '{}' is defined further down, and holds from there on; move it up", token.author),
           {{span_of(macro), "it is defined here"}});
    return true;
  }
  return false;
}

/// A name that is known, but not where the token stands.
bool Compilation::report_elsewhere(const Token& token, bool is_call) {
  if (!in_body(token) && !is_call && (token.author == "t" || token.author == "p")) {
    report(Code::snippet_unknown_name, token,
           fmt::format(
               "'{0}' is known in the text of an SDF alone; a function of FUNCTIONS gets it as a parameter: '{1}{0}'",
               token.author, token.author == "t" ? "float " : "vec3 "));
    return true;
  }
  index_definitions();
  const auto found = by_author_.find(token.author);
  if (found == by_author_.end() || !definitions_of(token.word).empty()) return false;
  if (is_call && !built_in_overloads(token.author).empty()) return false;
  report(Code::snippet_unknown_name, token,
         fmt::format("'{}' is defined in a file that this one does not import; import it, or move the definition",
                     token.author),
         {{span_of(*found->second), "it is defined here"}});
  return true;
}

/// A name that nothing declares, or a function that does not take these arguments.
void Compilation::report_name(const LogEntry& entry, const Line& line, const Explanation& why) {
  const Token& token = *line.token;
  const std::string_view name = token.author;
  const bool is_call = entry.reason.find("no matching overloaded function") != std::string::npos;
  const bool is_faulty = !faulty_.insert(line.statement).second;
  const bool in_library = !library_signatures(name).empty();
  const std::vector<const Token*>& definitions = definitions_of(token.word);
  if (is_call && definitions.empty() && in_library && !prepared_.uses_library) {
    if (unknown_.insert(name).second || !is_faulty) {
      report(why.code, token, fmt::format("'{}' is a function of the library; #include <sdf> makes it known", name));
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
    for (const Token* definition : definitions) notes.push_back({span_of(*definition), "it is defined here"});
    return report(Code::snippet_syntax, token, fmt::format("'{}' does not take these arguments", name),
                  std::move(notes));
  }
  if (!unknown_.insert(name).second && !is_call) return;
  be_doubtful(line);
  const auto near = nearest_name(name, known_names(is_call));
  std::string message = why.sentence;
  if (near && name.size() > 1) message += fmt::format("; did you mean '{}'?", *near);
  const bool near_is_library = near && name.size() > 1 && !library_signatures(*near).empty();
  if (near_is_library && !prepared_.uses_library) message += " (it is in the library: #include <sdf>)";
  report(why.code, token, std::move(message));
}

/// What a statement with an unknown name declares has the type of a guess.
void Compilation::be_doubtful(const Line& line) {
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
                        fmt::format("the function '{}' is declared, but not defined", token.author));
        }
      }
    }
  }
  ++errors_;
  diagnostics_.report(Code::snippet_syntax, body_words(), fmt::format("the function does not link: {}", entry.reason));
}

const Token* Compilation::call_in(std::string_view caller, std::string_view callee) {
  const auto search = [&](const std::vector<Token>& tokens, std::size_t i) -> const Token* {
    for (std::size_t depth = 0; i + 1 < tokens.size(); ++i) {
      if (tokens[i].is("{")) ++depth;
      if (tokens[i].is("}") && --depth == 0) return nullptr;
      if (depth > 0 && tokens[i].is(callee) && tokens[i + 1].is("(")) return &tokens[i];
    }
    return nullptr;
  };
  if (caller == body_function) {
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
          ? fmt::format("'{}' calls itself; a shader has no stack, write a loop instead", author_word(caller))
          : fmt::format("'{}' calls '{}', which calls it again; a shader has no stack, write a loop instead",
                        author_word(caller), author_word(callee));
  if (const Token* call = call_in(caller, callee)) return report(Code::snippet_recursion, *call, message);
  ++errors_;
  diagnostics_.report(Code::snippet_recursion, body_words(), message);
}

// ---- errors of a program ----

void Compilation::report_missing_returns(const std::vector<std::uint32_t>& spirv) {
  constexpr std::string_view message = "not every way through this function ends in a 'return'";
  for (const std::string& mangled : functions_without_return(spirv)) {
    const std::string_view name = plain_name(mangled);
    if (name == body_function) {
      ++errors_;
      diagnostics_.report(Code::snippet_return, body_words(), std::string(message));
      continue;
    }
    const std::vector<const Token*>& definitions = definitions_of(name);
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
            ? fmt::format(
                  "the 'out' parameter '{}' is not set on every way through its function, as at {}; set it first", name,
                  where)
            : fmt::format("the variable '{}' is read before it is set, as at {}; give it a value where it is declared",
                          name, where);
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
  prepared_ = prepare(sources_of(function_));
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
    diagnostics_.report(
        Code::snippet_nested_too_deeply, body_words(),
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
