#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

namespace dmvv {
namespace {

char to_upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
char to_lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

constexpr std::string_view separators = " \t\r\n,";
constexpr std::string_view typographic_minus = "\xe2\x88\x92";

/// std::from_chars reports underflow and overflow alike; an exponent below zero can only be the former.
bool underflows(std::string_view token) {
  const std::size_t exponent = token.find_first_of("eE");
  return exponent != std::string_view::npos && token.substr(exponent + 1).starts_with('-');
}

bool is_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
}

/// "0.5" for "0,5" and for "-0,5" with a typographic minus; nothing if that makes no number of the word.
std::optional<std::string> mended_number(std::string_view word) {
  std::string mended(word);
  if (mended.starts_with(typographic_minus)) mended.replace(0, typographic_minus.size(), "-");
  const std::size_t comma = mended.find(',');
  if (comma != std::string::npos && comma + 1 < mended.size()) mended[comma] = '.';
  return mended != word && is_number(mended) ? std::optional(mended) : std::nullopt;
}

/// The end of a message about a text that is no vector: how it would be one, if decimal commas, typographic minus signs
/// or semicolons between the numbers are all that is wrong with it.
std::string hint_at_vector(std::string_view text) {
  std::string mended;
  std::size_t count = 0;
  for (std::size_t i = 0; count <= 3; ++count) {
    i = text.find_first_not_of(" \t\r\n;", i);
    if (i == std::string_view::npos) break;
    const std::size_t end = std::min(text.find_first_of(" \t\r\n;", i), text.size());
    std::string_view word = text.substr(i, end - i);
    if (word.ends_with(',') && count < 2) word.remove_suffix(1);  // "0,5, 0,5, 0,5"
    const auto number = is_number(word) ? std::optional(std::string(word)) : mended_number(word);
    if (!number) return {};
    mended += (count == 0 ? "" : " ") + *number;
    i = end;
  }
  if (count != 3) return {};
  const bool commas = text.find(',') != std::string_view::npos,
             minus = text.find(typographic_minus) != std::string_view::npos;
  return fmt::format("; {}: write {}",
                     commas  ? "decimal numbers have a point"
                     : minus ? "the minus is '-'"
                             : "blanks part the numbers",
                     in_quotes(mended));
}

/// The number that is exactly `token`, which stands at `begin` of the text.
std::variant<double, NumberFault> parse_token(std::string_view token, std::size_t begin) {
  using Kind = NumberFault::Kind;
  const auto fault = [&](Kind kind, const std::string& what) {
    return NumberFault{kind, begin, begin + token.size(), fmt::format("{} {}", in_quotes(token), what)};
  };
  std::string_view digits = token;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    return fault(Kind::not_a_number, "is not a number" + hint_at_number(token));
  }
  if (error == std::errc::result_out_of_range && underflows(digits)) return 0.0;
  const bool fits = std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max());  // false for NaN
  if (error == std::errc::result_out_of_range || !fits)
    return fault(Kind::not_finite, "is not a finite float32 number");
  return value;
}

}  // namespace

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return to_lower(x) == to_lower(y); });
}

std::string upper_case(std::string_view word) {
  std::string result(word);
  std::transform(result.begin(), result.end(), result.begin(), to_upper);
  return result;
}

std::string lower_case(std::string_view word) {
  std::string result(word);
  std::transform(result.begin(), result.end(), result.begin(), to_lower);
  return result;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 80;
  if (text.size() <= longest) return fmt::format("'{}'", text);
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80u) --end;  // not inside a code point
  return fmt::format("'{}...'", text.substr(0, end));
}

std::string shortened_chain(const std::vector<std::string_view>& links) {
  constexpr std::size_t shown_at_each_end = 6;
  const std::size_t hidden = links.size() <= 2 * shown_at_each_end ? 0 : links.size() - 2 * shown_at_each_end;
  std::string result;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (i != 0) result += " -> ";
    if (hidden != 0 && i == shown_at_each_end) {
      result += fmt::format("({} more) -> ", hidden);
      i += hidden;
    }
    result += links[i];
  }
  return result;
}

std::variant<double, NumberFault> parse_number(std::string_view text) {
  const std::string_view token = trim(text);
  if (token.empty()) return NumberFault{NumberFault::Kind::not_a_number, 0, text.size(), "there is no number"};
  return parse_token(token, static_cast<std::size_t>(token.data() - text.data()));
}

std::string hint_at_number(std::string_view word) {
  const auto number = mended_number(word);
  if (!number) return {};
  const bool comma = word.find(',') != std::string_view::npos;
  return fmt::format("; {}: write {}", comma ? "decimal numbers have a point" : "the minus is '-'", *number);
}

namespace {

std::variant<glm::dvec3, NumberFault> three_numbers(std::string_view text) {
  glm::dvec3 result;
  glm::length_t count = 0;
  std::size_t i = 0;
  bool comma = false;  // between the number before and the one to come
  const auto wrong_count = [&](std::size_t begin, std::size_t end, std::string message) {
    return NumberFault{NumberFault::Kind::wrong_count, begin, end, std::move(message)};
  };
  for (;;) {
    while (i < text.size() && (is_blank(text[i]) || text[i] == ',')) {
      if (text[i] == ',' && (comma || count == 0 || count == 3)) {
        return wrong_count(i, i + 1, "there is no number beside this comma");
      }
      comma = comma || text[i] == ',';
      ++i;
    }
    if (i == text.size()) break;
    const std::size_t end = std::min(text.find_first_of(separators, i), text.size());
    if (count == 3) return wrong_count(i, end, "there are more than three numbers");
    const auto value = parse_token(text.substr(i, end - i), i);
    if (const auto* fault = std::get_if<NumberFault>(&value)) return *fault;
    result[count++] = std::get<double>(value);
    comma = false;
    i = end;
  }
  if (count < 3)
    return wrong_count(0, text.size(), fmt::format("there {} {} of 3 numbers", count == 1 ? "is" : "are", count));
  return result;
}

}  // namespace

std::variant<glm::dvec3, NumberFault> parse_vector(std::string_view text) {
  auto result = three_numbers(text);
  const auto* const fault = std::get_if<NumberFault>(&result);
  if (!fault || fault->kind == NumberFault::Kind::not_finite) return result;
  const std::string hint = hint_at_vector(text);
  if (hint.empty()) return result;
  return NumberFault{fault->kind, 0, text.size(),
                     fmt::format("{} are not three numbers{}", in_quotes(trim(text)), hint)};
}

bool usable_scale(double component) {
  return std::abs(component) >= static_cast<double>(std::numeric_limits<float>::min());
}

}  // namespace dmvv
