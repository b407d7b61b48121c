// One table of scenes and points, run on every evaluator: the double reference, and each form of generated code on a
// Vulkan device with validation on. Answers that the reference calls certain must be the same, paths included.
#include <doctest/doctest.h>

#include <cmath>

#include "compiler/reference.h"
#include "runtime/runtime.h"
#include "tests/support/scene_table.h"

using namespace dmvv;

namespace {

runtime::Device open_device() {
  runtime::DeviceOptions options;
  options.validation = true;
  auto device = runtime::Device::create(options);
  if (!device) FAIL("no Vulkan device: " << device.error().message);
  return std::move(*device);
}

/// Random points, and points on cube faces, edges and centre planes, where rounding matters.
std::vector<glm::dvec3> points_of(std::uint64_t seed) {
  tests::Random random(seed);
  std::vector<glm::dvec3> points{{0, 0, 0}, {1, 1, 1}, {-1, -1, -1}, {1, 0, 0}, {0, -1, 0.5}, {1.5, 0, 0}, {NAN, 0, 0}};
  for (int i = 0; i < 3000; ++i) points.push_back(glm::dvec3(glm::vec3(random.point(-1.05, 1.05))));
  for (int i = 0; i < 300; ++i) {
    glm::dvec3 p(glm::vec3(random.point()));
    p[i % 3] = i % 2 ? 1.0 : -1.0;
    points.push_back(p);
  }
  return points;
}

/// A static scene is the same at all times; a moving one is looked at from its start to a day later.
std::vector<double> times_of(const compiler::Program& program) {
  if (program.time_functions.empty()) return {0.0};
  return {0.0, 16.7, 1234.5, 3600000.0, 86400000.0};
}

struct Setting {
  std::string name;
  compiler::CompileOptions options;
};

std::vector<Setting> settings() {
  std::vector<Setting> all{{"specialised", {}}, {"table", {}}, {"mixed", {}}, {"no passes", {}}};
  all[1].options.codegen = compiler::Codegen::table;
  all[2].options.inlined_line_budget = 200;
  for (const auto& pass : compiler::pass_names()) all[3].options.disabled_passes.emplace_back(pass.name);
  return all;
}

/// Compares by region names, since passes may renumber the regions of a module.
void compare(const compiler::Module& module, const compiler::Program& program,
             const std::vector<glm::dvec3>& points, double time_ms, const std::vector<compiler::PointAnswer>& answers) {
  const compiler::Reference reference(module);
  const auto legend = compiler::legend(module);
  std::size_t certain = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto expected = reference.evaluate(points[i], time_ms);
    if (!expected.certain) continue;
    ++certain;
    CAPTURE(points[i].x);
    CAPTURE(points[i].y);
    CAPTURE(points[i].z);
    CHECK(answers[i].number == expected.number);
    CHECK(compiler::format_path(program.regions, answers[i].path) == compiler::format_path(legend, expected.path));
    for (int c = 0; c < 4; ++c) CHECK(std::abs(answers[i].rgba[c] - expected.rgba[c]) < 1e-3);
  }
  CHECK(certain > points.size() * 8 / 10);  // faces of the cube are uncertain by nature, little else may be
}

}  // namespace

TEST_CASE("every evaluator gives the same region, path and colour") {
  runtime::Device device = open_device();
  for (const auto& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    const auto module = tests::lowered(scene.text, scene.files);
    const auto points = points_of(42);
    for (const Setting& setting : settings()) {
      CAPTURE(setting.name);
      const auto program = tests::compiled(module, setting.options);
      auto evaluator = runtime::Evaluator::create(device, program);
      REQUIRE(evaluator);
      for (const double time_ms : times_of(program)) {
        CAPTURE(time_ms);
        const auto answers = evaluator->probe(points, time_ms);
        REQUIRE(answers);
        REQUIRE(answers->size() == points.size());
        compare(module, program, points, time_ms, *answers);
      }
    }
  }
  for (const auto& message : device.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("a list longer than the device's loop rounds is reported, not guessed") {
  // 70,000 candidates in one cell that all come back empty: lavapipe grants 65,535 rounds.
  std::string seeds;
  for (int i = 0; i < 70000; ++i) seeds += "0 0 0\n";
  const auto module = tests::lowered(
      "<MVV><OBJECT name='E'><REGION name='R' type='empty'/></OBJECT><OBJECT name='A'><REGION name='R' type='color' "
      "rgb='1 0 0'><EMBEDDED name='E' seedFile='s.txt'/></REGION></OBJECT></MVV>",
      {{"s.txt", seeds}});
  runtime::Device device = open_device();
  for (const auto codegen : {compiler::Codegen::specialised, compiler::Codegen::table}) {
    compiler::CompileOptions options;
    options.codegen = codegen;
    const auto program = tests::compiled(module, options);
    auto evaluator = runtime::Evaluator::create(device, program);
    REQUIRE(evaluator);
    const auto answers = evaluator->probe(std::vector<glm::dvec3>(8, glm::dvec3(0.1)));
    if (answers) {
      for (const auto& answer : *answers) CHECK(answer.number == 1);  // a device without that limit gets it right
    } else {
      CHECK(answers.error().message.find("round") != std::string::npos);
    }
  }
}
