// Inside compiler/snippet: the numbers of long texts, kept from glslang. For each number it looks through all different
// ones before it, so a text of 100,000 statements would take minutes; in their place it sees elements of one array.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace dmvv::compiler::snippet {

/// Numbers of type float, each once, in the order of their first use.
class Literals {
 public:
  /// Texts with fewer numbers are better off without.
  static constexpr std::size_t least = 4096;

  /// What stands for a number in the text: an element of the array, or the number itself if the array is full.
  std::string place_of(std::string_view number);

  bool empty() const { return values_.empty(); }

  /// Declares the array, and tells the values in a comment: the text is a key of caches. Empty without numbers.
  std::string declaration() const;

  /// The module that glslang made of such a text, with constants in place of the array.
  std::vector<std::uint32_t> put_back(std::vector<std::uint32_t> spirv) const;

 private:
  std::unordered_map<std::string, std::size_t> numbers_;  ///< by their text
  std::vector<float> values_;
  std::string texts_;
};

/// Is the text of a number that of a float, and not of an integer?
bool is_float_literal(std::string_view number);

}  // namespace dmvv::compiler::snippet
