#include "compiler/snippet/library.h"

#include <algorithm>
#include <unordered_map>

#include "compiler/shader_text.h"
#include "compiler/snippet/glsl_tokens.h"
#include "compiler/snippet/names.h"

namespace dmvv::compiler::snippet {
namespace {

/// A function definition: its text, and the words in it.
struct Definition {
  std::string_view name;
  std::string_view glsl;
  std::vector<std::string_view> words;
};

/// The library holds nothing but functions: `type name(...) { ... }`.
std::vector<Definition> read_definitions(std::string_view text) {
  std::vector<Definition> result;
  WordPool pool;
  const std::vector<Token> tokens = tokenize(text, 0, pool);
  for (std::size_t i = 0; i + 1 < tokens.size();) {
    Definition definition;
    definition.name = tokens[i + 1].word;
    const std::size_t begin = tokens[i].begin;
    for (std::size_t depth = 0; i < tokens.size(); ++i) {
      if (tokens[i].is_identifier()) definition.words.push_back(tokens[i].word);
      if (tokens[i].is("{")) ++depth;
      if (tokens[i].is("}") && --depth == 0) break;
    }
    definition.glsl = text.substr(begin, tokens[std::min(i, tokens.size() - 1)].end - begin);
    result.push_back(std::move(definition));
    ++i;
  }
  return result;
}

const std::vector<Definition>& definitions() {
  static const std::vector<Definition> result = read_definitions(shader_text::sdf);
  return result;
}

}  // namespace

const std::vector<std::string_view>& library_functions() {
  static const std::vector<std::string_view> result = [] {
    std::vector<std::string_view> names;
    for (const Definition& definition : definitions()) {
      if (std::find(names.begin(), names.end(), definition.name) == names.end()) names.push_back(definition.name);
    }
    return names;
  }();
  return result;
}

const std::vector<std::string>& library_signatures(std::string_view name) {
  static const std::unordered_map<std::string_view, std::vector<std::string>> known = [] {
    std::unordered_map<std::string_view, std::vector<std::string>> result;
    WordPool pool;
    const std::vector<Token> tokens = tokenize(shader_text::sdf, 0, pool);
    for (const Declaration& function : global_declarations(tokens)) {
      result[tokens[function.name].word].push_back(function.signature);
    }
    return result;
  }();
  static const std::vector<std::string> none;
  const auto found = known.find(name);
  return found == known.end() ? none : found->second;
}

std::string library_for(const std::unordered_set<std::string_view>& names) {
  std::unordered_set<std::string_view> needed = names;
  std::vector<bool> chosen(definitions().size());
  for (std::size_t i = chosen.size(); i-- > 0;) {  // a function calls only what stands before it
    const Definition& definition = definitions()[i];
    chosen[i] = needed.contains(definition.name);
    if (chosen[i]) needed.insert(definition.words.begin(), definition.words.end());
  }
  std::string result;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i]) result.append(definitions()[i].glsl).append("\n");
  }
  return result;
}

}  // namespace dmvv::compiler::snippet
