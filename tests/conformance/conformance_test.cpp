// One table of scenes and points, run on every evaluator: the double reference, and each form of generated code on a
// Vulkan device with validation on. Answers that the reference calls certain must be the same, paths included.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>

#include "compiler/ir/legend.h"
#include "compiler/reference/reference.h"
#include "runtime/runtime.h"
#include "tests/support/agreement.h"
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
std::vector<glm::dvec3> points_of(std::uint64_t seed, int count = 3000) {
  tests::Random random(seed);
  std::vector<glm::dvec3> points{{0, 0, 0}, {1, 1, 1}, {-1, -1, -1}, {1, 0, 0}, {0, -1, 0.5}, {1.5, 0, 0}, {NAN, 0, 0}};
  for (int i = 0; i < count; ++i) points.push_back(glm::dvec3(glm::vec3(random.point(-1.05, 1.05))));
  for (int i = 0; i < count / 10; ++i) {
    glm::dvec3 p(glm::vec3(random.point()));
    p[i % 3] = i % 2 ? 1.0 : -1.0;
    points.push_back(p);
  }
  return points;
}

void check_answers(const compiler::Module& module, const compiler::Reference& reference,
                   const compiler::Program& program, const std::vector<glm::dvec3>& points, double time_ms,
                   const std::vector<compiler::PointAnswer>& answers) {
  const auto legend = compiler::legend(module);
  std::size_t certain = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto expected = reference.evaluate(points[i], time_ms);
    if (!expected.certain) continue;
    ++certain;
    const auto difference = tests::compare(legend, expected, program.regions, answers[i]);
    if (!difference) continue;
    CAPTURE(points[i].x);
    CAPTURE(points[i].y);
    CAPTURE(points[i].z);
    CAPTURE(difference->expected);
    FAIL_CHECK(difference->got);
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
    for (const tests::Setting& setting : tests::agreeing_settings()) {
      CAPTURE(setting.name);
      const auto program = tests::compiled(module, setting.options);
      auto evaluator = runtime::Evaluator::create(device, program);
      REQUIRE(evaluator);
      for (const double time_ms : tests::times_of(program)) {
        CAPTURE(time_ms);
        const auto answers = evaluator->probe(points, time_ms);
        REQUIRE(answers);
        REQUIRE(answers->size() == points.size());
        check_answers(module, compiler::Reference(module), program, points, time_ms, *answers);
      }
    }
  }
  for (const auto& message : device.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("every filter and format gives what the reference reads from the same texels") {
  runtime::Device device = open_device();
  const bool is_swiftshader = device.info().name.starts_with("SwiftShader");
  const auto points = points_of(43, 1000);
  for (const auto& scene : tests::conformance_scenes()) {
    const auto module = tests::lowered(scene.text, scene.files);
    if (module.grids.empty() || scene.name == "chain of 20") continue;  // the chain of 6 tells as much, in less time
    CAPTURE(scene.name);
    for (const tests::Setting& setting : tests::grid_settings()) {
      CAPTURE(setting.name);
      const bool is_large =
          scene.name == "a tree of 24 decisions" || scene.name == "seeds of a shape in chains of decisions";
      if (is_swiftshader && is_large && setting.options.filter == compiler::Filter::tricubic) {
        MESSAGE("left out: SwiftShader's compiler ends the process on large tricubic kernels (spec/accuracy.md)");
        continue;
      }
      auto passed = module;
      compiler::run_passes(passed, setting.options);
      const compiler::Reference reference(passed, tests::reading_of(setting));
      const auto program = tests::compiled(module, setting.options);
      auto evaluator = runtime::Evaluator::create(device, program);
      REQUIRE(evaluator);
      const auto answers = evaluator->probe(points);
      REQUIRE(answers);
      check_answers(passed, reference, program, points, 0.0, *answers);
    }
  }
  for (const auto& message : device.validation_messages()) FAIL_CHECK(message);
}

namespace {

/// The device either says that it ran out of loop rounds, or every answer is this region.
void check_rounds(const std::string& text, const std::map<std::string, std::string>& files,
                  const std::vector<glm::dvec3>& points, std::uint32_t region) {
  const auto module = tests::lowered(text, files);
  runtime::Device device = open_device();
  for (const tests::Setting& setting : tests::agreeing_settings()) {
    CAPTURE(setting.name);
    const auto program = tests::compiled(module, setting.options);
    auto evaluator = runtime::Evaluator::create(device, program);
    REQUIRE(evaluator);
    const auto answers = evaluator->probe(points);
    if (answers) {
      for (const auto& answer : *answers) CHECK(answer.number == region);
    } else {
      CHECK(answers.error().message.find("round") != std::string::npos);
    }
  }
}

std::string repeated(const std::string& line, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += line;
  return text;
}

}  // namespace

// Lavapipe grants a group of points 65,535 loop rounds in all.

TEST_CASE("a list longer than the device's loop rounds is reported, not guessed") {
  check_rounds(
      "<MVV><OBJECT name='E'><REGION name='R' type='empty'/></OBJECT><OBJECT name='A'><REGION name='R' type='color' "
      "rgb='1 0 0'><EMBEDDED name='E' seedFile='s.txt'/></REGION></OBJECT></MVV>",
      {{"s.txt", repeated("0 0 0\n", 70000)}}, std::vector<glm::dvec3>(8, glm::dvec3(0.1)), 1);
}

TEST_CASE("lists in lists that are too long together are reported, for each point of a group") {
  // On the left 300 objects of 300 empty ones each; on the right 300 objects, the last of which is the region 1.
  const std::string text =
      "<MVV><OBJECT name='E'><REGION name='R' type='empty'/></OBJECT>"
      "<OBJECT name='M'><REGION name='R' type='empty'><EMBEDDED name='E' seedFile='m.txt'/></REGION></OBJECT>"
      "<OBJECT name='F'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT>"
      "<OBJECT name='A'><REGION name='R' type='empty'>"
      "<EMBEDDED name='M' seedFile='a.txt' scale='0.5 0.5 0.5'/>"
      "<EMBEDDED name='E' seedFile='b.txt' scale='0.5 0.5 0.5'/>"
      "<EMBEDDED name='F'/></REGION></OBJECT></MVV>";
  std::vector<glm::dvec3> points(8, glm::dvec3(-0.6, 0.1, 0.1));
  points[3].x = 0.6;
  check_rounds(text,
               {{"m.txt", repeated("0 0 0\n", 300)},
                {"a.txt", repeated("-0.25 0 0\n", 300)},
                {"b.txt", repeated("0.25 0 0\n", 300)}},
               points, 1);
}

TEST_CASE("a group of points, each in a long list of its own, is answered or reported") {
  // Eight balls of 10,000 beads each; every point lies in another ball, between its beads: the ball's own region, 2.
  std::string places;
  std::vector<glm::dvec3> points;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      for (const double z : {-0.5, 0.5}) {
        places += fmt::format("{} {} {}\n", x / 2, y / 2, z / 2);  // fractions of the cube's edge
        points.emplace_back(x + 0.1, y, z);
      }
    }
  }
  const std::string text =
      "<MVV>"
      "<OBJECT name='BEAD'><SDF name='S' function='true'>return length(p) - 0.9;</SDF>"
      "<REGION name='R.OUT' type='empty'/><REGION name='R.BEAD' type='color' rgb='0 1 0'/><MAPPINGS name='BEAD'>"
      "<SDF name='S'><POSITIVE region='R.OUT'/><NEGATIVE region='R.BEAD'/></SDF></MAPPINGS></OBJECT>"
      "<OBJECT name='BALL'><SDF name='S' function='true'>return length(p) - 0.9;</SDF>"
      "<REGION name='R.BALL' type='color' rgb='1 0 0'><EMBEDDED name='BEAD' seedFile='beads.txt' scale='0.1 0.1 0.1'/>"
      "</REGION><REGION name='R.OUT' type='empty'/><MAPPINGS name='BALL'>"
      "<SDF name='S'><POSITIVE region='R.OUT'/><NEGATIVE region='R.BALL'/></SDF></MAPPINGS></OBJECT>"
      "<OBJECT name='ALL'><REGION name='R.ALL' type='color' rgb='0 0 1'>"
      "<EMBEDDED name='BALL' seedFile='balls.txt' scale='0.4 0.4 0.4'/></REGION></OBJECT></MVV>";
  check_rounds(text, {{"beads.txt", repeated("-0.25 0 0\n", 10000)}, {"balls.txt", places}}, points, 2);
}
