// Presets, examples/library: each by itself and in other scenes.
#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>

#include "base/files.h"
#include "compiler/ir/legend.h"
#include "compiler/reference/lint.h"
#include "runtime/runtime.h"
#include "tests/cli/program.h"
#include "tests/random/points.h"
#include "tests/support/agreement.h"

using namespace dmvv;
namespace fs = std::filesystem;

namespace {

/// Every VOML file of the library but the board that shows them, with the object that it is named after.
std::map<std::string, std::string> presets() {
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::directory_iterator(DMVV_SOURCE_DIR "/examples/library")) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".voml" || name == "library") continue;
    std::string object;
    for (const char c : name) object += static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    found[entry.path().string()] = object;
  }
  return found;
}

}  // namespace

TEST_CASE("a preset checks clean, compiles to valid SPIR-V, and its shaders answer like the reference") {
  auto device = runtime::Device::create({.name = "", .validation = true});
  REQUIRE(device);
  const auto all = presets();
  CHECK(all.size() >= 7);
  for (const auto& preset : all) {
    const std::string path = preset.first, object = preset.second;
    CAPTURE(path);
    Diagnostics diagnostics;
    auto scene = voml::read_scene(path, disk_files(), {.root = "", .load_everything = true}, diagnostics);
    REQUIRE_MESSAGE(scene, diagnostics.render());
    const auto module = compiler::lower(std::move(*scene), diagnostics, {.check_everything = true});
    REQUIRE_MESSAGE(module, diagnostics.render());
    compiler::lint(*module, diagnostics);
    CHECK_MESSAGE(diagnostics.render().empty(), diagnostics.render());
    CHECK(at(module->objects, module->root).name == object);  // the last object of its file: what an import is for

    const compiler::Reference reference(*module);
    const auto legend = compiler::legend(*module);
    for (const tests::Setting& setting : tests::agreeing_settings()) {
      if (setting.name != "specialised" && setting.name != "table") continue;
      CAPTURE(setting.name);
      auto program = compiler::compile(*module, setting.options, diagnostics);
      REQUIRE_MESSAGE(program, diagnostics.render());
      REQUIRE(compiler::to_spirv(*program, compiler::Source::points));  // checked by spirv-val
      auto evaluator = runtime::Evaluator::create(*device, *program);
      REQUIRE(evaluator);
      for (const double time_ms : tests::times_of(*program)) {
        CAPTURE(time_ms);
        const auto points = tests::random_scenes::draw_points(*module, reference, time_ms, 1, 1000).all;
        const auto answers = evaluator->probe(points, time_ms);
        REQUIRE(answers);
        std::size_t certain = 0, wrong = 0;
        std::set<std::uint32_t> regions;
        for (std::size_t i = 0; i < points.size(); ++i) {
          const auto expected = reference.evaluate(points[i], time_ms);
          if (!expected.certain) continue;
          ++certain;
          regions.insert(expected.number);
          wrong += tests::compare(legend, expected, program->regions, (*answers)[i]) ? 1 : 0;
        }
        CHECK(wrong == 0);
        CHECK(certain > points.size() / 3);
        CHECK(regions.size() >= 3);  // empty and at least two regions: something was looked at
      }
    }
  }
  CHECK(device->validation_messages().empty());
}

TEST_CASE("a preset is embedded by a scene of the examples that imports it") {
  std::set<std::string> used;
  for (const auto& entry : fs::recursive_directory_iterator(DMVV_SOURCE_DIR "/examples")) {
    if (entry.path().extension() != ".voml") continue;
    const std::string text = tests::read_file(entry.path().string());
    for (const auto& [path, object] : presets()) {
      if (fs::path(path) == entry.path()) continue;
      const bool imports =
          std::regex_search(text, std::regex("<IMPORT file=\"[^\"]*\\b" + fs::path(path).filename().string() + "\""));
      if (imports && text.find("<EMBEDDED name=\"" + object + "\"") != std::string::npos) used.insert(object);
    }
  }
  for (const auto& preset : presets()) CHECK_MESSAGE(used.contains(preset.second), preset.second);
}
