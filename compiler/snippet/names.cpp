#include "compiler/snippet/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "compiler/snippet/built_ins.h"
#include "compiler/snippet/glsl_words.h"
#include "compiler/snippet/library.h"
#include "compiler/snippet/macros.h"

namespace dmvv::compiler::snippet {
namespace {

// ---- declarations ----

bool is_qualifier(const Token& token) {
  static const std::unordered_set<std::string_view> words = {"const", "in",      "out",     "inout",  "highp",
                                                             "lowp",  "mediump", "precise", "static", "inline"};
  return words.contains(token.word);
}

class DeclarationReader {
 public:
  explicit DeclarationReader(std::span<const Token> tokens) : tokens_(tokens) {}

  std::vector<Declaration> run() {
    while (at_ < tokens_.size()) statement();
    return std::move(found_);
  }

 private:
  bool is(std::string_view word) const { return at_ < tokens_.size() && tokens_[at_].is(word); }
  bool is_name() const {
    return at_ < tokens_.size() && tokens_[at_].is_identifier() && !is_keyword(tokens_[at_].word);
  }

  void skip_brackets() {
    std::size_t open = 0;
    do {
      const Token& token = tokens_[at_++];
      if (token.is("(") || token.is("[") || token.is("{")) ++open;
      if (token.is(")") || token.is("]") || token.is("}")) --open;
    } while (open > 0 && at_ < tokens_.size());
  }

  /// Up to one of these, outside of brackets.
  void skip_to(std::string_view a, std::string_view b) {
    while (at_ < tokens_.size() && !is(a) && !is(b)) {
      if (is("(") || is("[") || is("{"))
        skip_brackets();
      else
        ++at_;
    }
  }

  void skip_arrays() {
    while (is("[")) skip_brackets();
  }

  void statement() {
    while (at_ < tokens_.size() && is_qualifier(tokens_[at_])) ++at_;
    const std::size_t type = at_;
    if (is("struct")) {
      ++at_;
      if (is_name()) add(Declaration::Kind::type, at_++);
      if (is("{")) skip_brackets();
    } else if (is_name()) {
      ++at_;
    } else {
      skip_to(";", "{");
      return end_statement();
    }
    skip_arrays();
    if (is_name() && at_ + 1 < tokens_.size() && tokens_[at_ + 1].is("(")) return function(type);
    while (is_name()) {
      add(Declaration::Kind::variable, at_++);
      skip_to(",", ";");
      if (is(",")) ++at_;
    }
    end_statement();
  }

  void end_statement() {
    if (is("{")) return skip_brackets();
    skip_to(";", "}");
    if (at_ < tokens_.size()) ++at_;
  }

  Declaration& add(Declaration::Kind kind, std::size_t name) {
    Declaration& declaration = found_.emplace_back();
    declaration.kind = kind;
    declaration.name = name;
    return declaration;
  }

  void function(std::size_t result) {
    Declaration& function = add(Declaration::Kind::function, at_);
    function.result = result;
    at_ += 2;
    while (at_ < tokens_.size() && !is(")")) {
      const std::size_t begin = at_;
      skip_to(",", ")");
      if (!(at_ == begin + 1 && tokens_[begin].is("void"))) parameter(begin, function);
      if (is(",")) ++at_;
    }
    if (is(")")) ++at_;
    function.is_definition = is("{");
    end_statement();
  }

  void parameter(std::size_t begin, Declaration& function) {
    std::size_t i = begin;
    while (i < at_ && is_qualifier(tokens_[i])) ++i;
    std::string type, arrays;
    if (i < at_) {
      const std::string_view cg = legacy_spelling(tokens_[i].word);
      type = cg.empty() ? tokens_[i].word : cg;
    }
    std::size_t name = at_;
    for (++i; i < at_; ++i) {
      if (name == at_ && arrays_are_closed(arrays) && tokens_[i].is_identifier())
        name = i;
      else
        arrays += tokens_[i].word;
    }
    function.parameters.push_back({begin, at_, name});
    function.signature += type + arrays + ",";
  }

