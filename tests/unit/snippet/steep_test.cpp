// How steep snippets are: bounds that no pair of points exceeds, and that are tight where mathematics says what they
// are.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/time_values.h"
#include "tests/support/random.h"
#include "tests/unit/snippet/corpus.h"
#include "tests/unit/snippet/program_of.h"

using namespace dmvv;
using namespace dmvv::compiler::snippet;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const Box cube{glm::dvec3(-1.0), glm::dvec3(1.0)};
const Interval day{0.0, 86400000.0};

Steepness of(const std::string& body) { return snippet_of(body).steepness(cube, day); }

glm::dvec3 point_in(tests::Random& random, const Box& box) {
  glm::dvec3 p;
  for (int k = 0; k < 3; ++k) p[k] = std::round(random.in(box.lo[k], box.hi[k]) * 0x1p22) * 0x1p-22;  // a float32
  return p;
}

/// No pair of points, near or far, differs by more; no float32 evaluation is farther off.
void check_bounds(const Snippet& snippet, const Box& box, tests::Random& random) {
  const Steepness bound = snippet.steepness(box, day);
  const double size = glm::length(box.hi - box.lo);
  for (int round = 0; round < 200; ++round) {
    const glm::dvec3 p = point_in(random, box);
    const double near = std::pow(10.0, random.in(-4.0, 0.0)) * size;
    const glm::dvec3 q = glm::clamp(p + near * (point_in(random, {glm::dvec3(-1.0), glm::dvec3(1.0)})), box.lo, box.hi);
    const double t = random.in(day.lo, day.hi);
    const double fp = snippet.evaluate(p, t).f, fq = snippet.evaluate(q, t).f;
    CAPTURE(bound.slope);
    CAPTURE(fp);
    CAPTURE(fq);
    if (bound.slope < infinity) REQUIRE(std::abs(fp - fq) <= bound.slope * glm::distance(p, q) * (1.0 + 1e-9) + 1e-12);
    if (bound.slope < infinity && !snippet.uses_time()) {
      const auto& program = snippet.time_split().residual;
      const float f = evaluate_point<float>(program, {float(p.x), float(p.y), float(p.z), 0.0f}).f;
      REQUIRE(std::abs(double{f} - fp) <= bound.error);
    }
  }
}

}  // namespace

TEST_CASE("what is known exactly: distances have the slope 1") {
  for (const char* body : {"return length(p) - 0.5;", "return p.x;", "return max(-p.y, length(p - vec3(0.2)) - 0.98);",
                           "return abs(length(p.xz) - 0.3) - 0.1;",
                           "vec3 q = vec3(0.6 * p.x + 0.8 * p.y, 0.6 * p.y - 0.8 * p.x, p.z); return length(q) - 0.2;",
                           "return length(p) - 0.3 - 0.1 * sin(0.001 * t);"}) {
    CAPTURE(body);
    CHECK(of(body).slope == doctest::Approx(1.0).epsilon(1e-6));
    CHECK(of(body).error < 1e-5);
  }
  CHECK(of("return 2.0 * p.x - p.y;").slope == doctest::Approx(std::sqrt(5.0)));
  CHECK(of("return sin(5.0 * p.z);").slope == doctest::Approx(5.0));
  CHECK(of("return 0.25;").slope == 0.0);
}

TEST_CASE("what jumps, or may be infinitely steep, is not known") {
  for (const char* body :
       {"return p.x < 0.0 ? 1.0 : 2.0;", "return fract(3.0 * p.x);", "return floor(p.y);", "return sqrt(abs(p.x));",
        "return 1.0 / p.x;", "return atan(p.y, p.x);", "return p.x == 0.0 ? p.y : p.z;"}) {
    CAPTURE(body);
    CHECK(of(body).slope == infinity);
  }
}

TEST_CASE("no pair of points differs by more than a bound says, no float32 value is farther off") {
  tests::Random random(11);
  int known = 0;
  for (const tests::Entry& entry : tests::corpus()) {
    CAPTURE(entry.name);
    check_bounds(entry.snippet, cube, random);
    known += entry.snippet.steepness(cube, day).slope < infinity ? 1 : 0;
    for (int i = 0; i < 20; ++i) {  // where fewer things happen more is known
      const glm::dvec3 center = point_in(random, cube);
      const double half = std::pow(10.0, random.in(-3.0, -0.5));
      check_bounds(entry.snippet, {glm::max(center - half, -1.0), glm::min(center + half, 1.0)}, random);
    }
  }
  CHECK(known > 20);
}
