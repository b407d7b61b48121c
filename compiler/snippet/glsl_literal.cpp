#include "compiler/snippet/glsl_literal.h"

#include <fmt/format.h>

namespace dmvv::compiler {

std::string glsl_float(float value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

}  // namespace dmvv::compiler
