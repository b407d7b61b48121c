// Sines written out in a kernel's SPIR-V: against double, on a device that has to use them.
#include <algorithm>
#include <cmath>
#include <random>

#include "kernels/sines_points.h"
#include "runtime/gpu/gpu.h"
#include "runtime/gpu/own_sines.h"
#include "support.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

/// Answers of points have sin(x), cos(x), tan(x) as red, green, blue.
compiler::Program sines_program() {
  compiler::Program made = points_program(1.0f);
  made.kernels = {kernel_of(compiler::points_kernel, sines_points)};
  return made;
}

std::vector<glm::dvec3> arguments() {
  std::mt19937 random(5);
  std::vector<glm::dvec3> points;
  const auto add = [&](double x) { points.emplace_back(static_cast<double>(static_cast<float>(x)), 0.0, 0.0); };
  for (const double x : {0.0, -0.0, 1e-30, -1e-30, 1.5707963, 3.1415927, -3.1415927, 1e7, -1e7}) add(x);
  for (int i = 0; i < 20000; ++i) {
    const double unit = static_cast<double>(random()) * 0x1p-32;
    add(8.0 * unit - 4.0);
    add(std::exp2(24.0 * unit - 0.75) * (i % 2 == 0 ? 1.0 : -1.0));  // to 1e7
    add(3.14159265358979 * std::floor(3e6 * unit));                  // where they turn
  }
  return points;
}

}  // namespace

TEST_CASE("own sines are as good as the promise of accuracy assumes") {
  auto device = must(runtime::create_without_extras({.name = "", .validation = true}));
  auto evaluator = must(runtime::Evaluator::create(device, sines_program()));
  const auto points = arguments();
  const auto answers = must(evaluator.probe(points));
  double worst = 0.0, worst_tangent = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].x;
    if (std::abs(x) > 1e7) continue;
    const double bound = 0x1p-21 + 0x1p-24 * std::abs(x);
    const glm::vec4 got = answers[i].rgba;
    worst = std::max({worst, std::abs(got.r - std::sin(x)) / bound, std::abs(got.g - std::cos(x)) / bound});
    // A quotient of both: their errors, and those of rounding.
    const double slope = 1.0 + std::tan(x) * std::tan(x);
    if (bound * slope < 0.1)
      worst_tangent = std::max(worst_tangent, std::abs(got.b - std::tan(x)) / (2.5 * bound * slope));
  }
  MESSAGE("largest error as a share of its bound: ", worst, ", tan ", worst_tangent);
  CHECK(worst < 1.0);
  CHECK(worst_tangent < 1.0);
  for (const std::string& message : device.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("a kernel without sines stays as it is") {
  const compiler::Program program = points_program(1.0f);
  const auto& words = program.shader("points").spirv;
  CHECK(runtime::with_own_sines(words) == words);
  const compiler::Program sines = sines_program();
  const auto& all = sines.shader("points").spirv;
  CHECK(runtime::with_own_sines(all).size() > all.size());
}
