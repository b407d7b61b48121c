// The author's text becomes a Snippet in steps: it is prepared, put together as a shader, compiled, read, and tried at
// points.
#include <fmt/format.h>

#include <cmath>
#include <new>
#include <utility>

#include "compiler/snippet/assemble_shader.h"
#include "compiler/snippet/definitions.h"
#include "compiler/snippet/glslang_front.h"
#include "compiler/snippet/preprocess.h"
#include "compiler/snippet/probe_points.h"
#include "compiler/snippet/read_spirv.h"
#include "compiler/snippet/report_functions.h"
#include "compiler/snippet/report_log.h"
#include "compiler/snippet/report_unset.h"
#include "compiler/snippet/reporter.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler::snippet {
namespace {

/// The texts of a function with where they stand: its files, its object, its body.
Sources sources_of(const voml::Function& function) {
  Sources sources;
  if (function.files != nullptr) {
    for (const voml::FunctionFile& file : *function.files) sources.imports.push_back(file.imports);
  }
  const auto object = static_cast<std::uint32_t>(sources.imports.size());
  sources.imports.emplace_back();
  if (object > 0) sources.imports.back().push_back(object - 1);
  sources.imports.push_back({object});
  for (std::size_t i = 0; i < function.helpers.size(); ++i) {
    const voml::HelperPlace place = function.places.empty() ? voml::HelperPlace{object, 0} : function.places[i];
    const bool is_of_object = place.file == object;
    sources.texts.push_back(
        {function.helpers[i].text, place.file,
         is_of_object ? static_cast<std::uint32_t>(sources.imports[object].size()) : place.imports});
  }
  sources.texts.push_back({function.body.text, object + 1, 1});
  return sources;
}

bool is_small_enough(const voml::Function& function, Diagnostics& diagnostics) {
  std::vector<const voml::GlslText*> texts;
  for (const voml::GlslText& helper : function.helpers) texts.push_back(&helper);
  texts.push_back(&function.body);
  std::size_t bytes = 0;
  for (const voml::GlslText* text : texts) {
    bytes += text->text.size();
    if (bytes <= max_text_bytes) continue;
    diagnostics.report(Code::snippet_syntax, voml::locate(*text, 0, 1),
                       fmt::format("a function with its FUNCTIONS is at most {} bytes of text, up to the end of this "
                                   "element there are {}",
                                   max_text_bytes, bytes));
    return false;
  }
  return true;
}

void report_faults(const Prepared& prepared, Reporter& reporter) {
  for (const Fault& fault : prepared.faults) {
    std::vector<Note> notes;
    for (const FaultNote& note : fault.notes) notes.push_back({reporter.span_of(note.token), note.message});
    reporter.report(fault.code, fault.token, fault.message, std::move(notes));
  }
}

void report_unreadable(const Error& error, const Span& span, Diagnostics& diagnostics) {
  std::vector<Note> notes;
  for (const std::string& reason : error.reasons) notes.push_back({Span{}, reason});
  diagnostics.report(Code::snippet_refused, span, error.message, std::move(notes));
}

/// Tries the snippet where it will be asked: refuses loops that do not end, warns of values that are no distances.
void probe(const Snippet& snippet, Reporter& reporter) {
  std::string not_finite;
  for (const double t : probe_times(snippet.uses_time())) {
    for (const glm::dvec3& p : probe_points()) {
      const Value value = snippet.evaluate(p, t);
      if (!value.finished) {
        reporter.report(Code::snippet_runs_away, reporter.loop(),
                        fmt::format("a loop does not end within {} steps at {}", Snippet::step_budget,
                                    describe(p, t, snippet.uses_time())));
        return;
      }
      if (!std::isfinite(value.f) && not_finite.empty()) {
        not_finite = fmt::format("the distance is {} at {}", std::isnan(value.f) ? "not a number" : "infinite",
                                 describe(p, t, snippet.uses_time()));
      }
    }
  }
  if (!not_finite.empty()) reporter.warn(Code::snippet_not_finite, reporter.body_words(), std::move(not_finite));
}

std::optional<Snippet> compile(const voml::Function& function, Diagnostics& diagnostics, const CodeCache& cache) {
  if (!is_small_enough(function, diagnostics)) return std::nullopt;

  // 1. Tokens that are safe to compile.
  const Prepared prepared = prepare(sources_of(function));
  Reporter reporter(function, prepared, diagnostics);
  report_faults(prepared, reporter);
  if (!prepared.complete) return std::nullopt;

  // 2. glslang.
  const Shader shader = assemble_shader(prepared);
  const Compiled compiled = compile_vertex_shader(shader.glsl, shader.literals, cache);
  Definitions definitions(prepared);
  report_log(compiled.errors, prepared, shader, definitions, reporter);
  if (reporter.errors() == 0) report_missing_returns(compiled.spirv, definitions, reporter);
  if (reporter.errors() != 0) return std::nullopt;

  // 3. The program, tried.
  auto program = read_spirv(compiled.spirv);
  if (!program) {
    report_unreadable(program.error(), reporter.body_words(), diagnostics);
    return std::nullopt;
  }
  Snippet snippet(std::make_shared<const Program>(std::move(*program)));
  if (snippet.nesting() > Snippet::most_nested) {
    reporter.report(
        Code::snippet_nested_too_deeply, reporter.body_words(),
        fmt::format("conditions are nested {} deep, early returns counted; drivers follow {} with certainty: "
                    "search by halves, or choose with ?: or min and max",
                    snippet.nesting(), Snippet::most_nested));
    return std::nullopt;
  }
  probe(snippet, reporter);
  if (reporter.errors() != 0) return std::nullopt;
  report_unset(compiled.spirv, snippet.uses_time(), prepared, shader, reporter);
  return snippet;
}

}  // namespace

std::optional<Snippet> compile_snippet(const voml::Function& function, Diagnostics& diagnostics,
                                       const CodeCache& cache) {
  try {
    return compile(function, diagnostics, cache);
  } catch (const std::bad_alloc&) {
    diagnostics.report(Code::snippet_refused, function.span, "there is not enough memory to compile this function");
    return std::nullopt;
  }
}

}  // namespace dmvv::compiler::snippet
