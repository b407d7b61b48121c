#include "compiler/snippet/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <sstream>
#include <vector>

#include "compiler/snippet/glsl_words.h"

namespace dmvv::compiler::snippet {
namespace {

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

/// What stands in single quotes, in order.
std::vector<std::string> quoted(std::string_view text) {
  std::vector<std::string> parts;
  for (std::size_t i = text.find('\''); i != std::string_view::npos; i = text.find('\'', i)) {
    const std::size_t end = text.find('\'', i + 1);
    if (end == std::string_view::npos) break;
    parts.emplace_back(text.substr(i + 1, end - i - 1));
    i = end + 1;
  }
  return parts;
}

// ---- syntax errors ----

/// The names that glslang's grammar gives to tokens.
std::string token_in_words(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 19> names = {{{"SEMICOLON", "';'"},
                                                                                    {"COMMA", "','"},
                                                                                    {"COLON", "':'"},
                                                                                    {"EQUAL", "'='"},
                                                                                    {"DOT", "'.'"},
                                                                                    {"LEFT_PAREN", "'('"},
                                                                                    {"RIGHT_PAREN", "')'"},
                                                                                    {"LEFT_BRACKET", "'['"},
                                                                                    {"RIGHT_BRACKET", "']'"},
                                                                                    {"LEFT_BRACE", "'{'"},
                                                                                    {"RIGHT_BRACE", "'}'"},
                                                                                    {"IDENTIFIER", "a name"},
                                                                                    {"TYPE_NAME", "a type"},
                                                                                    {"FLOATCONSTANT", "a number"},
                                                                                    {"INTCONSTANT", "a number"},
                                                                                    {"UINTCONSTANT", "a number"},
                                                                                    {"WHILE", "'while'"},
                                                                                    {"QUESTION", "'?'"},
                                                                                    {"end of file", "the end"}}};
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto& pair) { return pair.first == name; });
  return found == names.end() ? std::string() : std::string(found->second);
}

/// "COMMA or SEMICOLON" in words; empty if one of them has none.
std::string expected_in_words(std::string_view list) {
  std::string result;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(" or "), list.size());
    const std::string word = token_in_words(list.substr(0, end));
    if (word.empty()) return {};
    result += (result.empty() ? "" : " or ") + word;
    list.remove_prefix(std::min(end + 4, list.size()));
  }
  return result;
}

std::string explain_syntax(std::string_view reason, const ErrorPlace& place) {
  constexpr std::string_view expecting = ", expecting ";
  const std::size_t at = reason.find(expecting);
  const std::string expected =
      at == std::string_view::npos ? std::string() : expected_in_words(reason.substr(at + expecting.size()));
  if (place.at_end) {
    return expected.empty() ? "the text ends in the middle of a statement"
                            : fmt::format("{} is missing here", expected);
  }
  if (place.in_body && contains(reason, "unexpected LEFT_BRACE, expecting SEMICOLON")) {
    return "a function cannot be defined inside of another; helper functions stand in FUNCTIONS";
  }
  const bool is_word = !place.word.empty() && (std::isalpha(static_cast<unsigned char>(place.word[0])) != 0);
  if (is_word && !contains(reason, "unexpected IDENTIFIER") && !contains(reason, "unexpected TYPE_NAME") &&
      !is_keyword(place.word) && !is_type(place.word)) {
    return fmt::format("'{}' is a word that GLSL keeps for itself; take another name", place.word);
  }
  if (expected.empty()) return fmt::format("'{}' cannot stand here", place.word);
  return fmt::format("{} is missing before '{}'", expected, place.word);
}

// ---- types ----

std::string operand_sentence(const LogEntry& entry) {
  const std::vector<std::string> parts = quoted(entry.reason);
  if (parts.size() < 3) return fmt::format("'{}' does not work on these types", entry.word);
  const std::string left = short_type(parts[1]), right = short_type(parts[2]);
  if (entry.word == ":")
    return fmt::format("both sides of ':' must have one type, but they are {} and {}", left, right);
  return fmt::format("'{}' does not work between {} and {}", entry.word, left, right);
}

std::string conversion_sentence(const LogEntry& entry) {
  const std::vector<std::string> parts = quoted(entry.reason);
  if (parts.size() < 2) return entry.reason;
  const auto with_article = [](const std::string& type) { return (type[0] == 'i' ? "an " : "a ") + type; };
  return fmt::format("{} is needed, but this is {}", with_article(short_type(parts[1])),
                     with_article(short_type(parts[0])));
}

