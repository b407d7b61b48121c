#include "compiler/snippet/condition.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "compiler/snippet/preprocess.h"

namespace dmvv::compiler::snippet {
namespace {

struct Operator {
  std::string_view word;
  int precedence;  ///< the higher, the tighter it binds
};
constexpr std::array<Operator, 18> operators = {{{"||", 1},
                                                 {"&&", 2},
                                                 {"|", 3},
                                                 {"^", 4},
                                                 {"&", 5},
                                                 {"==", 6},
                                                 {"!=", 6},
                                                 {"<", 7},
                                                 {">", 7},
                                                 {"<=", 7},
                                                 {">=", 7},
                                                 {"<<", 8},
                                                 {">>", 8},
                                                 {"+", 9},
                                                 {"-", 9},
                                                 {"*", 10},
                                                 {"/", 10},
                                                 {"%", 10}}};

int precedence_of(const Token& token) {
  const auto found =
      std::find_if(operators.begin(), operators.end(), [&](const Operator& o) { return token.is(o.word); });
  return found == operators.end() ? 0 : found->precedence;
}

std::int64_t wrapped(std::uint64_t bits) { return static_cast<std::int64_t>(bits); }

class Evaluator {
 public:
  explicit Evaluator(std::span<const Token> tokens) : tokens_(tokens) {}

  std::variant<std::int64_t, ConditionFault> run() {
    const std::int64_t value = expression(1, true);
    if (at_ < tokens_.size())
      fail(&tokens_[at_], fmt::format("'{}' cannot stand here in a condition", tokens_[at_].word));
    if (fault_) return *fault_;
    return value;
  }

 private:
  /// The first fault is the one that counts; reading goes to the end at once.
  std::int64_t fail(const Token* token, std::string message) {
    if (!fault_) fault_ = ConditionFault{token, std::move(message)};
    at_ = tokens_.size();
    return 0;
  }

  /// Operators of at least this precedence. `counts`: whether the value matters.
  std::int64_t expression(int precedence, bool counts) {
    std::int64_t left = operand(counts);
    while (at_ < tokens_.size()) {
      const Token& op = tokens_[at_];
      const int binds = precedence_of(op);
      if (binds < precedence || binds == 0) break;
      ++at_;
      const bool decided = (op.is("||") && left != 0) || (op.is("&&") && left == 0);
      const std::int64_t right = expression(binds + 1, counts && !decided);
      left = counts ? apply(op, left, right) : 0;
    }
    return left;
  }

  std::int64_t operand(bool counts) {
    if (++depth_ > max_brackets)
      return fail(nullptr, fmt::format("this condition is nested more than {} deep", max_brackets));
    const std::int64_t value = nested_operand(counts);
    --depth_;
    return value;
  }

  std::int64_t nested_operand(bool counts) {
    if (at_ == tokens_.size()) return fail(nullptr, "this condition ends where a number is missing");
    const Token& token = tokens_[at_++];
    if (token.kind == Token::Kind::number) return number(token);
    if (token.is("+")) return operand(counts);
    if (token.is("-")) return wrapped(0 - static_cast<std::uint64_t>(operand(counts)));
    if (token.is("~")) return ~operand(counts);
    if (token.is("!")) return operand(counts) == 0 ? 1 : 0;
    if (token.is("(")) {
      const std::int64_t value = expression(1, counts);
      if (at_ == tokens_.size() || !tokens_[at_].is(")")) return fail(&token, "'(' is never closed by ')'");
      ++at_;
      return value;
    }
    if (!token.is_identifier()) return fail(&token, fmt::format("'{}' cannot stand here in a condition", token.word));
    if (!counts) return 0;
    return fail(&token, fmt::format("'{0}' is no macro here, and GLSL takes no unknown name for 0; ask 'defined({0})', "
                                    "or write '#define {0} 0' before",
                                    token.author));
  }

  std::int64_t number(const Token& token) {
    std::string_view digits = token.word;
    if (digits.ends_with('u') || digits.ends_with('U')) digits.remove_suffix(1);
    int base = 10;
    if (digits.starts_with("0x") || digits.starts_with("0X")) {
      base = 16;
      digits.remove_prefix(2);
    } else if (digits.size() > 1 && digits.starts_with('0')) {
      base = 8;
    }
    std::uint64_t value = 0;
    const char* const end = digits.data() + digits.size();
    const auto [rest, error] = std::from_chars(digits.data(), end, value, base);
    if (error == std::errc::result_out_of_range) return fail(&token, "this number is larger than 64 bits hold");
    if (error != std::errc() || rest != end) {
      return fail(&token, fmt::format("'{}' is no whole number; a condition computes with whole numbers", token.word));
    }
    return wrapped(value);
  }

  std::int64_t apply(const Token& op, std::int64_t a, std::int64_t b) {
    const auto ua = static_cast<std::uint64_t>(a), ub = static_cast<std::uint64_t>(b);
    if (op.is("||")) return a != 0 || b != 0 ? 1 : 0;
    if (op.is("&&")) return a != 0 && b != 0 ? 1 : 0;
    if (op.is("|")) return a | b;
    if (op.is("^")) return a ^ b;
    if (op.is("&")) return a & b;
    if (op.is("==")) return a == b ? 1 : 0;
    if (op.is("!=")) return a != b ? 1 : 0;
    if (op.is("<")) return a < b ? 1 : 0;
    if (op.is(">")) return a > b ? 1 : 0;
    if (op.is("<=")) return a <= b ? 1 : 0;
    if (op.is(">=")) return a >= b ? 1 : 0;
    if (op.is("+")) return wrapped(ua + ub);
    if (op.is("-")) return wrapped(ua - ub);
    if (op.is("*")) return wrapped(ua * ub);
    if (op.is("<<") || op.is(">>")) {
      if (b < 0 || b > 63) return fail(&op, fmt::format("'{}' moves by 0 to 63 bits, not by {}", op.word, b));
      return op.is("<<") ? wrapped(ua << ub) : a >> b;
    }
    if (b == 0) return fail(&op, "this condition divides by zero");
    if (b == -1) return op.is("/") ? wrapped(0 - ua) : 0;  // the smallest number has no opposite
    return op.is("/") ? a / b : a % b;
  }

  std::span<const Token> tokens_;
  std::size_t at_ = 0;
  std::size_t depth_ = 0;
  std::optional<ConditionFault> fault_;
};

}  // namespace

std::variant<std::int64_t, ConditionFault> evaluate_condition(std::span<const Token> tokens) {
  return Evaluator(tokens).run();
}

}  // namespace dmvv::compiler::snippet
