#include "compiler/snippet/glsl_tokens.h"

#include <algorithm>
#include <array>
#include <utility>

namespace dmvv::compiler::snippet {
namespace {

constexpr std::array<std::string_view, 45> operators = {
    "<<=", ">>=", "<=", ">=", "==", "!=", "&&", "||", "^^", "++", "--", "+=", "-=", "*=", "/=",
    "%=",  "&=",  "|=", "^=", "<<", ">>", "(",  ")",  "[",  "]",  "{",  "}",  ".",  ",",  ";",
    ":",   "?",   "+",  "-",  "*",  "/",  "%",  "<",  ">",  "=",  "!",  "&",  "|",  "^",  "~"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool continues_code_point(char c) { return (static_cast<unsigned char>(c) & 0xc0u) == 0x80u; }

class Tokenizer {
 public:
  Tokenizer(std::string_view glsl, std::uint32_t text) : glsl_(glsl), text_(text) {}

  std::vector<Token> run() {
    while (skip_blanks()) {
      const std::size_t begin = at_;
      const Token::Kind kind = read_token();
      const std::string_view word = glsl_.substr(begin, at_ - begin);
      tokens_.push_back(
          {kind, false, word, word, text_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(at_), line_});
    }
    return std::move(tokens_);
  }

 private:
  bool starts_with(std::string_view word) const { return glsl_.substr(at_).starts_with(word); }
  char peek() const { return at_ < glsl_.size() ? glsl_[at_] : '\0'; }

  /// Past blanks, line ends and comments. False at the end of the text.
  bool skip_blanks() {
    while (at_ < glsl_.size()) {
      if (peek() == '\n' || (peek() == '\r' && !starts_with("\r\n"))) {
        ++line_;
        ++at_;
      } else if (peek() == ' ' || peek() == '\t' || peek() == '\r' || peek() == '\v' || peek() == '\f') {
        ++at_;
      } else if (starts_with("//")) {
        at_ = std::min(glsl_.find_first_of("\r\n", at_), glsl_.size());
      } else if (starts_with("/*")) {
        const std::size_t end = glsl_.find("*/", at_ + 2);
        if (end == std::string_view::npos) return true;
        at_ = end + 2;
      } else {
        return true;
      }
    }
    return false;
  }

  Token::Kind read_token() {
    if (is_letter(peek())) {
      while (is_letter(peek()) || is_digit(peek())) ++at_;
      return Token::Kind::identifier;
    }
    if (is_digit(peek()) || (peek() == '.' && at_ + 1 < glsl_.size() && is_digit(glsl_[at_ + 1]))) {
      read_number();
      return Token::Kind::number;
    }
    if (starts_with("/*")) {
      at_ = glsl_.size();
      return Token::Kind::other;
    }
    if (starts_with("##")) {
      at_ += 2;
      return Token::Kind::other;
    }
    const auto known = std::find_if(operators.begin(), operators.end(), [&](auto word) { return starts_with(word); });
    at_ += known != operators.end() ? known->size() : 1;
    while (known == operators.end() && at_ < glsl_.size() && continues_code_point(glsl_[at_])) ++at_;
    return Token::Kind::other;
  }

  void read_number() {
    const bool hex = starts_with("0x") || starts_with("0X");
    while (is_letter(peek()) || is_digit(peek()) || peek() == '.') {
      const bool exponent = !hex && (peek() == 'e' || peek() == 'E');
      ++at_;
      if (exponent && (peek() == '+' || peek() == '-')) ++at_;
    }
  }

  std::string_view glsl_;
  std::uint32_t text_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 0;
  std::vector<Token> tokens_;
};

/// Bytes of a line continuation at `at`; 0 if there is none.
std::size_t continuation_at(std::string_view glsl, std::size_t at) {
  const std::string_view rest = glsl.substr(at);
  return rest.starts_with("\\\n") ? 2 : rest.starts_with("\\\r\n") ? 3 : 0;
}

/// A text without its line continuations, and where they were.
struct Joined {
  std::string glsl;
  std::vector<std::pair<std::size_t, std::size_t>> cuts;  ///< offset in `glsl`, bytes left out up to there; ascending

  /// The offset in the author's text. `cut` is that of the last offset asked for, which was not larger.
  std::uint32_t original(std::uint32_t offset, std::size_t& cut) const {
    while (cut < cuts.size() && cuts[cut].first <= offset) ++cut;
    return cut == 0 ? offset : offset + static_cast<std::uint32_t>(cuts[cut - 1].second);
  }
};

Joined without_continuations(std::string_view glsl) {
  Joined joined;
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < glsl.size();) {
    const std::size_t cut = continuation_at(glsl, i);
    if (cut == 0) {
      joined.glsl += glsl[i++];
      continue;
    }
    left_out += cut;
    i += cut;
    joined.cuts.emplace_back(joined.glsl.size(), left_out);
  }
  return joined;
}

}  // namespace

std::vector<Token> tokenize(std::string_view glsl, std::uint32_t text, WordPool& pool) {
  Joined joined;
  if (glsl.find('\\') != std::string_view::npos) joined = without_continuations(glsl);
  if (joined.cuts.empty()) return Tokenizer(glsl, text).run();
  std::vector<Token> tokens = Tokenizer(pool.keep(std::move(joined.glsl)), text).run();
  std::size_t begin_cut = 0, end_cut = 0;
  for (Token& token : tokens) {
    token.begin = joined.original(token.begin, begin_cut);
    token.end = joined.original(token.end - 1, end_cut) + 1;
  }
  return tokens;
}

bool is_operator(std::string_view word) {
  return std::find(operators.begin(), operators.end(), word) != operators.end();
}

}  // namespace dmvv::compiler::snippet
