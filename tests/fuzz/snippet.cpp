// GLSL of analytic SDFs; what stands before a line `// ---- body` are FUNCTIONS, as in tests/snippets.
#include "compiler/snippet/snippet.h"

#include <cmath>

#include "tests/fuzz/targets.h"

namespace dmvv::fuzz {

namespace {

voml::GlslText text_of(std::string_view text) { return {std::string(text), {{0, {}}}}; }

}  // namespace

void run_snippet(std::string_view bytes) {
  if (bytes.size() > 20000) return;
  voml::Function function;
  constexpr std::string_view mark = "// ---- body\n";
  const std::size_t at = bytes.find(mark);
  if (at != std::string_view::npos) function.helpers.push_back(text_of(bytes.substr(0, at)));
  function.body = text_of(at == std::string_view::npos ? bytes : bytes.substr(at + mark.size()));
  Diagnostics diagnostics;
  const auto snippet = compiler::snippet::compile_snippet(function, diagnostics);
  must(snippet.has_value() == !diagnostics.has_errors(), "a snippet or an error");
  if (!snippet) return must(!diagnostics.render().empty(), "errors are told");
  const glm::dvec3 p(0.3, -0.2, 0.7);
  const auto value = snippet->evaluate(p, 16.0);
  const auto bounds = snippet->evaluate({p - 0.01, p + 0.01}, {16.0, 16.0}, compiler::snippet::Rounding::real);
  if (value.finished) {
    must(std::isnan(value.f) ? bounds.maybe_nan : bounds.lo <= value.f && value.f <= bounds.hi,
         "intervals hold values");
  }
  snippet->differentiate(p, 16.0);
  must(snippet->time_values(16.0).size() == snippet->time_value_count(), "as many time values as told");
  must(!snippet->glsl("f", 0).empty(), "a snippet can be written out");
}

}  // namespace dmvv::fuzz
