// Words and numbers of attributes and seed files.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace dmvv {

/// Equality without regard to the case of ASCII letters.
bool same_word(std::string_view a, std::string_view b);

std::string upper_case(std::string_view word);
std::string lower_case(std::string_view word);

bool is_blank(char c);
std::string_view trim(std::string_view text);

/// The text in single quotes, cut to a length that fits a message.
std::string in_quotes(std::string_view text);

/// "A -> B -> C"; the middle of a long chain is counted, not listed.
std::string shortened_chain(const std::vector<std::string_view>& links);

/// Why a text is not the number or vector it should be; [begin, end) is the part of the text that is at fault.
struct NumberFault {
  enum class Kind { not_a_number, wrong_count, not_finite } kind;
  std::size_t begin;
  std::size_t end;
  std::string message;
};

/// One number (C locale, '+' allowed), blanks around it. Not finite: infinities, NaN, magnitudes beyond float32.
std::variant<double, NumberFault> parse_number(std::string_view text);

/// What to write instead of a word that should be a number, as the end of a message: "; decimal numbers have a point:
/// write 0.5" for "0,5"; empty where nothing is known.
std::string hint_at_number(std::string_view word);

/// Three numbers, separated by blanks or by one comma with or without blanks.
std::variant<glm::dvec3, NumberFault> parse_vector(std::string_view text);

/// Whether a finite scale component has an inverse that shaders can use: not zero, not below the smallest normal float.
bool usable_scale(double component);

}  // namespace dmvv
