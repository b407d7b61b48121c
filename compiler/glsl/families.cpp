#include "compiler/glsl/families.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cctype>
#include <cstdlib>
#include <functional>
#include <optional>
#include <utility>

namespace dmvv::compiler {

namespace {

bool is_name_start(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)); }
bool is_name(char c) { return is_name_start(c) || is_digit(c); }

/// Length of the name at the beginning of a text.
std::size_t name_length(std::string_view text) {
  std::size_t n = 0;
  while (n < text.size() && is_name(text[n])) ++n;
  return n;
}

/// Length of the number at the beginning of a text, with its suffix; 0 if there is none.
std::size_t number_length(std::string_view text) {
  std::size_t n = 0;
  if (text.empty() || !is_digit(text[0])) return 0;
  while (n < text.size()) {
    const bool exponent_sign = (text[n] == '-' || text[n] == '+') && (text[n - 1] == 'e' || text[n - 1] == 'E');
    if (!is_name(text[n]) && text[n] != '.' && !exponent_sign) break;
    ++n;
  }
  return n;
}

/// Whether a minus after this text is a sign, not an operation.
bool sign_may_follow(std::string_view before) {
  while (before.ends_with(' ')) before.remove_suffix(1);
  return before.ends_with("return") ||
         (!before.empty() && std::string_view("(,=?:<>*/+-&|").find(before.back()) != std::string_view::npos);
}

/// f, u or i.
char type_of(std::string_view literal) {
  if (literal.ends_with('u')) return 'u';
  return literal.find_first_of(".e") != std::string_view::npos ? 'f' : 'i';
}

std::uint32_t bits_of(const std::string& literal) {
  switch (type_of(literal)) {
    case 'f':
      return std::bit_cast<std::uint32_t>(std::strtof(literal.c_str(), nullptr));
    case 'u':
      return static_cast<std::uint32_t>(std::strtoul(literal.c_str(), nullptr, 0));
    default:
      return static_cast<std::uint32_t>(std::strtol(literal.c_str(), nullptr, 10));
  }
}

std::string as_type(char type, const std::string& bits) {
  if (type == 'f') return fmt::format("uintBitsToFloat({})", bits);
  return type == 'i' ? fmt::format("int({})", bits) : bits;
}

/// "const float a0[24] = float[24]": the head of a constant array; empty if the text does not begin with one.
std::string_view table_head(std::string_view text) {
  if (!text.starts_with("const float ")) return {};
  const std::string_view head = text.substr(0, text.find('('));
  return head.find("] = ") == std::string_view::npos ? std::string_view{} : head;
}

std::vector<std::string> split(std::string_view list) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t comma = list.find(", ");
    parts.emplace_back(list.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    list.remove_prefix(comma + 2);
  }
}

}  // namespace

// ---- reading ----

