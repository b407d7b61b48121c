// VOML text, lowered and compiled as far as GLSL. `<!-- file NAME` comments give further files, as in
// tests/diagnostics.
#include <map>

#include "compiler/compile.h"
#include "compiler/reference/reference.h"
#include "tests/fuzz/targets.h"
#include "tests/support/grids.h"
#include "voml/format.h"
#include "voml/scene.h"

namespace dmvv::fuzz {

namespace {

std::map<std::string, std::string> files_of(std::string_view text) {
  std::map<std::string, std::string> files{{"scene.voml", std::string(text)},
                                           {"ball.lxn", tests::sphere_lxn(3, 0.8)},
                                           {"plane.lxn", tests::plane_lxn(2)},
                                           {"s.txt", "0 0 0\n0.1 0.2 0.3\n"}};
  constexpr std::string_view mark = "<!-- file ";
  for (std::size_t at = text.find(mark); at != std::string_view::npos; at = text.find(mark, at + 1)) {
    const std::string_view rest = text.substr(at + mark.size());
    const std::size_t end_of_name = rest.find('\n');
    if (end_of_name == std::string_view::npos) break;
    const std::string_view body = rest.substr(end_of_name + 1);
    files[std::string(rest.substr(0, end_of_name))] = body.substr(0, body.find("-->"));
  }
  return files;
}

void check_layout(const std::string& text) {
  Diagnostics diagnostics;
  const auto once = voml::format_document(diagnostics.add_source("scene.voml", text), diagnostics);
  must(once.has_value() == !diagnostics.has_errors(), "a layout or an error");
  if (!once) return;
  const auto twice = voml::format_document(diagnostics.add_source("once.voml", *once), diagnostics);
  must(twice == once, "the layout of a layout is the same");
}

}  // namespace

void run_voml(std::string_view bytes) {
  if (bytes.size() > 20000) return;
  check_layout(std::string(bytes));
  Diagnostics diagnostics;
  auto scene = voml::read_scene("scene.voml", memory_files(files_of(bytes)), {"", bytes.size() % 2 == 0}, diagnostics);
  must(scene.has_value() == !diagnostics.has_errors(), "a scene or an error");
  must(!scene || !diagnostics.has_errors() || !diagnostics.render().empty(), "errors are told");
  if (!scene) return;
  auto module = compiler::lower(std::move(*scene), diagnostics);
  must(module.has_value() == !diagnostics.has_errors(), "a module or an error");
  if (!module || !compiler::can_evaluate(*module, diagnostics)) return;
  const compiler::Reference reference(*module);
  for (const double x : {-0.3, 0.0, 0.7, 1.0}) must(reference.evaluate({x, 0.2, x}).finished, "the reference answers");
  for (const auto codegen : {compiler::Codegen::specialised, compiler::Codegen::table}) {
    compiler::CompileOptions options;
    options.codegen = codegen;
    const auto program = compiler::compile(*module, options, diagnostics);
    must(program.has_value() == !diagnostics.has_errors(), "a program or an error");
  }
}

}  // namespace dmvv::fuzz