  static bool arrays_are_closed(const std::string& arrays) { return arrays.empty() || arrays.back() == ']'; }

  std::span<const Token> tokens_;
  std::size_t at_ = 0;
  std::vector<Declaration> found_;
};

// ---- names ----

/// A definition, or a declaration where nothing defines the name.
struct Definition {
  std::uint32_t scope;
  std::uint32_t text;
  const Declaration* declaration;
  bool is_function() const { return declaration->kind == Declaration::Kind::function; }
};

struct Name {
  std::vector<Definition> definitions;  ///< in the order of the texts
  std::vector<std::uint32_t> mentions;  ///< scopes in which the word stands
};

class NameSettler {
 public:
  NameSettler(const Sources& sources, const Visibility& sees, Prepared& prepared)
      : sources_(sources), sees_(sees), prepared_(prepared), words_(sources.imports.size()) {}

  void run() {
    collect_definitions();
    collect_mentions();
    for (const std::string_view word : order_) settle(word, names_.at(word));
    rename();
    for (const auto& forward : forwards_) write(forward);
  }

 private:
  /// Something that a scope sees under a name: a definition of the author, or a function of GLSL.
  struct Forward {
    std::string_view word;  ///< of the function that forwards
    std::uint32_t text;     ///< that it stands before
    const Definition* to;
    const BuiltIn* built_in;
    std::string_view name;  ///< of the function of GLSL
  };
  struct Seen {
    std::vector<const Definition*> definitions;  ///< in the order of the texts
    const Definition* clash = nullptr;           ///< one of them, if another of them means the same
    const Definition* clashes_with = nullptr;
  };

  void collect_definitions();
  void collect_mentions();
  void settle(std::string_view word, const Name& name);
  bool is_contested(std::string_view word, const Name& name) const;
  bool meets_reserved(std::string_view word, const Name& name) const;
  void settle_scope(std::string_view word, const Name& name, std::uint32_t scope);
  Seen visible(const Name& name, std::uint32_t scope) const;
  void add_forward(std::uint32_t scope, Forward forward, std::uint32_t behind);
  void rename();
  void write(const Forward& forward);
  static void write(const Declaration& function, const std::vector<Token>& tokens, std::string_view word,
                    std::string& out);

  template <typename Visit>
  static void for_each_reference(const std::vector<Token>& tokens, Visit visit);

