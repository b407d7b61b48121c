// Pieces of GLSL text: literals that read back as the same value, affine maps as expressions, and a writer of lines.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/ir/affine.h"

namespace dmvv::compiler {

/// `vec3(...)` of the values rounded to float32; one component where all three are equal.
std::string vec3_literal(const glm::dvec3& v);

/// Whether a transform turns nothing: with `fold` it is written without a matrix.
bool is_diagonal(const Affine& affine);

/// affine(p) as an expression; `fold` writes identities, translations and scalings as such.
std::string affine_expression(const Affine& affine, const std::string& p, bool fold);

/// Lines that are not blank or comments.
std::uint32_t code_lines(std::string_view text);

/// Text that grows by indented lines.
class GlslWriter {
 public:
  /// A line; each "{}" of the format is replaced in turn. GLSL's own braces need no escaping.
  template <class... Args>
  void line(std::string_view format, Args&&... args) {
    if (!format.empty()) text_ += std::string(indentation_, ' ') + substitute(format, {std::string(args)...});
    text_ += '\n';
  }

  /// A line that begins a block: `head {`.
  void open(const std::string& head) {
    line(head.empty() ? "{" : "{} {", head);
    indentation_ += 2;
  }
  /// From the block of a condition into that of its other side.
  void otherwise() {
    indentation_ -= 2;
    line("} else {");
    indentation_ += 2;
  }
  void close() {
    indentation_ -= 2;
    line("}");
  }

  std::string take() { return std::exchange(text_, {}); }

 private:
  static std::string substitute(std::string_view format, const std::vector<std::string>& args);

  std::string text_;
  std::size_t indentation_ = 0;
};

}  // namespace dmvv::compiler
