// mmCIF: the syntax of CIF 1.1 (Hall and McMahon 2005, International Tables for Crystallography G, chapter 2.2), of
// which the categories _atom_site, _pdbx_struct_assembly_gen and _pdbx_struct_oper_list are read.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>

#include "authoring/atom_names.h"
#include "authoring/molecule_readers.h"
#include "base/text.h"

namespace dmvv::authoring {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

struct Token {
  enum class Kind { end, data, loop, tag, value, reserved } kind;
  std::string_view text;   ///< of a value: without its quotes
  std::string_view whole;  ///< as it stands in the file
  bool quoted = false;
};

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  Token next() {
    skip_space_and_comments();
    if (at_ == text_.size()) return {Token::Kind::end, text_.substr(at_), text_.substr(at_)};
    const char c = text_[at_];
    if (c == ';' && (at_ == 0 || text_[at_ - 1] == '\n')) return text_field();
    if (c == '\'' || c == '"') return quoted(c);
    return word();
  }

  [[noreturn]] void refuse(std::string_view part, std::string message) const {
    const auto begin = static_cast<std::size_t>(part.data() - text_.data());
    throw MoleculeRefusal{begin, begin + part.size(), std::move(message)};
  }

 private:
  void skip_space_and_comments() {
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '#')
        at_ = std::min(text_.find('\n', at_), text_.size() - 1);
      else if (!is_space(text_[at_]))
        return;
    }
  }

  Token take(Token::Kind kind, std::size_t end, std::size_t quote_length) {
    const std::string_view whole = text_.substr(at_, end - at_);
    const std::string_view inner = whole.substr(quote_length, whole.size() - 2 * quote_length);
    at_ = end;
    return {kind, inner, whole, quote_length != 0};
  }

  /// From a semicolon at a line's start to the next one.
  Token text_field() {
    const std::size_t end = text_.find("\n;", at_);
    if (end == text_.npos)
      refuse(text_.substr(at_, 1), "the text that begins here has no ';' at a line's start as its end");
    return take(Token::Kind::value, end + 2, 1);
  }

  /// A quote ends a text only where a blank follows.
  Token quoted(char quote) {
    for (std::size_t i = at_ + 1; i < text_.size() && text_[i] != '\n'; ++i) {
      if (text_[i] == quote && (i + 1 == text_.size() || is_space(text_[i + 1]))) {
        return take(Token::Kind::value, i + 1, 1);
      }
    }
    refuse(text_.substr(at_, 1), "a quote that is not closed on its line");
  }

  Token word() {
    std::size_t end = at_;
    while (end < text_.size() && !is_space(text_[end])) ++end;
    const std::string_view text = text_.substr(at_, end - at_);
    const auto is = [&](std::string_view w) { return same_word(text, w); };
    const auto begins = [&](std::string_view w) { return same_word(text.substr(0, w.size()), w); };
    Token::Kind kind = Token::Kind::value;
    if (text.front() == '_')
      kind = Token::Kind::tag;
    else if (begins("data_"))
      kind = Token::Kind::data;
    else if (is("loop_"))
      kind = Token::Kind::loop;
    else if (is("global_") || is("stop_") || begins("save_"))
      kind = Token::Kind::reserved;
    return take(kind, end, 0);
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

/// The items of _atom_site that count; atoms without an element have that of their names. Names given by authors
/// (auth_) are taken before those of the dictionary (label_): the latter do not tell waters apart.
enum Item : std::size_t {
  x,
  y,
  z,
  type_symbol,
  label_alt_id,
  pdbx_pdb_model_num,
  pdbx_pdb_ins_code,
  auth_atom_id,
  auth_comp_id,
  auth_asym_id,
  auth_seq_id,
  label_atom_id,
  label_comp_id,
  label_asym_id,
  label_seq_id,
  item_count
};
constexpr std::array<std::string_view, item_count> item_names{
    "Cartn_x",           "Cartn_y",       "Cartn_z",      "type_symbol",  "label_alt_id", "pdbx_PDB_model_num",
    "pdbx_PDB_ins_code", "auth_atom_id",  "auth_comp_id", "auth_asym_id", "auth_seq_id",  "label_atom_id",
    "label_comp_id",     "label_asym_id", "label_seq_id"};
constexpr std::string_view category = "_atom_site.";

class CifReader {
 public:
  explicit CifReader(MoleculeBuilder& builder) : builder_(builder), lexer_(builder.text()) {}

  void read() {
    token_ = lexer_.next();
    while (token_.kind != Token::Kind::end) {
      if (token_.kind == Token::Kind::data && found_) break;  // a further block
      read_item();
    }
    if (!single_tags_.empty()) read_row(single_values_, columns_of(single_tags_));
    if (builder_.wants_assemblies()) read_assemblies();
  }

 private:
  void advance() { token_ = lexer_.next(); }

  void read_item() {
    switch (token_.kind) {
      case Token::Kind::data:
        return advance();
      case Token::Kind::loop:
        return read_loop();
      case Token::Kind::tag:
        return read_single();
      case Token::Kind::value:
        lexer_.refuse(token_.whole, "a value without a name or loop to which it belongs");
      default:
        lexer_.refuse(token_.whole, fmt::format("'{}' has no meaning in mmCIF", token_.text));
    }
  }

  static bool is_atom_site(std::string_view tag) { return same_word(tag.substr(0, category.size()), category); }

  /// Tells whether a name is that of an item of the atoms.
  static auto is_item(std::size_t item) {
    return [item](const Token& tag) {
      return is_atom_site(tag.text) && same_word(tag.text.substr(category.size()), item_names[item]);
    };
  }

  /// A name and its value outside loops: together they are a table of one row.
  void read_single() {
    const Token tag = token_;
    advance();
    if (token_.kind != Token::Kind::value) lexer_.refuse(tag.whole, fmt::format("'{}' has no value", tag.text));
    if (is_atom_site(tag.text)) {
      found_ = true;
      single_tags_.push_back(tag);
      single_values_.push_back(token_);
    }
    if (Category* const kept = category_of(tag.text)) {
      kept->tags.push_back(tag);
      if (kept->rows.empty()) kept->rows.emplace_back();
      kept->rows.front().push_back(token_);
    }
    advance();
  }

  void read_loop() {
    const Token loop = token_;
    std::vector<Token> tags;
    for (advance(); token_.kind == Token::Kind::tag; advance()) tags.push_back(token_);
    if (tags.empty()) lexer_.refuse(loop.whole, "a loop without names");
    const bool wanted = is_atom_site(tags.front().text);
    const Columns columns = wanted ? columns_of(tags) : Columns{};
    found_ |= wanted;
    Category* const kept = category_of(tags.front().text);
    if (kept) *kept = {tags, {}};
    std::vector<Token> row;
    while (token_.kind == Token::Kind::value) {
      row.push_back(token_);
      advance();
      if (row.size() < tags.size()) continue;
      if (wanted) read_row(row, columns);
      if (kept) kept->rows.push_back(row);
      row.clear();
    }
    if (!row.empty()) {
      lexer_.refuse(row.front().whole,
                    fmt::format("the last row of the loop has {} values, its names are {}", row.size(), tags.size()));
    }
  }

  static constexpr std::size_t absent = static_cast<std::size_t>(-1);
  using Columns = std::array<std::size_t, item_count>;

  Columns columns_of(const std::vector<Token>& tags) const {
    Columns columns;
    for (std::size_t item = 0; item < item_count; ++item) {
      const auto found = std::ranges::find_if(tags, is_item(item));
      columns[item] = found == tags.end() ? absent : static_cast<std::size_t>(found - tags.begin());
      if (found != tags.end() && std::count_if(found, tags.end(), is_item(item)) > 1)
        lexer_.refuse(tags.front().whole, fmt::format("the atoms have {}{} twice", category, item_names[item]));
      if (found == tags.end() && item <= z)
        lexer_.refuse(tags.front().whole, fmt::format("the atoms have no {}{}", category, item_names[item]));
    }
    return columns;
  }

  void read_row(const std::vector<Token>& row, const Columns& columns) {
    const auto value = [&](std::size_t item) -> std::string_view {
      if (columns[item] == absent) return {};
      const Token& token = row[columns[item]];
      const bool unknown = !token.quoted && (token.text == "." || token.text == "?");
      return unknown && item > z ? std::string_view{} : token.text;
    };
    const auto either = [&](std::size_t a, std::size_t b) { return value(a).empty() ? value(b) : value(a); };
    if (const std::string_view model = value(pdbx_pdb_model_num); !model.empty()) {
      if (model_.empty()) model_ = model;
      if (model != model_) return builder_.skip_other_model();
    }
    const std::string_view residue = either(auth_comp_id, label_comp_id), told = without_charge(value(type_symbol));
    builder_.add(
        {{without_uncertainty(value(x)), without_uncertainty(value(y)), without_uncertainty(value(z))},
         told.empty() ? element_of_name(either(auth_atom_id, label_atom_id), residue, NameAlignment::left) : told,
         residue,
         value(label_alt_id),
         either(label_asym_id, auth_asym_id),
         fmt::format("{} {} {}", either(auth_asym_id, label_asym_id), either(auth_seq_id, label_seq_id),
                     value(pdbx_pdb_ins_code))});
  }

  /// "Fe3+" -> "Fe"
  static std::string_view without_charge(std::string_view symbol) {
    const std::size_t digits = std::min(symbol.find_first_of("0123456789+-"), symbol.size());
    const bool charge = symbol.ends_with('+') || symbol.ends_with('-');
    return charge && digits != 0 ? symbol.substr(0, digits) : symbol;
  }

  /// "12.34(5)" -> "12.34"
  static std::string_view without_uncertainty(std::string_view number) {
    const std::size_t open = number.find('(');
    if (open == number.npos || open == 0 || !number.ends_with(')')) return number;
    const std::string_view digits = number.substr(open + 1, number.size() - open - 2);
    const bool all = !digits.empty() && std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
    return all ? number.substr(0, open) : number;
  }

  /// A category that is kept whole.
  struct Category {
    std::vector<Token> tags;
    std::vector<std::vector<Token>> rows;
  };
  static constexpr std::string_view generators_name = "_pdbx_struct_assembly_gen.";
  static constexpr std::string_view operators_name = "_pdbx_struct_oper_list.";

  Category* category_of(std::string_view tag) {
    const auto begins = [&](std::string_view name) { return same_word(tag.substr(0, name.size()), name); };
    return begins(generators_name) ? &generators_ : begins(operators_name) ? &operators_ : nullptr;
  }

  std::size_t column_of(const Category& table, std::string_view name, std::string_view item) const {
    const auto found = std::ranges::find_if(
        table.tags, [&](const Token& tag) { return same_word(tag.text.substr(name.size()), item); });
    if (found == table.tags.end())
      lexer_.refuse(table.tags.front().whole, fmt::format("the assemblies have no {}{}", name, item));
    return static_cast<std::size_t>(found - table.tags.begin());
  }

  void read_assemblies() {
    if (generators_.rows.empty()) return;
    std::map<std::string_view, std::optional<Operator>> known;
    if (!operators_.rows.empty()) {
      const std::size_t id = column_of(operators_, operators_name, "id");
      std::size_t columns[3][4];
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t i = 0; i < 4; ++i)
          columns[row][i] =
              column_of(operators_, operators_name,
                        i < 3 ? fmt::format("matrix[{}][{}]", row + 1, i + 1) : fmt::format("vector[{}]", row + 1));
      for (const std::vector<Token>& values : operators_.rows) {
        std::string_view rows[3][4];
        for (std::size_t row = 0; row < 3; ++row)
          for (std::size_t i = 0; i < 4; ++i) rows[row][i] = values[columns[row][i]].text;
        known[values[id].text] = builder_.read_operator(rows);
      }
    }
    const std::size_t id = column_of(generators_, generators_name, "assembly_id"),
                      expression = column_of(generators_, generators_name, "oper_expression"),
                      chains = column_of(generators_, generators_name, "asym_id_list");
    for (const std::vector<Token>& row : generators_.rows) {
      AssemblyPart part;
      for (const std::string_view chain : split(row[chains].text)) part.chains.emplace_back(chain);
      part.operators = operators_of(row[expression].text, known);
      builder_.add_part(row[id].text, std::move(part));
    }
  }

  static std::vector<std::string_view> split(std::string_view list) {
    std::vector<std::string_view> parts;
    for (std::size_t at = 0; at <= list.size();) {
      const std::size_t end = std::min(list.find(',', at), list.size());
      parts.push_back(trim(list.substr(at, end - at)));
      at = end + 1;
    }
    return parts;
  }

  /// "1,2,5-9" or "(1-60)(61-88)": every operator of the left list after every one of the right.
  std::vector<Operator> operators_of(std::string_view expression,
                                     const std::map<std::string_view, std::optional<Operator>>& known) const {
    std::vector<Operator> product{Operator{}};
    std::string_view rest = trim(expression);
    if (rest.empty()) refuse_expression(expression, "the operators of an assembly are not given");
    while (!rest.empty()) {
      std::string_view list = rest;
      if (rest.front() == '(') {
        const std::size_t close = rest.find(')');
        if (close == rest.npos) refuse_expression(rest.substr(0, 1), "a bracket that is not closed");
        list = rest.substr(1, close - 1);
        rest = trim(rest.substr(close + 1));
      } else {
        if (rest.data() != trim(expression).data() || rest.find_first_of("()") != rest.npos)
          refuse_expression(rest, "an expression of operators is one list, or lists in brackets");
        rest = {};
      }
      std::vector<Operator> next;
      const std::vector<Operator> factors = listed(list, known);
      if (factors.size() * product.size() > max_operators)
        refuse_expression(expression, fmt::format("an assembly of more than {} operators", max_operators));
      for (const Operator& left : product)
        for (const Operator& right : factors)
          next.push_back({left.rotation * right.rotation, left.rotation * right.translation + left.translation});
      product = std::move(next);
    }
    return product;
  }

  std::vector<Operator> listed(std::string_view list,
                               const std::map<std::string_view, std::optional<Operator>>& known) const {
    std::vector<Operator> result;
    const auto add = [&](std::string_view id, std::string_view part) {
      const auto found = known.find(id);
      if (found == known.end()) refuse_expression(part, fmt::format("there is no operator {}", in_quotes(id)));
      if (found->second) result.push_back(*found->second);  // else its fault has been reported
    };
    for (const std::string_view part : split(list)) {
      const std::size_t dash = part.find('-');
      if (dash == part.npos || known.contains(part)) {
        add(part, part);
        continue;
      }
      const auto first = whole(part.substr(0, dash)), last = whole(part.substr(dash + 1));
      if (!first || !last || *last < *first || *last - *first >= max_operators)
        refuse_expression(part, fmt::format("{} is no range of operators", in_quotes(part)));
      for (std::size_t i = *first; i <= *last; ++i) add(std::to_string(i), part);
    }
    return result;
  }

  static std::optional<std::size_t> whole(std::string_view digits) {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc{} && end == digits.data() + digits.size() ? std::optional(value) : std::nullopt;
  }

  [[noreturn]] void refuse_expression(std::string_view part, std::string message) const {
    const auto begin = static_cast<std::size_t>(part.data() - builder_.text().data());
    throw MoleculeRefusal{begin, begin + part.size(), std::move(message), Code::molecule_assembly};
  }

  MoleculeBuilder& builder_;
  Lexer lexer_;
  Token token_{};
  bool found_ = false;
  std::vector<Token> single_tags_, single_values_;
  std::string_view model_;
  Category generators_, operators_;
};

}  // namespace

void read_mmcif(MoleculeBuilder& builder) { CifReader(builder).read(); }

bool looks_like_mmcif(std::string_view text) {
  try {
    const Token::Kind kind = Lexer(text).next().kind;
    return kind == Token::Kind::data || kind == Token::Kind::loop || kind == Token::Kind::tag;
  } catch (const MoleculeRefusal&) {
    return false;
  }
}

}  // namespace dmvv::authoring
