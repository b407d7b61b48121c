#include "compiler/glsl/generate_glsl.h"
#include "compiler/glsl/glsl_text.h"
#include "compiler/layout/flatten.h"
#include "compiler/program_file.h"
#include "compiler/snippet/glsl_literal.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>

#include "tests/support/scene_table.h"

using namespace dmvv;
using compiler::Codegen;
using compiler::CompileOptions;

namespace {

const std::string& pixels(const compiler::Program& program) { return program.shader("pixels").glsl; }

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string without_comments(const std::string& text) {
  std::string code;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find('\n', i), text.size());
    const std::size_t comment = std::min(text.find("//", i), end);
    code += text.substr(i, comment - i) + '\n';
    i = end + 1;
  }
  return code;
}

}  // namespace

TEST_CASE("float literals read back as the same value and are floats to GLSL") {
  for (const float value : {0.0f, -0.0f, 1.0f, -3.0f, 0.1f, 1e-30f, 1e30f, 16777216.0f, 1.1754944e-38f}) {
    const std::string text = compiler::glsl_float(value);
    CAPTURE(text);
    CHECK(std::strtof(text.c_str(), nullptr) == value);
    CHECK(text.find_first_of(".e") != std::string::npos);
  }
}

TEST_CASE("every conformance scene compiles and validates in every form") {
  for (const auto& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    const auto module = tests::lowered(scene.text, scene.files);
    CompileOptions options;
    tests::compiled(module, options);
    options.codegen = Codegen::table;
    tests::compiled(module, options);
    options.codegen = Codegen::specialised;
    options.inlined_line_budget = 150;  // cuts somewhere in the larger ones
    tests::compiled(module, options);
    for (const auto& pass : compiler::pass_names()) options.disabled_passes.emplace_back(pass.name);
    options.inlined_line_budget = 1000;
    tests::compiled(module, options);
  }
}

TEST_CASE("what a scene does not need is not in its shader") {
  const auto cube = tests::compiled(tests::lowered(tests::conformance_scene("cube").text));
  CHECK(cube.buffers.empty());
  CHECK(cube.textures.empty());
  CHECK_FALSE(has(pixels(cube), "grid_atlas"));
  CHECK_FALSE(has(pixels(cube), "bitmap_atlas"));

  const auto& ball = tests::conformance_scene("ball");
  const auto program = tests::compiled(tests::lowered(ball.text, ball.files));
  CHECK(program.buffers.empty());
  REQUIRE(program.textures.size() == 1);
  CHECK(program.textures[0].extent == glm::uvec3(26));  // 24 and a border, no power of two
  CHECK_FALSE(has(pixels(program), "in_cube(q)"));      // the identity needs no box test
}

TEST_CASE("specialised code loops over instances of one object instead of repeating it") {
  const auto& scene = tests::conformance_scene("embedded seeds");
  const auto program = tests::compiled(tests::lowered(scene.text, scene.files));
  std::size_t calls = 0;
  for (std::size_t at = 0; (at = pixels(program).find("object_1_listed(q", at)) != std::string::npos; ++at) ++calls;
  CHECK(calls == 2);  // in the loop, whether it answers, and behind it, what
  CHECK(program.statistics.scene.candidates == 300);
}

TEST_CASE("loops ask whether a candidate answers; what it answers comes behind them, unless that is switched off") {
  const auto& scene = tests::conformance_scene("objects of a shape and strangers in one list");
  const auto module = tests::lowered(scene.text, scene.files);
  const std::string text = pixels(tests::compiled(module));
  const std::size_t ring = text.find("bool answers = inside || (negative_");  // in its ball, and not in its hole
  REQUIRE(ring != std::string::npos);
  CHECK(has(text.substr(ring, text.find('\n', ring) - ring), " && !negative_"));
  CHECK(has(text, "// BLOCK\nbool object_"));
  CHECK(has(text, "bool answers = inside || true;"));  // BLOCK answers everywhere
  const std::string holder = text.substr(text.find("// HOLDER\n"), 40);
  CHECK(has(holder, "void object_"));  // what it embeds decides whether it answers
  CHECK_FALSE(has(text, "// HOLDER\nbool "));
  CompileOptions options;
  options.disabled_passes = {"sink-answers"};
  CHECK_FALSE(has(pixels(tests::compiled(module, options)), "_listed"));
}

TEST_CASE("objects without parameters of their own are in no family, whatever else their list holds") {
  const auto& scene = tests::conformance_scene("objects of a shape and strangers in one list");
  const auto module = tests::lowered(scene.text, scene.files);
  const auto program = tests::compiled(module);
  CHECK(has(pixels(program), "if (family == 1u) "));
  CHECK_FALSE(has(pixels(program), "if (family == 0u) "));
}

