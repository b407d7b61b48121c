// The snippets of tests/snippets on every evaluator: double, interval, dual, and the emitted GLSL, read back and on the
// device.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "compiler/compile.h"
#include "corpus.h"
#include "device_program.h"
#include "emitted.h"
#include "runtime/runtime.h"

using namespace dmvv;
using namespace dmvv::tests;
using namespace dmvv::compiler::snippet;

namespace {

constexpr double times_ms[] = {1250.0, 4321.5, 3'600'000.0};

bool holds(const Interval& interval, double value) {
  return std::isnan(value) ? interval.maybe_nan : interval.lo <= value && value <= interval.hi;
}

void set_time(compiler::Program& program, const Snippet& snippet, double t_ms) {
  const std::vector<float> times = times_of(snippet, t_ms);
  REQUIRE(program.buffers[0].bytes.size() == times.size() * sizeof(float));
  std::memcpy(program.buffers[0].bytes.data(), times.data(), program.buffers[0].bytes.size());
}

/// Emits and reads back until glslang finds no constants to fold any more.
Snippet fold(Snippet snippet) {
  for (;;) {
    Snippet next = tests::snippet(read_back(snippet, 0.0));
    if (next.instruction_count() >= snippet.instruction_count()) return next;
    snippet = next;
  }
}

}  // namespace

TEST_CASE("the corpus is a corpus") { CHECK(corpus().size() >= 60); }

TEST_CASE("corpus: every value is a number, and intervals hold it") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const Entry& entry : corpus()) {
    const auto& name = entry.name;
    const Snippet& snippet = entry.snippet;
    CAPTURE(name);
    for (int round = 0; round < 60; ++round) {
      const double size = std::pow(10.0, -4.0 * unit(random)), t = times_ms[round % 3], span = 500.0 * unit(random);
      const auto corner = [&] { return unit(random) * (2.0 - size) - 1.0; };
      const glm::dvec3 lo(corner(), corner(), corner());
      const Box box{lo, lo + size};
      const Interval moments{t, t + span};
      const Interval real = snippet.evaluate(box, moments, Rounding::real);
      const Interval rounded = snippet.evaluate(box, moments, Rounding::float32);
      for (int i = 0; i < 8; ++i) {
        const glm::dvec3 p = lo + size * glm::dvec3(unit(random), unit(random), unit(random));
        const double at = t + span * unit(random);
        const Value value = snippet.evaluate(p, at);
        CHECK(value.finished);
        CHECK(std::isfinite(value.f));
        CHECK_MESSAGE(holds(real, value.f), fmt::format("{} in [{}, {}]", value.f, real.lo, real.hi));
        CHECK_MESSAGE(holds(rounded, value.f), fmt::format("{} in [{}, {}]", value.f, rounded.lo, rounded.hi));
      }
    }
  }
}

TEST_CASE("corpus: the gradient of dual numbers is that of differences") {
  // Kinks and jumps are where both one-sided differences disagree, and left out; they must stay the exception.
  // What bit operations and floor make has jumps only, and derivative zero between them.
  constexpr double h = 1e-6;
  for (const Entry& entry : corpus()) {
    const auto& name = entry.name;
    const Snippet& snippet = entry.snippet;
    CAPTURE(name);
    int compared = 0, left_out = 0;
    for (const glm::dvec3& p : points_of_cube(60)) {
      const double t = 1234.5;
      const Dual dual = snippet.differentiate(p, t);
      CHECK(dual.value == doctest::Approx(snippet.evaluate(p, t).f).epsilon(1e-12));
      for (int axis = 0; axis < 4; ++axis) {
        glm::dvec3 step(0.0);
        if (axis < 3) step[axis] = h;
        const double dt = axis == 3 ? 1e-3 : 0.0, length = axis == 3 ? 1e-3 : h;
        const double middle = snippet.evaluate(p, t).f;
        const double right = (snippet.evaluate(p + step, t + dt).f - middle) / length;
        const double left = (middle - snippet.evaluate(p - step, t - dt).f) / length;
        const double derivative = axis < 3 ? dual.gradient[axis] : dual.rate;
        const double scale = 1.0 + std::abs(derivative);
        if (std::abs(right - left) > 1e-3 * scale) {
          ++left_out;
          continue;
        }
        ++compared;
        CHECK_MESSAGE(std::abs(derivative - (left + right) / 2) <= 1e-3 * scale,
                      fmt::format("axis {} at {} {} {}", axis, p.x, p.y, p.z));
      }
    }
    CHECK(compared > 9 * left_out);
  }
}

TEST_CASE("corpus: the emitted GLSL says the same, in double") {
  // Reading it back, glslang rounds time values and what it folds of constants to float32: allowed is what float32
  // arithmetic may give. Once there is nothing left to fold, every bit stays.
  std::size_t unchanged = 0;
  for (const Entry& entry : corpus()) {
    const auto& name = entry.name;
    const Snippet& snippet = entry.snippet;
    CAPTURE(name);
    bool same = true;
    for (const double t : times_ms) {
      const Snippet again = tests::snippet(read_back(snippet, t)), folded = fold(again);
      const Snippet twice = tests::snippet(read_back(folded, 0.0));
      CHECK_FALSE(again.uses_time());
      for (const glm::dvec3& p : points_of_cube(60)) {
        const double expected = snippet.evaluate(p, t).f, got = again.evaluate(p, t).f;
        const Interval allowed = snippet.evaluate({p, p}, {t, t}, Rounding::float32);
        CHECK_MESSAGE(holds(allowed, got), fmt::format("{} in [{}, {}]", got, allowed.lo, allowed.hi));
        CHECK(twice.evaluate(p, 0.0).f == folded.evaluate(p, 0.0).f);
        CHECK(holds(allowed, folded.evaluate(p, 0.0).f));
        same = same && got == expected;
      }
    }
    if (same) ++unchanged;
  }
  CHECK(unchanged >= 60);
}

TEST_CASE("corpus: the device's values lie in the float32 intervals") {
  auto opened = runtime::Device::create({.name = "", .validation = true});
  REQUIRE_MESSAGE(opened, opened.error().message);
  const std::vector<glm::dvec3> points = points_of_cube(256);
  for (const Entry& entry : corpus()) {
    const auto& name = entry.name;
    const Snippet& snippet = entry.snippet;
    CAPTURE(name);
    compiler::Program program = points_program(snippet);
    const auto compiled = compiler::to_spirv(program, compiler::Source::points);
    REQUIRE_MESSAGE(compiled, (compiled ? std::string() : compiled.error().reasons.at(0)));
    int loose = 0;
    for (const double t : times_ms) {
      if (t > times_ms[0] && !snippet.uses_time()) continue;
      set_time(program, snippet, t);
      auto evaluator = runtime::Evaluator::create(*opened, program);
      REQUIRE_MESSAGE(evaluator, evaluator.error().message);
      const auto answers = evaluator->probe(points);
      REQUIRE_MESSAGE(answers, answers.error().message);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double got = answers->at(i).rgba.r;
        const Interval allowed = snippet.evaluate({points[i], points[i]}, {t, t}, Rounding::float32);
        CHECK_MESSAGE(holds(allowed, got), fmt::format("{} in [{}, {}], {} in double", got, allowed.lo, allowed.hi,
                                                       snippet.evaluate(points[i], t).f));
        if (allowed.hi - allowed.lo > 0.15) ++loose;
      }
    }
    CHECK(static_cast<std::size_t>(loose) < points.size() / 2);  // nearly everywhere the bound says something
  }
  for (const std::string& message : opened->validation_messages()) FAIL_CHECK(message);
}