std::vector<Families::Token> Families::tokens_of(const std::string& name, const std::string& text) const {
  using Kind = Token::Kind;
  std::vector<Token> tokens;
  std::map<std::string, std::uint32_t, std::less<>> columns;
  std::vector<std::optional<std::uint32_t>> brackets;  // open ones: of an element of which table
  const auto add = [&](Kind kind, std::string_view part) -> Token& {
    if (kind == Kind::text && !tokens.empty() && tokens.back().kind == Kind::text) {
      tokens.back().text += part;
      return tokens.back();
    }
    return tokens.emplace_back(Token{kind, std::string(part)});
  };
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view rest = std::string_view(text).substr(i);
    std::size_t length = 1;
    if (rest.starts_with("//")) {
      length = std::min(rest.find('\n'), rest.size());
      add(Kind::comment, rest.substr(0, length));
    } else if (const std::string_view head = table_head(rest); !head.empty()) {
      const std::size_t end = rest.find(");");
      Token& table = add(Kind::table, rest.substr(0, end + 2));
      table.column = static_cast<std::uint32_t>(columns.size());
      table.values = split(rest.substr(head.size() + 1, end - head.size() - 1));
      const std::size_t name_at = head.find(' ', 6) + 1;
      columns.emplace(head.substr(name_at, head.find('[') - name_at), table.column);
      length = end + 2;
    } else if (is_name_start(rest[0])) {
      length = name_length(rest);
      const std::string_view word = rest.substr(0, length);
      const bool own = word.starts_with(name) && (word.size() == name.size() || word[name.size()] == '_');
      if (own) {
        add(Kind::own_name, word.substr(name.size()));
      } else if (const auto callee = numbers_.find(word); callee != numbers_.end()) {
        add(Kind::callee, word).callee = callee->second;
      } else if (const auto shape = united_names_.find(word); shape != united_names_.end()) {
        add(Kind::united, word).callee = shape->second;
      } else if (const auto column = columns.find(word);
                 column != columns.end() && rest.substr(length).starts_with('[')) {
        add(Kind::element, rest.substr(0, ++length)).column = column->second;
        brackets.push_back(column->second);
      } else {
        add(Kind::text, word);
      }
    } else if (const bool sign = rest[0] == '-' && sign_may_follow(std::string_view(text).substr(0, i));
               number_length(rest.substr(sign ? 1 : 0)) != 0) {
      length = number_length(rest.substr(sign ? 1 : 0)) + (sign ? 1 : 0);
      const std::string_view after = rest.substr(length);
      const bool may_be_size = after.starts_with("] = ") || after.starts_with("](");  // a size is no value
      add(may_be_size ? Kind::text : Kind::literal, rest.substr(0, length));
    } else if (rest[0] == ']' && !brackets.empty()) {
      Token& end = add(brackets.back() ? Kind::element_end : Kind::text, "]");
      if (brackets.back()) end.column = *brackets.back();
      brackets.pop_back();
    } else {
      if (rest[0] == '[') brackets.emplace_back();
      add(Kind::text, rest.substr(0, 1));
    }
    i += length;
  }
  return tokens;
}

std::string Families::shape_text(const Function& function) const {
  std::string text;
  for (const Token& token : function.tokens) {
    switch (token.kind) {
      case Token::Kind::comment:
        break;
      case Token::Kind::literal:
        text += fmt::format("\x01{}", type_of(token.text));
        break;
      case Token::Kind::own_name:
        text += "\x02" + token.text;
        break;
      case Token::Kind::callee:
        text += fmt::format("\x03{}", functions_[token.callee].shape);
        break;
      case Token::Kind::table:
        text += "\x04";
        break;
      default:
        text += token.text;
    }
  }
  return text;
}

void Families::add(const std::string& name, const std::string& text) {
  Function function{name, tokens_of(name, text)};
  for (const Token& token : function.tokens) {
    if (token.kind == Token::Kind::callee)
      function.level = std::max(function.level, functions_[token.callee].level + 1);
  }
  function.shape = shapes_.try_emplace(shape_text(function), static_cast<std::uint32_t>(shapes_.size())).first->second;
  numbers_.emplace(name, static_cast<std::uint32_t>(functions_.size()));
  functions_.push_back(std::move(function));
}

// ---- uniting ----

std::string Families::united_name(std::uint32_t shape) const {
  const auto first = std::ranges::find(functions_, shape, &Function::shape);
  return first->name + "_united";
}

std::string Families::unite(const std::vector<std::string>& names) {
  Union& united = unions_[shape(names.front())];
  for (const std::string& name : names) {
    assert(shape(name) == shape(names.front()));
    united.members.insert(numbers_.at(name));
  }
  const std::string name = united_name(shape(names.front()));
  united_names_.emplace(name, shape(names.front()));
  return name;
}

void Families::settle() {
  // Step 1: callers before callees, as members of a union unite what they call.
  std::map<std::uint32_t, std::set<std::uint32_t>, std::greater<>> by_level;
  const auto level_of = [&](std::uint32_t shape) {
    return std::ranges::find(functions_, shape, &Function::shape)->level;
  };
  for (const auto& [shape, united] : unions_) by_level[level_of(shape)].insert(shape);
  while (!by_level.empty()) {
    auto level = by_level.begin();
    const std::set<std::uint32_t> shapes = std::move(level->second);
    by_level.erase(level);
    for (const std::uint32_t shape : shapes) {
      compare(shape);
      for (const std::size_t token : unions_[shape].united_callees) {
        const std::uint32_t callee = functions_[functions_[*unions_[shape].members.begin()].tokens[token].callee].shape;
        by_level[level_of(callee)].insert(callee);
      }
    }
  }
  // Step 2: rows, the callees' first: a caller's parameters name them.
  std::vector<std::uint32_t> order;
  for (const auto& [shape, united] : unions_) order.push_back(shape);
  std::ranges::stable_sort(order, {}, level_of);
  for (const std::uint32_t shape : order) lay_out(unions_[shape]);
}