/// glslang's phrase, and the sentence it becomes; {0} is the token as glslang names it.
struct Phrase {
  std::string_view reason;
  std::string_view sentence;
};
constexpr std::array<Phrase, 27> phrases = {{
    {"boolean expression expected", "a condition must be a bool; compare the value with something"},
    {"vector swizzle selection out of range", "the vector has no component '.{0}'"},
    {"illegal vector field selection", "a vector has no field '.{0}'; its components are x, y, z and w"},
    {"vector component fields not from the same set", "'.{0}' mixes component names; write xyzw, rgba or stpq"},
    {"vector swizzle too long", "'.{0}' selects more than four components"},
    {"no such field in structure", "the structure has no field '{0}'"},
    {"does not apply to this type", "this value has no field '.{0}'"},
    {"field selection requires structure", "this value has no field '.{0}'"},
    {"scalar swizzle", "a single number has no component '.{0}'"},
    {"can't modify a const", "a constant cannot be changed"},
    {"l-value required", "this cannot be assigned to"},
    {"Non-L-value cannot be passed for 'out'", "an argument that the function writes must be a variable"},
    {"redefinition", "'{0}' is defined twice"},
    {"function already has a body", "this function is defined twice"},
    {"not enough data provided for construction", "this constructor gets too few values"},
    {"too many arguments", "this constructor gets more values than it takes"},
    {"array constructor needs one argument per array element",
     "the array gets more or fewer values than it has elements"},
    {"array size must be a positive integer", "the size of an array must be at least 1"},
    {"array size must be a constant integer expression", "the size of an array must be a constant"},
    {"numeric literal too big", "this number is too large for an int; write it with a decimal point"},
    {"bad digit in hexadecimal literal", "this hexadecimal number is not complete"},
    {"break statement only allowed", "'break' stands outside of a loop or switch"},
    {"continue statement only allowed", "'continue' stands outside of a loop"},
    {"can't use function syntax on variable", "'{0}' is a variable, not a function"},
    {"must be initialized", "a const needs its value where it is declared"},
    {"duplicated value", "this case stands twice in its switch"},
    {"must be first expression in a loop", "this needs a loop around it"},
}};

}  // namespace

std::string short_type(std::string_view type) {
  static const std::set<std::string, std::less<>> qualifiers = {
      "temp",    "const", "in",      "out",     "inout", "global",    "highp",
      "mediump", "lowp",  "precise", "unknown", "of",    "(readonly", "noContraction"};
  std::istringstream words{std::string(type)};
  std::vector<std::string> kept;
  for (std::string word; words >> word;) {
    if (!qualifiers.contains(word)) kept.push_back(word);
  }
  std::string suffix;
  for (std::size_t i = 0; i + 1 < kept.size() && kept[i].ends_with("-element"); i += 2) {
    suffix += "[" + kept[i].substr(0, kept[i].size() - 8) + "]";
  }
  if (!suffix.empty()) kept.erase(kept.begin(), kept.begin() + 2 * std::count(suffix.begin(), suffix.end(), '['));
  if (kept.empty()) return std::string(type);
  if (kept[0].starts_with("structure")) return "struct" + suffix;
  if (kept.size() == 3 && kept[1] == "vector") {
    const std::string kind = kept[2] == "float" ? "" : kept[2].substr(0, 1);
    return kind + "vec" + kept[0].substr(0, 1) + suffix;
  }
  if (kept.size() == 3 && kept[1] == "matrix" && kept[0].size() == 3) {
    const bool square = kept[0][0] == kept[0][2];
    return "mat" + kept[0].substr(0, 1) + (square ? "" : "x" + kept[0].substr(2, 1)) + suffix;
  }
  return kept.back() + suffix;
}

Explanation explain(const LogEntry& entry, const ErrorPlace& place) {
  const std::string_view reason = entry.reason;
  const std::string_view word = place.word.empty() ? std::string_view(entry.word) : place.word;
  if (contains(reason, "syntax error")) return {Code::snippet_syntax, explain_syntax(reason, place)};
  if (contains(reason, "undeclared identifier")) {
    return {Code::snippet_unknown_name, fmt::format("unknown name '{}'", word)};
  }
  if (contains(reason, "no matching overloaded function")) {
    return {Code::snippet_unknown_name, fmt::format("no function '{}'", word)};
  }
  if (contains(reason, "return value to function return type") || contains(reason, "the function's return type")) {
    return {Code::snippet_return, place.in_body ? "a distance is one float, but this 'return' gives another type"
                                                : "this 'return' gives another type than the function has"};
  }
  if (contains(reason, "non-void function must return a value")) {
    return {Code::snippet_return, "this 'return' has no value; the function must give one"};
  }
  if (contains(reason, "void function cannot return a value")) {
    return {Code::snippet_return, "a void function cannot return a value"};
  }
  if (contains(reason, "function does not return a value")) {
    return {Code::snippet_return, place.in_body ? "the function never returns its distance; it needs a 'return'"
                                                : "this function never returns a value"};
  }
  if (contains(reason, "cannot convert from")) return {Code::snippet_syntax, conversion_sentence(entry)};
  if (contains(reason, "wrong operand types")) return {Code::snippet_syntax, operand_sentence(entry)};
  if (contains(reason, "wrong operand type")) {
    const std::size_t type = reason.find("of type ");
    const std::size_t end = std::min(reason.find(" (or"), reason.size());
    const std::string name = type < end ? short_type(reason.substr(type + 8, end - type - 8)) : "this type";
    return {Code::snippet_syntax, fmt::format("'{}' does not work on {}", entry.word, name)};
  }
  if (contains(reason, "index out of range")) {
    const auto parts = quoted(reason);
    return {Code::snippet_syntax,
            fmt::format("the index {} lies outside of the array", parts.empty() ? "" : parts.front())};
  }
  for (const Phrase& phrase : phrases) {
    if (!contains(reason, phrase.reason)) continue;
    return {Code::snippet_syntax, fmt::format(fmt::runtime(phrase.sentence), entry.word)};
  }
  std::string text(reason.substr(0, reason.find('\n')));
  return {Code::snippet_syntax, word.empty() ? text : fmt::format("'{}': {}", word, text)};
}

}  // namespace dmvv::compiler::snippet
