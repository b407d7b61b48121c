#include "compiler/glsl/glsl_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "compiler/snippet/glsl_literal.h"

namespace dmvv::compiler {

std::string vec3_literal(const glm::dvec3& v) {
  const glm::vec3 f(v);
  if (f.x == f.y && f.y == f.z) return fmt::format("vec3({})", glsl_float(f.x));
  return fmt::format("vec3({}, {}, {})", glsl_float(f.x), glsl_float(f.y), glsl_float(f.z));
}

bool is_diagonal(const Affine& a) {
  const glm::dmat3& m = a.linear;
  return m[0].y == 0 && m[0].z == 0 && m[1].x == 0 && m[1].z == 0 && m[2].x == 0 && m[2].y == 0;
}

namespace {

glm::dvec3 diagonal(const Affine& a) { return {a.linear[0].x, a.linear[1].y, a.linear[2].z}; }

}  // namespace

std::string affine_expression(const Affine& affine, const std::string& p, bool fold) {
  const bool diagonal_only = fold && is_diagonal(affine);
  const bool scales = !diagonal_only || diagonal(affine) != glm::dvec3(1.0);
  const bool moves = !fold || affine.translation != glm::dvec3(0.0);
  std::string text = p;
  if (scales && diagonal_only) text = fmt::format("{} * {}", p, vec3_literal(diagonal(affine)));
  if (scales && !diagonal_only) {
    const glm::mat3 m(affine.linear);
    std::string entries;
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row) entries += (entries.empty() ? "" : ", ") + glsl_float(m[column][row]);
    }
    text = fmt::format("mat3({}) * {}", entries, p);
  }
  if (moves) text += fmt::format(" + {}", vec3_literal(affine.translation));
  return text;
}

std::uint32_t code_lines(std::string_view text) {
  std::uint32_t lines = 0;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string_view::npos && !line.substr(first).starts_with("//")) ++lines;
  }
  return lines;
}

std::string GlslWriter::substitute(std::string_view format, const std::vector<std::string>& args) {
  std::string text;
  std::size_t next = 0;
  for (std::size_t i = 0; i < format.size(); ++i) {
    if (format.substr(i, 2) == "{}") {
      text += args[next++];
      ++i;
    } else {
      text += format[i];
    }
  }
  return text;
}

}  // namespace dmvv::compiler