TEST_CASE("beyond the budget objects are cut, at last the root") {
  const auto module = tests::lowered(tests::chain_scene(40, 0.9), {{"ball.lxn", tests::sphere_lxn(8, 0.8)}});
  CompileOptions options;
  options.inlined_line_budget = 400;
  const auto program = tests::compiled(module, options);
  CHECK(program.statistics.code.inlined_lines <= 400);
  CHECK(program.statistics.objects.front().form == "specialised");
  CHECK(has(program.statistics.objects.back().form, "table"));
  options.inlined_line_budget = 1;
  CHECK(has(tests::compiled(module, options).statistics.objects.front().form, "table"));
}

TEST_CASE("neither long trees nor chains of objects nest: both stay specialised") {
  const std::map<std::string, std::string> ball{{"ball.lxn", tests::sphere_lxn(8, 0.8)}};
  const auto deepest_nesting = [](const std::string& glsl) {
    int depth = 0, deepest = 0;
    for (const char c : glsl) {
      depth += c == '{' ? 1 : c == '}' ? -1 : 0;
      deepest = std::max(deepest, depth);
    }
    return deepest;
  };
  const auto specialised = [&](const std::string& text) {
    CompileOptions options;
    options.inlined_line_budget = 4000;
    const auto program = tests::compiled(tests::lowered(text, ball), options);
    for (const compiler::ObjectForm& object : program.statistics.objects) CHECK(has(object.form, "specialised"));
    return deepest_nesting(pixels(program));
  };
  CHECK(specialised(tests::chain_scene(12, 0.9)) == specialised(tests::chain_scene(3, 0.9)));
  CHECK(specialised(tests::deep_tree_scene(64)) == specialised(tests::deep_tree_scene(17)));
}

TEST_CASE("a diamond of objects does not grow exponentially") {
  std::string text = "<MVV><OBJECT name='D0'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT>";
  for (int i = 1; i <= 30; ++i) {
    text += fmt::format(
        "<OBJECT name='D{0}'><REGION name='R' type='color' rgb='1 0 0'><EMBEDDED name='D{1}' scale='0.5 0.5 "
        "0.5'/></REGION>"
        "<REGION name='Q' type='color' rgb='1 0 0'><EMBEDDED name='D{1}' scale='0.5 0.5 0.5'/></REGION><SDF name='S' "
        "file='p.lxn'/><MAPPINGS><SDF name='S'><POSITIVE region='R'/><NEGATIVE region='Q'/></SDF></MAPPINGS></OBJECT>",
        i, i - 1);
  }
  const auto program = tests::compiled(tests::lowered(text + "</MVV>", {{"p.lxn", tests::plane_lxn()}}));
  CHECK(program.statistics.code.inlined_lines <= 1000);
  CHECK(program.statistics.code.glsl_lines < 2000);
}

TEST_CASE("the same scene gives the same bytes") {
  for (const auto& scene : tests::conformance_scenes()) {
    const auto module = tests::lowered(scene.text, scene.files);
    const auto a = tests::compiled(module), b = tests::compiled(module);
    CHECK(compiler::write_program(a) == compiler::write_program(b));
    CHECK(compiler::records_text(a) == compiler::records_text(b));
  }
}

TEST_CASE("limits of the device are diagnostics that name them") {
  const auto& scene = tests::conformance_scene("ball");
  CompileOptions options;
  options.max_extent_3d = 16;
  Diagnostics atlas;
  CHECK_FALSE(compiler::compile(tests::lowered(scene.text, scene.files), options, atlas));
  CHECK(atlas.all().at(0).code == Code::atlas_too_large);

  options = {};
  options.codegen = Codegen::table;
  options.max_storage_buffer = 10;
  Diagnostics buffers;
  CHECK_FALSE(compiler::compile(tests::lowered(scene.text, scene.files), options, buffers));
  CHECK(buffers.all().at(0).code == Code::buffer_too_large);

  Diagnostics deep;
  CHECK_FALSE(compiler::compile(
      tests::lowered(tests::chain_scene(300, 0.99), {{"ball.lxn", tests::sphere_lxn(2, 0.8)}}), {}, deep));
  CHECK(deep.all().at(0).code == Code::embedding_too_deep);
}