  const Sources& sources_;
  const Visibility& sees_;
  Prepared& prepared_;
  std::unordered_map<std::string_view, Name> names_;
  std::vector<std::string_view> order_;  // of names_, so that the same texts give the same words
  std::vector<std::unordered_map<std::string_view, std::string_view>> words_;  // of each scope: what a name becomes
  std::vector<Forward> forwards_;
};

/// Visits identifiers that may be names of what stands outside of functions: no fields.
template <typename Visit>
void NameSettler::for_each_reference(const std::vector<Token>& tokens, Visit visit) {
  std::size_t braces = 0, structure = 0, brackets = 0;  // structure: the depth of braces within a struct
  bool is_structure = false;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& token = tokens[i];
    if (token.is("struct")) is_structure = true;
    if (token.is("{")) {
      ++braces;
      if (std::exchange(is_structure, false)) structure = braces;
    }
    if (token.is("}") && braces-- == structure) structure = 0;
    if (token.is("[")) ++brackets;
    if (token.is("]")) --brackets;
    if (!token.is_identifier() || (i > 0 && tokens[i - 1].is("."))) continue;
    const bool is_member = structure != 0 && brackets == 0 && i + 1 < tokens.size() &&
                           (tokens[i + 1].is(";") || tokens[i + 1].is(",") || tokens[i + 1].is("["));
    const bool is_type_of_member =
        is_member && tokens[i + 1].is("[") && (tokens[i - 1].is("{") || tokens[i - 1].is(";"));
    if (!is_member || is_type_of_member) visit(i);
  }
}

void NameSettler::collect_definitions() {
  for (std::uint32_t t = 0; t < prepared_.texts.size(); ++t) {
    const PreparedText& text = prepared_.texts[t];
    for (const Declaration& declaration : text.declarations) {
      const auto [known, is_new] = names_.try_emplace(text.tokens[declaration.name].word);
      if (is_new) order_.push_back(known->first);
      known->second.definitions.push_back({sources_.texts[t].scope, t, &declaration});
    }
  }
  for (auto& [word, name] : names_) {  // a declaration of what is defined elsewhere defines nothing
    const auto defines = [](const Definition& d) { return !d.is_function() || d.declaration->is_definition; };
    if (std::any_of(name.definitions.begin(), name.definitions.end(), defines)) {
      std::erase_if(name.definitions, [&](const Definition& d) { return !defines(d); });
    }
  }
}

void NameSettler::collect_mentions() {
  for (std::size_t t = 0; t < prepared_.texts.size(); ++t) {
    const std::uint32_t scope = sources_.texts[t].scope;
    const std::vector<Token>& tokens = prepared_.texts[t].tokens;
    for_each_reference(tokens, [&](std::size_t i) {
      const auto found = names_.find(tokens[i].word);
      if (found == names_.end()) return;
      std::vector<std::uint32_t>& mentions = found->second.mentions;
      if (std::find(mentions.rbegin(), mentions.rend(), scope) == mentions.rend()) mentions.push_back(scope);
    });
  }
}

/// Whether a definition has a name and parameters that glslang has as well.
bool NameSettler::meets_reserved(std::string_view word, const Name& name) const {
  const std::vector<BuiltIn>& built_ins = built_in_overloads(word);
  const std::vector<std::string>& library = library_signatures(word);
  const bool is_function = name.definitions.front().is_function();
  if (!is_function && (word == "f" || word == "main")) return true;  // functions of ours
  return std::any_of(name.definitions.begin(), name.definitions.end(), [&](const Definition& d) {
    if (!d.is_function()) return !library.empty();
    const std::string& signature = d.declaration->signature;
    return std::find(library.begin(), library.end(), signature) != library.end() ||
           std::any_of(built_ins.begin(), built_ins.end(),
                       [&](const BuiltIn& b) { return b.signature() == signature; });
  });
}

/// Whether one word for all would mean something else in one of the scopes.
bool NameSettler::is_contested(std::string_view word, const Name& name) const {
  for (const Definition& definition : name.definitions) {
    for (const std::uint32_t scope : name.mentions) {
      if (!sees_(scope, definition.scope)) return true;
    }
  }
  std::unordered_map<std::string_view, std::uint32_t> signatures;
  const std::uint32_t first = name.definitions.front().scope;
  for (const Definition& definition : name.definitions) {
    const bool is_single = definition.scope == first;
    if (!is_single && !(definition.is_function() && name.definitions.front().is_function())) return true;
    const auto [known, is_new] = signatures.try_emplace(definition.declaration->signature, definition.scope);
    if (!is_new && known->second != definition.scope) return true;
  }
  return meets_reserved(word, name);
}

void NameSettler::settle(std::string_view word, const Name& name) {
  if (is_contested(word, name)) {
    constexpr std::size_t most = std::size_t{1} << 20;
    if (name.definitions.size() * name.mentions.size() > most) {
      const Definition& first = name.definitions.front();
      throw Stop{prepared_.texts[first.text].tokens[first.declaration->name],
                 fmt::format("'{}' is defined too often in files that import each other", word)};
    }
    for (const std::uint32_t scope : name.mentions) settle_scope(word, name, scope);
    return;
  }
  const bool is_function = name.definitions.front().is_function();
  const bool has_overloads = !built_in_overloads(word).empty() || !library_signatures(word).empty();
  if (!is_function || has_overloads || word.starts_with("dmvv_")) return;
  // glslang knows functions that GLSL does not have, such as max3.
  const std::string_view own = prepared_.pool->keep(fmt::format("dmvv_0_{}", word));
  for (const std::uint32_t scope : name.mentions) words_[scope].emplace(word, own);
}

/// The definitions that the scope sees, without those that another hides. A definition hides those that its own scope
/// sees: of functions those with the same parameters, else all.
NameSettler::Seen NameSettler::visible(const Name& name, std::uint32_t scope) const {
  std::vector<const Definition*> all;
  for (const Definition& definition : name.definitions) {
    if (sees_(scope, definition.scope)) all.push_back(&definition);
  }
  const bool are_functions = std::all_of(all.begin(), all.end(), [](const Definition* d) { return d->is_function(); });
  const auto key = [&](const Definition* d) {
    return are_functions ? std::string_view(d->declaration->signature) : "";
  };
  std::unordered_map<std::string_view, std::vector<std::uint32_t>> scopes;  // that define this
  for (const Definition* d : all) {
    std::vector<std::uint32_t>& known = scopes[key(d)];
    if (std::find(known.begin(), known.end(), d->scope) == known.end()) known.push_back(d->scope);
  }
  Seen seen;
  std::unordered_map<std::string_view, const Definition*> first;
  for (const Definition* d : all) {
    const std::vector<std::uint32_t>& known = scopes[key(d)];
    const auto hides = [&](std::uint32_t other) { return other != d->scope && sees_(other, d->scope); };
    if (std::any_of(known.begin(), known.end(), hides)) continue;
    seen.definitions.push_back(d);
    const Definition* const other = first.try_emplace(key(d), d).first->second;
    if (other->scope != d->scope && seen.clash == nullptr) seen.clash = d, seen.clashes_with = other;
  }
  return seen;
}

void NameSettler::settle_scope(std::string_view word, const Name& name, std::uint32_t scope) {
  const Seen seen = visible(name, scope);
  if (seen.definitions.empty()) return;
  const Definition& nearest = *seen.definitions.front();
  const auto is_own = [&](const Definition* d) { return d->scope == scope; };
  const auto place = [&](const Definition& d) { return prepared_.texts[d.text].tokens[d.declaration->name]; };
  const auto word_in = [&](std::uint32_t owner) {
    return prepared_.pool->keep(fmt::format("dmvv_{}_{}", owner + 1, word));
  };
  if (seen.clash != nullptr) {
    words_[scope].emplace(word, word_in(scope));
    prepared_.ambiguous.push_back({words_[scope].at(word), place(*seen.clashes_with), place(*seen.clash)});
    return;
  }
  const bool is_of_one = std::all_of(seen.definitions.begin(), seen.definitions.end(),
                                     [&](const Definition* d) { return d->scope == nearest.scope; });
  if (!nearest.is_function() || (is_of_one && !is_own(&nearest))) {  // what the other scope calls it holds here as well
    words_[scope].emplace(word, word_in(nearest.scope));
    return;
  }
  words_[scope].emplace(word, word_in(scope));
  std::unordered_set<std::string_view> signatures;
  for (const Definition* d : seen.definitions) {
    signatures.insert(d->declaration->signature);
    if (!is_own(d)) add_forward(scope, {words_[scope].at(word), 0, d, nullptr, word}, d->text + 1);
  }
  for (const BuiltIn& built_in : built_in_overloads(word)) {
    if (!signatures.contains(built_in.signature())) {
      add_forward(scope, {words_[scope].at(word), 0, nullptr, &built_in, word}, 0);
    }
  }
}

/// The function is written before the first text of the scope from text `behind` on.
void NameSettler::add_forward(std::uint32_t scope, Forward forward, std::uint32_t behind) {
  constexpr std::size_t max_forwards = std::size_t{1} << 16;
  for (std::uint32_t t = behind; t < sources_.texts.size(); ++t) {
    if (sources_.texts[t].scope != scope) continue;
    forward.text = t;
    if (forwards_.size() == max_forwards) {
      throw Stop{prepared_.texts[t].tokens.front(),
                 "the files that are imported here define too many functions of the same names"};
    }
    return forwards_.push_back(std::move(forward));
  }
}

void NameSettler::rename() {
  for (std::size_t t = 0; t < prepared_.texts.size(); ++t) {
    const auto& words = words_[sources_.texts[t].scope];
    if (words.empty()) continue;
    const bool is_body = t + 1 == prepared_.texts.size();
    std::vector<Token>& tokens = prepared_.texts[t].tokens;
    for_each_reference(tokens, [&](std::size_t i) {
      if (is_body && (tokens[i].is("p") || tokens[i].is("t"))) return;  // parameters of the body
      const auto found = words.find(tokens[i].word);
      if (found != words.end()) tokens[i].word = found->second;
    });
  }
}

void NameSettler::write(const Forward& forward) {
  std::string& out = prepared_.texts[forward.text].forwards;
  if (forward.to != nullptr) {
    return write(*forward.to->declaration, prepared_.texts[forward.to->text].tokens, forward.word, out);
  }
  std::string parameters, arguments;
  for (std::size_t k = 0; k < forward.built_in->parameters.size(); ++k) {
    const BuiltIn::Parameter& parameter = forward.built_in->parameters[k];
    parameters += fmt::format("{}{}{} a{}", k > 0 ? ", " : "", parameter.is_out ? "out " : "", parameter.type, k);
    arguments += fmt::format("{}a{}", k > 0 ? ", " : "", k);
  }
  out += fmt::format("{} {}({}) {{ {}{}({}); }}\n", forward.built_in->result, forward.word, parameters,
                     forward.built_in->result == "void" ? "" : "return ", forward.name, arguments);
}

void NameSettler::write(const Declaration& function, const std::vector<Token>& tokens, std::string_view word,
                        std::string& out) {
  std::string result, parameters, arguments;
  const auto spelt = [](const Token& token) { return std::string(token.word) + " "; };
  for (std::size_t i = function.result; i < function.name; ++i) result += spelt(tokens[i]);
  for (std::size_t k = 0; k < function.parameters.size(); ++k) {
    const Declaration::Parameter& parameter = function.parameters[k];
    if (k > 0) parameters += ", ", arguments += ", ";
    for (std::size_t i = parameter.begin; i < parameter.end; ++i) {
      parameters += i == parameter.name ? fmt::format("a{} ", k) : spelt(tokens[i]);
    }
    if (parameter.name == parameter.end) parameters += fmt::format("a{}", k);
    arguments += fmt::format("a{}", k);
  }
  out += fmt::format("{}{}({}) {{ {}{}({}); }}\n", result, word, parameters,
                     tokens[function.result].is("void") ? "" : "return ", tokens[function.name].word, arguments);
}

}  // namespace

std::vector<Declaration> global_declarations(std::span<const Token> tokens) { return DeclarationReader(tokens).run(); }

Visibility::Visibility(const Sources& sources) {
  const std::size_t scopes = sources.imports.size();
  sees_.assign(scopes, std::vector<bool>(scopes));
  for (std::size_t s = 0; s < scopes; ++s) {  // imports stand before what imports them
    sees_[s][s] = true;
    for (const std::uint32_t import : sources.imports[s]) {
      for (std::size_t k = 0; k <= import; ++k) sees_[s][k] = sees_[s][k] || sees_[import][k];
    }
  }
}

void settle_names(const Sources& sources, const Visibility& sees, Prepared& prepared) {
  NameSettler(sources, sees, prepared).run();
}

std::string_view author_word(std::string_view word) {
  constexpr std::string_view mark = "dmvv_";
  if (!word.starts_with(mark)) return word;
  const std::size_t end = word.find_first_not_of("0123456789", mark.size());
  const bool is_made = end != std::string_view::npos && end > mark.size() && word[end] == '_';
  return is_made ? word.substr(end + 1) : word;
}

}  // namespace dmvv::compiler::snippet
