#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include "compiler/compile.h"
#include "compiler/reference/reference.h"
#include "runtime/runtime.h"

using namespace dmvv;

// A cube of half the size, embedded in the standard cube: no distance grid, no file.
const char* const scene_text = R"(<MVV>
  <OBJECT name="CORE"><REGION name="R.CORE" type="color" rgb="1 0.5 0"/></OBJECT>
  <OBJECT name="SHELL"><REGION name="R.SHELL" type="color" rgb="0 0 1">
    <EMBEDDED name="CORE" scale="0.5 0.5 0.5"/>
  </REGION></OBJECT>
</MVV>)";

TEST_CASE("the generated shader says what the scene says") {
  Diagnostics diagnostics;
  const auto scene = voml::read_scene("nested.voml", memory_files({{"nested.voml", scene_text}}), {}, diagnostics);
  REQUIRE_MESSAGE(scene, diagnostics.render());
  const auto module = compiler::lower(*scene, diagnostics);
  auto program = compiler::compile(module.value(), {}, diagnostics);
  REQUIRE(compiler::to_spirv(program.value(), compiler::Source::points));  // compiled, and checked by spirv-val
  auto device = runtime::Device::create({}).value();
  auto evaluator = runtime::Evaluator::create(device, *program).value();
  const std::vector<glm::dvec3> points{{0.4, 0, 0}, {0.6, 0, 0}, {1.1, 0, 0}};
  const std::vector<std::string> expected{"SHELL:R.SHELL[0]/CORE:R.CORE", "SHELL:R.SHELL", ""};
  const auto answers = evaluator.probe(points).value();
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(compiler::format_path(program->regions, answers[i].path) == expected[i]);
    CHECK(compiler::Reference(*module).evaluate(points[i]).path == answers[i].path);
  }
}