void Families::compare(std::uint32_t shape) {
  Union& united = unions_[shape];
  const std::size_t count = functions_[*united.members.begin()].tokens.size();
  for (std::size_t token = 0; token < count; ++token) compare_token(united, token);
}

/// What differs between the members at this token.
void Families::compare_token(Union& united, std::size_t token) {
  const auto at = [&](std::uint32_t member) -> const Token& { return functions_[member].tokens[token]; };
  const Token& first = at(*united.members.begin());
  const auto differs = [&](auto part) {
    return std::ranges::any_of(united.members, [&](std::uint32_t m) { return part(at(m)) != part(first); });
  };
  if (first.kind == Token::Kind::table) {
    united.columns = std::max(united.columns, first.column + 1);
    united.has_table = united.has_table || differs([](const Token& t) { return t.values; });
  }
  if (first.kind == Token::Kind::callee && differs([](const Token& t) { return t.callee; })) {
    united.united_callees.insert(token);
    for (const std::uint32_t member : united.members)
      unions_[functions_[first.callee].shape].members.insert(at(member).callee);
  }
  if (first.kind != Token::Kind::literal || !differs([](const Token& t) { return t.text; })) return;
  Slot slot{type_of(first.text), {}};
  for (const std::uint32_t member : united.members) slot.values.push_back(at(member).text);
  const auto same = std::ranges::find(united.slots, slot);
  united.slot_of_token.emplace(token, static_cast<std::size_t>(same - united.slots.begin()));
  if (same == united.slots.end()) united.slots.push_back(std::move(slot));
}

namespace {

std::size_t rows_for(std::size_t values) { return (values + 3) / 4; }

}  // namespace

/// A member's rows: literals, rows of united callees, and the table.
void Families::lay_out(const Union& united) {
  std::size_t i = 0;
  for (const std::uint32_t number : united.members) {
    Function& member = functions_[number];
    member.row = static_cast<std::uint32_t>(parameters_.size());
    std::vector<std::uint32_t> values;
    for (const Slot& slot : united.slots) values.push_back(bits_of(slot.values[i]));
    for (const std::size_t token : united.united_callees) values.push_back(functions_[member.tokens[token].callee].row);
    for (std::size_t v = 0; v < values.size(); ++v) {
      if (v % 4 == 0) parameters_.emplace_back(0u);
      parameters_.back()[static_cast<int>(v % 4)] = values[v];
    }
    if (united.has_table) lay_out_table(united, member);
    ++i;
  }
}

/// Element i of all arrays stands in the same rows: one fetch serves four arrays.
void Families::lay_out_table(const Union& united, const Function& member) {
  const std::size_t first = parameters_.size(), stride = rows_for(united.columns);
  for (const Token& token : member.tokens) {
    if (token.kind != Token::Kind::table) continue;
    parameters_.resize(std::max(parameters_.size(), first + token.values.size() * stride), glm::uvec4(0u));
    for (std::size_t e = 0; e < token.values.size(); ++e) {
      parameters_[first + e * stride + token.column / 4][static_cast<int>(token.column % 4)] = bits_of(token.values[e]);
    }
  }
}

// ---- writing ----

std::string Families::take(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) take(numbers_.at(name), text);
  return text;
}

std::string Families::copy(const std::vector<std::string>& names) {
  std::vector<bool> functions;
  std::map<std::uint32_t, bool> unions;
  for (const Function& function : functions_) functions.push_back(function.is_taken);
  for (const auto& [shape, united] : unions_) unions.emplace(shape, united.is_taken);
  std::string text = take(names);
  for (std::size_t i = 0; i < functions.size(); ++i) functions_[i].is_taken = functions[i];
  for (auto& [shape, united] : unions_) united.is_taken = unions.at(shape);
  return text;
}

