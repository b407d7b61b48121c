#include <algorithm>
#include <glm/geometric.hpp>

#include "support.h"

using namespace dmvv;
using namespace dmvv::tests;

TEST_CASE("answers of points come back whole and in order") {
  const QuietValidation quiet;
  auto evaluator = must(runtime::Evaluator::create(device(), points_program(0.5f)));
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 300'000; ++i)
    points.push_back({(i % 1009) / 800.0, (i % 7) / 70.0, (i % 11) / -90.0});  // more than a batch
  const auto answers = must(evaluator.probe(points));
  REQUIRE(answers.size() == points.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = glm::length(points[i]);
    if (std::abs(r - 0.5) < 1e-6 || std::abs(r - 1.0) < 1e-6) continue;
    const std::uint32_t number = r < 0.5 ? 1 : r < 1.0 ? 2 : 0;
    std::vector<compiler::PathStep> path;
    for (std::uint32_t level = 0; level < number; ++level)
      path.push_back({10 * number + 2 * level, 10 * number + 2 * level + 1});
    const auto& answer = answers[i];
    wrong += answer.number != number || answer.path != path || !answer.finished ? 1 : 0;
    wrong += answer.rgba != glm::dvec4(glm::vec4(glm::vec3(points[i]), 1.0f)) ? 1 : 0;
  }
  CHECK(wrong == 0);
  CHECK(must(evaluator.probe({})).empty());
}

TEST_CASE("the device's own time of points grows with their number, also after a picture") {
  auto pictures = must(runtime::Evaluator::create(device(), program(Show::position)));
  runtime::View view;
  view.size_px = {64, 64};
  must(pictures.render(view));
  auto evaluator = must(runtime::Evaluator::create(device(), points_program(0.5f)));
  const auto device_ms = [&](std::size_t count) {
    runtime::Timings timings;
    must(evaluator.probe(std::vector<glm::dvec3>(count, glm::dvec3(0.1)), 0.0, &timings));
    const auto gpu = std::ranges::find(timings, runtime::gpu_step, &runtime::Timing::step);
    REQUIRE(gpu != timings.end());
    return gpu->ms;
  };
  device_ms(64);  // the driver's compilation is over
  CHECK(device_ms(262'144) > 3.0 * device_ms(64));
}

TEST_CASE("a point that the device could not finish is an error that names it") {
  const QuietValidation quiet;
  auto evaluator = must(runtime::Evaluator::create(device(), points_program(0.5f)));
  const std::vector<glm::dvec3> points{{0, 0, 0}, {60, 0, 0}, {70, 0, 0}};
  const auto answers = evaluator.probe(points);
  REQUIRE_FALSE(answers);
  CHECK(answers.error().fault == Fault::input);
  CHECK(answers.error().message.starts_with("2 of 3 points needed more loop rounds"));
  CHECK(answers.error().message.ends_with("the first is point 1"));
}

TEST_CASE("a kernel that was not compiled is missed by name") {
  auto evaluator = must(runtime::Evaluator::create(device(), points_program(0.5f)));
  const auto picture = evaluator.render({});
  REQUIRE_FALSE(picture);
  CHECK(picture.error().message.find("'pixels'") != std::string::npos);
}
