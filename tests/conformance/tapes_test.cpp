// Large snippets as tapes: the passes `tapes` and `shorten-tapes`, before and after. Same answers, and what they save.
#include "compiler/layout/tapes.h"
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <algorithm>
#include <string>
#include "bench/workload.h"
#include "compiler/ir/legend.h"
#include "compiler/layout/tape_cells.h"
#include "compiler/reference/reference.h"
#include "runtime/runtime.h"
#include "shaders/records.h"
#include "tests/support/agreement.h"
#include "tests/support/scene_table.h"

using namespace dmvv;
using compiler::CompileOptions;

namespace {

runtime::Device open_device() {
  auto device = runtime::Device::create({.name = "", .validation = true});
  if (!device) FAIL("no Vulkan device: " << device.error().message);
  return std::move(*device);
}

CompileOptions without(std::initializer_list<const char*> passes) {
  CompileOptions options;
  for (const char* pass : passes) options.disabled_passes.emplace_back(pass);
  return options;
}

/// Whatever can be a tape is one.
CompileOptions all_tapes(std::initializer_list<const char*> disabled_passes = {}) {
  CompileOptions options = without(disabled_passes);
  options.tapes.least_size = 0;
  options.tapes.walking_cost = 0.0;
  return options;
}

compiler::Module large_snippet(std::uint32_t operations) {
  const bench::SceneSource source = bench::large_snippet(operations);
  return tests::lowered(*source.files(source.path, 1u << 24));
}

/// A cube of one boundary.
std::string scene_of(const std::string& body, const std::string& attributes = "") {
  return "<MVV><OBJECT name='A'><SDF name='S' function='true' " + attributes + "><![CDATA[" + body +
         "]]></SDF><REGION name='IN' type='color' rgb='1 0 0'/><REGION name='OUT' type='color' rgb='0 0 1'/><MAPPINGS>"
         "<SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT></MVV>";
}

std::vector<glm::dvec3> points_of(std::uint64_t seed, int count) {
  tests::Random random(seed);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i) {
    glm::dvec3 p(glm::vec3(random.point(-1.02, 1.02)));
    if (i % 10 == 0) p[i / 10 % 3] = std::round(p[i / 10 % 3] * 64.0) / 64.0;  // on the border of cells
    points.push_back(p);
  }
  return points;
}

/// How many of the certain answers the device gives otherwise.
std::size_t count_wrong(const compiler::Module& module, const compiler::Program& program, runtime::Device& device,
                        const std::vector<glm::dvec3>& points) {
  const compiler::Reference reference(module);
  const auto legend = compiler::legend(module);
  auto evaluator = runtime::Evaluator::create(device, program);
  REQUIRE(evaluator);
  std::size_t wrong = 0;
  for (const double time_ms : tests::times_of(program)) {
    const auto answers = evaluator->probe(points, time_ms);
    REQUIRE_MESSAGE(answers, answers.error().message);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto expected = reference.evaluate(points[i], time_ms);
      if (expected.certain && tests::compare(legend, expected, program.regions, (*answers)[i])) ++wrong;
    }
  }
  return wrong;
}

runtime::Picture slice(const compiler::Program& program, runtime::Device& device, double z) {
  auto evaluator = runtime::Evaluator::create(device, program);
  REQUIRE(evaluator);
  runtime::View view;
  view.size_px = {256, 256};
  view.slice = runtime::Plane{{0.0, 0.0, 1.0}, z};
  view.want_regions = true;
  auto picture = evaluator->render(view);
  REQUIRE(picture);
  return std::move(*picture);
}

bool has_tape(const compiler::Program& program) {
  return program.shader("points").glsl.find("walk_tape") != std::string::npos;
}

}  // namespace