void Families::take(std::uint32_t number, std::string& text) {
  Function& function = functions_[number];
  if (std::exchange(function.is_taken, true)) return;
  std::string own;
  for (const Token& token : function.tokens) {
    if (token.kind == Token::Kind::callee) take(token.callee, text);
    if (token.kind == Token::Kind::united) take_united(token.callee, text);
    own += (token.kind == Token::Kind::own_name ? function.name : "") + token.text;
  }
  text += own;
}

void Families::take_united(std::uint32_t shape, std::string& text) {
  Union& united = unions_[shape];
  if (std::exchange(united.is_taken, true)) return;
  const Function& first = functions_[*united.members.begin()];
  for (std::size_t t = 0; t < first.tokens.size(); ++t) {
    const Token& token = first.tokens[t];
    if (token.kind == Token::Kind::united) take_united(token.callee, text);
    if (token.kind != Token::Kind::callee) continue;
    if (united.united_callees.contains(t)) {
      take_united(functions_[token.callee].shape, text);
    } else {
      take(token.callee, text);
    }
  }
  text += united_text(united);
}

std::string Families::rows_text(const Union& united) const {
  std::string text;
  for (std::size_t k = 0; k < rows_for(united.slots.size() + united.united_callees.size()); ++k) {
    text += fmt::format("  uvec4 k{0} = parameter_at(row + {0}u);\n", k);
  }
  return text;
}

std::string Families::united_text(const Union& united) const {
  const Function& first = functions_[*united.members.begin()];
  std::size_t head = 0;  // the definition; its helpers stand before it
  for (std::size_t t = 0; t < first.tokens.size(); ++t) {
    if (first.tokens[t].kind == Token::Kind::own_name && first.tokens[t].text.empty()) head = t;
  }
  std::string text = fmt::format("// {} and {} more of its shape\n", first.name, united.members.size() - 1);
  std::string argument;  // goes before those of the call or definition that begins
  bool rows_stand = false, is_bare = false;
  for (std::size_t t = 0; t < first.tokens.size(); ++t) {
    std::string part = united_token(united, t);
    if (first.tokens[t].kind == Token::Kind::comment) {  // the first member's alone
      while (text.ends_with(' ')) text.pop_back();
      is_bare = text.ends_with('\n');
      continue;
    }
    if (std::exchange(is_bare, false)) part.erase(0, 1);  // the end of a line that is a comment
    if (!argument.empty()) part.insert(1, std::exchange(argument, {}));
    if (t == head) argument = "uint row, ";
    if (united.united_callees.contains(t)) argument = united_row(united, t) + ", ";
    if (const std::size_t body = part.find("{\n"); t > head && !rows_stand && body != std::string::npos) {
      part.insert(body + 2, rows_text(united));
      rows_stand = true;
    }
    text += part;
  }
  return text;
}

namespace {

std::string value_text(std::size_t i) { return fmt::format("k{}.{}", i / 4, "xyzw"[i % 4]); }

}  // namespace

/// Of the function that a member calls at this token.
std::string Families::united_row(const Union& united, std::size_t token) const {
  const auto callee = united.united_callees.find(token);
  return value_text(united.slots.size() +
                    static_cast<std::size_t>(std::distance(united.united_callees.begin(), callee)));
}

std::string Families::united_token(const Union& united, std::size_t index) const {
  const Function& first = functions_[*united.members.begin()];
  const Token& token = first.tokens[index];
  switch (token.kind) {
    case Token::Kind::own_name:
      return united_name(first.shape) + token.text;
    case Token::Kind::callee:
      return united.united_callees.contains(index) ? united_name(functions_[token.callee].shape) : token.text;
    case Token::Kind::literal:
      if (const auto slot = united.slot_of_token.find(index); slot != united.slot_of_token.end()) {
        return as_type(united.slots[slot->second].type, value_text(slot->second));
      }
      return token.text;
    case Token::Kind::table:
      return united.has_table ? "" : token.text;
    case Token::Kind::element:
      if (!united.has_table) return token.text;
      return fmt::format("uintBitsToFloat(parameter_at(row + {}u + {}u * uint(",
                         rows_for(united.slots.size() + united.united_callees.size()) + token.column / 4,
                         rows_for(united.columns));
    case Token::Kind::element_end:
      return united.has_table ? fmt::format(")).{})", "xyzw"[token.column % 4]) : token.text;
    default:
      return token.text;
  }
}

}  // namespace dmvv::compiler