TEST_CASE("identical snippets are stitched once, whatever their names and spaces") {
  const auto module = tests::lowered(
      "<MVV><OBJECT name='A'><SDF name='S' function='true'>float r = 0.5; return length(p) - r;</SDF>"
      "<SDF name='T' scale='0.5 0.5 0.5' function='true'>float radius = 0.5;\n  return length(p) - radius;</SDF>"
      "<REGION name='X' type='color' rgb='1 0 0'/><REGION name='Y' type='color' rgb='1 0 0'/><MAPPINGS><SDF name='S'>"
      "<POSITIVE region='X'/><NEGATIVE><SDF name='T'><POSITIVE region='X'/><NEGATIVE "
      "region='Y'/></SDF></NEGATIVE></SDF>"
      "</MAPPINGS></OBJECT></MVV>");
  CHECK(module.functions.size() == 2);
  const auto program = tests::compiled(module);
  CHECK(program.statistics.scene.functions == 1);
  CHECK(has(pixels(program), "float function_0("));
  CHECK_FALSE(has(pixels(program), "function_1"));
}

TEST_CASE("a static scene has no time anywhere in its shader, a moving one reads what was computed for the frame") {
  const auto& still = tests::conformance_scene("analytic");
  CHECK_FALSE(has(pixels(tests::compiled(tests::lowered(still.text, still.files))), "time_values"));
  const auto& moving = tests::conformance_scene("analytic, moving");
  const auto program = tests::compiled(tests::lowered(moving.text, moving.files));
  CHECK(has(pixels(program), "time_values[0]"));
  CHECK_FALSE(has(without_comments(pixels(program)), "sin("));  // sin(t / 1000) depends on time alone
  REQUIRE_FALSE(program.time_slots.empty());
  bool has_sine = false;
  for (const float value : compiler::snippet::time_values(program.time_slots, 3600000.0)) {
    const double sine = std::sin(3600000.0 * 0.001);
    for (const double expected : {sine, 0.3 * sine, 0.5 + 0.3 * sine}) {
      has_sine = has_sine || std::abs(value - expected) < 1e-6;
    }
  }
  CHECK(has_sine);
}

TEST_CASE("a mistake in a snippet stops the lowering at its place") {
  Diagnostics diagnostics;
  auto scene = tests::read(
      "<MVV><OBJECT name='A'>\n<SDF name='S' function='true'>return lenght(p) - 0.5;</SDF><REGION name='R' "
      "type='color' "
      "rgb='1 0 0'/></OBJECT></MVV>");
  CHECK_FALSE(compiler::lower(std::move(scene), diagnostics));
  REQUIRE(diagnostics.all().size() == 1);
  CHECK(diagnostics.all()[0].message.find("'length'") != std::string::npos);
}

TEST_CASE("seeds that only scale and move are stored and applied as such") {
  const auto scene = [](const std::string& rotate) {
    return tests::lowered(
        "<MVV><OBJECT name='A'><SDF name='S' function='true' type='seeding' seedFile='s.txt' rotate='" + rotate +
            "' scale='0.1 0.1 0.1'>return length(p) - 0.5;</SDF><REGION name='R' type='color' rgb='1 0 "
            "0'/></OBJECT></MVV>",
        {{"s.txt", "0 0 0\n0.5 0 0\n0 0.5 0\n"}});
  };
  const auto plain = tests::compiled(scene("0 0 0"));
  CHECK(has(pixels(plain), "vec3 q = p * scaling.w + scaling.xyz;"));
  CHECK_FALSE(has(pixels(plain), "buffer buffer_placements"));
  CHECK(has(pixels(tests::compiled(scene("0 0 30"))), "buffer buffer_placements"));
  CompileOptions options;
  options.disabled_passes = {"fold-affine"};
  CHECK_FALSE(has(pixels(tests::compiled(scene("0 0 0"), options)), "buffer buffer_scalings"));
}

TEST_CASE("objects of a group that differ in numbers share a function; with the pass off each has its own") {
  std::string text = "<MVV>";
  for (const char* radius : {"0.5", "0.7", "0.9"}) {
    text += fmt::format(
        "<OBJECT name='BALL{0}'><SDF name='S' function='true'>return length(p) - {0};</SDF><REGION name='IN' "
        "type='color' "
        "rgb='1 0 0'/></OBJECT>",
        radius);
  }
  text += "<OBJECT name='ROOT'><REGION name='R' type='empty'>";
  for (const char* radius : {"0.5", "0.7", "0.9"})
    text += fmt::format("<EMBEDDED name='BALL{}' scale='0.5 0.5 0.5'/>", radius);
  const auto module = tests::lowered(text + "</REGION><MAPPINGS><REGION name='R'/></MAPPINGS></OBJECT></MVV>");
  const auto united = tests::compiled(module);
  CHECK(has(pixels(united), "_united(row, q, level + 1u, true);"));
  CHECK_FALSE(has(pixels(united), "if (object == "));
  CompileOptions options;
  options.disabled_passes = {"unite-shapes"};
  const auto apart = tests::compiled(module, options);
  CHECK_FALSE(has(pixels(apart), "_united"));
  CHECK(has(pixels(apart), "if (object == "));
}
