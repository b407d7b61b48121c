// What the compiler prints of small scenes, compared with texts that were read and understood when they were committed.
// A change of the generator shows here as a difference to explain. DMVV_UPDATE_GOLDENS=1 writes them anew.
#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "compiler/layout/flatten.h"
#include "tests/support/scene_table.h"

using namespace dmvv;

namespace {

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void check_golden(const std::string& name, const std::string& actual) {
  const std::string path = std::string(DMVV_SOURCE_DIR) + "/tests/golden/expected/" + name;
  if (std::getenv("DMVV_UPDATE_GOLDENS")) std::ofstream(path, std::ios::binary) << actual;
  const std::string expected = slurp(path);
  if (expected == actual) return;
  const std::string left_behind = std::string(DMVV_BINARY_DIR) + "/tests/golden_" + name;
  std::ofstream(left_behind, std::ios::binary) << actual;
  FAIL_CHECK("differs from " << path << "; what came out: " << left_behind);
}

/// The scene's own part of a shader: what stands between the shared texts.
std::string scene_part(const std::string& glsl) {
  const std::size_t begin = glsl.find("// ---- the scene ----");
  const std::size_t end = glsl.find("// Kernel `");
  REQUIRE(begin != std::string::npos);
  REQUIRE(end != std::string::npos);
  return glsl.substr(begin, end - begin);
}

}  // namespace

TEST_CASE("dumps of small scenes") {
  for (const std::string name : {"ball", "boxed grid", "two levels, second comes back empty", "tiled embedding"}) {
    CAPTURE(name);
    const auto& scene = tests::conformance_scene(name);
    std::string file = name.substr(0, name.find(','));
    for (char& c : file) c = c == ' ' ? '_' : c;
    const auto module = tests::lowered(scene.text, scene.files);
    check_golden(file + ".module.txt", compiler::to_text(module));
    for (const auto codegen : {compiler::Codegen::specialised, compiler::Codegen::table}) {
      compiler::CompileOptions options;
      options.codegen = codegen;
      const auto program = tests::compiled(module, options);
      const std::string form = codegen == compiler::Codegen::table ? ".table" : ".specialised";
      check_golden(file + form + ".glsl", scene_part(program.shader("pixels").glsl));
      if (codegen == compiler::Codegen::table) check_golden(file + ".records.txt", compiler::records_text(program));
    }
  }
}