TEST_CASE(
    "a snippet of 8,000 operations is a tape: no certain answer is wrong, every pixel is that of the written code") {
  const compiler::Module module = large_snippet(8000);
  CHECK(module.functions[0].snippet.instruction_count() >= 8000);
  runtime::Device device = open_device();
  const auto points = points_of(3, 3000);
  const auto written = tests::compiled(module, without({"tapes"}));
  CHECK_FALSE(has_tape(written));
  CHECK(count_wrong(module, written, device, points) == 0);
  CompileOptions table;
  table.codegen = compiler::Codegen::table;
  for (const CompileOptions& options : {CompileOptions{}, table, without({"shorten-tapes"})}) {
    const auto program = tests::compiled(module, options);
    CHECK(has_tape(program));
    CHECK(count_wrong(module, program, device, points) == 0);
    if (!options.disabled_passes.empty()) continue;
    for (const double z : {0.0, 0.004}) {
      const auto expected = slice(written, device, z), picture = slice(program, device, z);
      CHECK(picture.regions == expected.regions);
      CHECK(picture.rgba == expected.rgba);
    }
  }
  for (const auto& message : device.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("an expression of 7,866 operations, one a line, is a tape, and device and reference agree") {
  const std::string body = bench::expression_text(7866);
  CHECK(std::ranges::count(body, '\n') == 7866);
  const compiler::Module module = tests::lowered(scene_of(body));
  runtime::Device device = open_device();
  const auto program = tests::compiled(module, {});
  CHECK(has_tape(program));
  CHECK(count_wrong(module, program, device, points_of(5, 3000)) == 0);
  const compiler::Reference reference(module);
  std::size_t ink = 0;
  for (const glm::dvec3& p : points_of(6, 3000)) ink += reference.evaluate(p).number == 1 ? 1 : 0;
  CHECK(ink > 100);
  CHECK(ink < 1500);
  CHECK(reference.evaluate({0.99, 0.99, 0.0}).number == 2);
}

TEST_CASE("what is too large to be code, and cannot be a tape, is refused with the reason") {
  std::string body = "float d = 4.0;\n";
  // An array whose element the point chooses is no tape.
  body += "float a[2]; a[0] = p.x; a[1] = p.y; d = a[int(p.z > 0.0)];\n";
  for (int i = 0; i < 70'000; ++i) body += fmt::format("d = min(d, p.x + {}.5);\n", i);
  Diagnostics diagnostics;
  const auto program = compiler::compile(tests::lowered(scene_of(body + "return d;")), {}, diagnostics);
  CHECK_FALSE(program);
  REQUIRE(diagnostics.all().size() == 1);
  CHECK(info(diagnostics.all()[0].code).number == "E0430");
  CHECK(diagnostics.all()[0].message.find("an array of it is read or written where the point or the time decides") !=
        std::string::npos);
  CHECK(diagnostics.all()[0].span.source.valid());
}

TEST_CASE("shorten-tapes leaves nothing to do in most cells, and little in the others") {
  const compiler::Module module = large_snippet(8000);
  const auto whole = compiler::make_tapes(module, {.shorten = false});
  const auto cells = compiler::make_tapes(module, {});
  REQUIRE(whole.functions[0].is_tape);
  CHECK(whole.cells.size() == 1);
  const std::uint32_t whole_length = whole.words[whole.cells[0]].x;
  CHECK(whole_length >= 8000);
  std::uint64_t instructions = 0;
  std::uint32_t longest = 0;
  for (const std::uint32_t cell : cells.cells) {
    instructions += cells.words[cell].x;
    longest = std::max(longest, cells.words[cell].x);
  }
  MESSAGE(cells.functions[0].note);
  CHECK(longest * 20 < whole_length);
  CHECK(instructions < cells.cells.size());  // less than one a cell, on average
  CHECK(cells.registers < 32);
  const auto again = compiler::make_tapes(module, {});
  CHECK(again.cells == cells.cells);
  CHECK(again.words == cells.words);
}

TEST_CASE("whatever snippets a scene has, as tapes they answer like the reference") {
  runtime::Device device = open_device();
  const auto points = points_of(5, 1000);
  std::size_t taped = 0;
  for (const auto& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    const auto module = tests::lowered(scene.text, scene.files);
    if (module.functions.empty()) continue;
    CompileOptions options = all_tapes();
    for (const auto codegen : {compiler::Codegen::specialised, compiler::Codegen::table}) {
      options.codegen = codegen;
      const auto program = tests::compiled(module, options);
      taped += has_tape(program) ? 1 : 0;
      CHECK(count_wrong(module, program, device, points) == 0);
    }
  }
  CHECK(taped > 10);
}

TEST_CASE("snippets that move, shift the boundary, give no number, or branch are as tapes what they are") {
  runtime::Device device = open_device();
  const auto points = points_of(9, 2000);
  const std::string exits =
      "if (p.x < -0.5) return length(p) - 0.9; if (p.y < 0.0) return p.z; return p.z - 0.3 * p.x;";
  struct Hostile {
    std::string name, body;
  };
  const Hostile hostile[] = {
      {"sqrt that has no value in half of the cube", "return sqrt(p.x) - 0.5;"},
      {"NaN from a quotient", "return p.x / p.x - 2.0 + max(p.y, 0.0) * 2.0;"},
      {"a product that overflows", "return p.x * 1e38 * 1e3 - p.y * 1e38 * 1e3;"},
      {"minimum of what may be NaN", "return min(sqrt(p.x), p.y);"},
      {"zero that is divided by", "return 1.0 / (p.x * max(p.y, 0.0)) - 4.0;"},
      {"early returns", exits},
      {"loop",
       "float d = 9.0; for (int i = 0; i < 6; ++i) d = min(d, length(p - vec3(0.3 * float(i) - 0.8)) - 0.1); return "
       "d;"},
      {"loop that the point ends",
       "float s = 0.1; for (int i = 0; i < 20; ++i) { if (s > p.x) break; s += 0.1; } return s - 0.7;"},
      {"moving", "return length(p - 0.4 * vec3(sin(t / 700.0), cos(t / 900.0), 0.0)) - 0.3;"},
      {"moving without bounds", "return fract(0.001 * t + p.x) - 0.5 + 0.1 * float(int(t / 250.0) % 3);"},
      {"whole numbers", "int i = int(floor(p.x * 4.0)); return float((i * 7 + 3) % 5) * 0.2 - 0.45 + 0.1 * p.y;"},
      {"all outside", "return 1.0 + p.x * p.x;"},
      {"the point itself", "return p.y;"},
      {"arcs", "return atan(p.y, p.x) * 0.2 + asin(p.z) * 0.1 - 0.1;"}};
  for (const Hostile& one : hostile) {
    CAPTURE(one.name);
    for (const std::string attributes : {"", "offset='0.05'"}) {
      const auto module = tests::lowered(scene_of(one.body, attributes));
      for (const CompileOptions& options : {all_tapes(), all_tapes({"shorten-tapes"})}) {
        const auto program = tests::compiled(module, options);
        CHECK(has_tape(program));
        CHECK(count_wrong(module, program, device, points) == 0);
      }
    }
  }
}

TEST_CASE("what cannot be a tape is written out and says so") {
  const auto program = tests::compiled(
      tests::lowered(scene_of("float s = p.x; while (s < 0.9) s += 0.25; return s - 1.0;")), all_tapes());
  CHECK_FALSE(has_tape(program));
  REQUIRE(program.statistics.tapes.size() == 1);
  CHECK(program.statistics.tapes[0].find("S: written out: a loop") == 0);
}

TEST_CASE("a snippet that intervals do not shorten is written out, as long as a driver can compile it") {
  std::string body = "float s = 0.0;";  // metaballs: every one counts everywhere
  for (int i = 0; i < 300; ++i)
    body += fmt::format("s += exp(-40.0 * dot(p - {0}, p - {0}));", "vec3(" + std::to_string(0.003 * i) + ")");
  const auto module = tests::lowered(scene_of(body + "return 0.5 - s;"));
  const auto tapes = compiler::make_tapes(module, {});
  CHECK_FALSE(tapes.any());
  CHECK(tapes.functions[0].note.find("written out: ") == 0);
  CHECK(compiler::make_tapes(module, {.most_written = 1000}).any());
}

TEST_CASE("when a budget is used up the cells that are left keep longer tapes, and stay right") {
  const compiler::Module module = large_snippet(3000);
  runtime::Device device = open_device();
  const auto& function = module.functions[0].snippet;
  const auto line = compiler::snippet::straighten(function.time_split());
  REQUIRE(line);
  const auto unlimited = compiler::shorten_for_cells(*line, {}, {}, {});
  const compiler::TapeOptions tight[] = {
      {.most_work = 500'000}, {.most_steps = 12'000}, {.most_cells = 4096}, {.most_work = 0}};
  tests::Random random(11);
  for (const compiler::TapeOptions& options : tight) {
    const auto cells = compiler::shorten_for_cells(*line, {}, {}, options);
    CHECK(cells.cells_a_side <= unlimited.cells_a_side);
    CHECK(cells.cells.size() <= options.most_cells);
    for (int i = 0; i < 500; ++i) {
      const glm::vec3 p(random.point());
      const auto at = glm::uvec3((glm::dvec3(p) + 1.0) * 0.5 * double(cells.cells_a_side));
      const std::uint32_t content = cells.cells[(at.z * cells.cells_a_side + at.y) * cells.cells_a_side + at.x];
      const float whole = compiler::snippet::evaluate_at<float>(*line, {p.x, p.y, p.z}, {});
      if (content >= 2) {
        CHECK(compiler::snippet::evaluate_at<float>(cells.lines[content - 2], {p.x, p.y, p.z}, {}) == whole);
      } else {
        CHECK((content == DMVV_TAPE_NEGATIVE) == (whole <= 0.0f));
      }
    }
  }
}
