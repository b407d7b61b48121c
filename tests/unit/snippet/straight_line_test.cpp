// Snippets without control flow: the same values as the program's, and as much shorter as intervals prove.
#include "compiler/snippet/straight_line.h"

#include <bit>
#include <cmath>
#include <glm/common.hpp>

#include "compiler/snippet/device_values.h"
#include "corpus.h"
#include "emitted.h"
#include "program_of.h"
#include "tests/support/random.h"

using namespace dmvv;
using namespace dmvv::tests;
using namespace dmvv::compiler::snippet;

namespace {

constexpr Interval all_times{-1e300, 1e300};

StraightLine line_of(const Snippet& snippet) {
  auto line = straighten(snippet.time_split());
  REQUIRE_MESSAGE(line, line.error().message);
  return std::move(*line);
}

/// Time values of one moment, as points.
std::vector<BoxValue> hoisted_at(const Snippet& snippet, double t_ms) {
  return device_values(snippet.time_split(), {t_ms, t_ms});
}

bool is_static(const Snippet& snippet) { return snippet.time_split().hoisted.empty(); }

/// The same bits, or both zero, or both no number.
bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || a == b || (a != a && b != b);
}

}  // namespace

TEST_CASE("a straight line has the values of its program") {
  std::size_t straight = 0, refused = 0;
  for (const Entry& entry : corpus()) {
    CAPTURE(entry.name);
    const auto line = straighten(entry.snippet.time_split());
    if (!line) {
      ++refused;
      const std::string& why = line.error().message;
      CHECK((why.find("decides") != std::string::npos || why.find("steps") != std::string::npos));
      continue;
    }
    ++straight;
    if (!is_static(entry.snippet)) continue;
    for (const glm::dvec3& p : points_of_cube(200)) {
      const double expected = entry.snippet.evaluate(p, 0.0).f;
      const double value = evaluate_at<double>(*line, {p.x, p.y, p.z}, {});
      CHECK((value == expected || (std::isnan(value) && std::isnan(expected))));
    }
  }
  CHECK(straight > 70);
  MESSAGE(straight << " snippets are straight, " << refused << " cannot be");
}

TEST_CASE("early returns, nested loops and arrays become choices and values") {
  const auto value = [](const std::string& body, double x) {
    return evaluate_at<double>(line_of(snippet_of(body)), {x, 0.0, 0.0}, {});
  };
  const std::string exits =
      "if (p.x < -0.5) return 1.0; if (p.x < 0.0) return 2.0; if (p.x < 0.5) return 3.0; return 4.0;";
  CHECK(value(exits, -0.75) == 1.0);
  CHECK(value(exits, -0.25) == 2.0);
  CHECK(value(exits, 0.25) == 3.0);
  CHECK(value(exits, 0.75) == 4.0);
  const std::string loops =
      "float s = 0.0; for (int i = 0; i < 5; ++i) { if (i == 3) continue; for (int j = 0; j < 9; ++j) {"
      " if (float(j) > p.x + 4.0) break; s += float(i * 10 + j); } } return s;";
  for (const double x : {-4.5, -2.0, 0.0, 3.5}) {
    double s = 0.0;
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; i != 3 && j < 9 && j <= x + 4.0; ++j) s += i * 10 + j;
    }
    CHECK(value(loops, x) == s);
  }
  const std::string arrays =
      "float a[4]; for (int i = 0; i < 4; ++i) a[i] = p.x * float(i); if (p.x > 0.0) a[2] = 7.0; return a[1] + a[2];";
  CHECK(value(arrays, -0.5) == -1.5);
  CHECK(value(arrays, 0.5) == 7.5);
}

TEST_CASE("what cannot be straight is refused with the reason") {
  const auto why = [](const std::string& body) {
    const auto line = straighten(snippet_of(body).time_split());
    return line ? std::string() : line.error().message;
  };
  CHECK(why("float s = p.x; while (s < 0.9) s += 0.1; return s;").find("a loop") == 0);
  CHECK(why("float a[9]; for (int i = 0; i < 9; ++i) a[i] = float(i); return a[int(p.x * 4.0 + 4.0)];")
            .find("an array") == 0);
  CHECK(why("float s = p.x; for (int i = 0; i < 3000; ++i) for (int j = 0; j < 3000; ++j) s = sin(s + float(i * j)); "
            "return s;")
            .find("262,144") != std::string::npos);
}

TEST_CASE("a line shortened for a box has the same values in it, a decided side holds, all bounds enclose") {
  tests::Random random(7);
  std::size_t before = 0, after = 0, decided = 0;
  for (const Entry& entry : corpus()) {
    const auto line = straighten(entry.snippet.time_split());
    if (!line || line->steps.size() > 3000) continue;
    CAPTURE(entry.name);
    std::vector<BoxValue> values;
    for (int k = 0; k < 60; ++k) {
      const double half = std::exp2(-1.0 - k % 7);
      const glm::dvec3 center = random.point();
      const Box box{center - half, center + half};
      evaluate_steps(*line, box, device_values(entry.snippet.time_split(), all_times), values);
      const Interval bounds = values.back().f;
      const StraightLine shorter = shorten(*line, values);
      before += line->steps.size();
      after += shorter.steps.size();
      decided += bounds.lo > 0.0 || (bounds.hi <= 0.0 && !bounds.maybe_nan) ? 1 : 0;
      for (int n = 0; n < 20; ++n) {
        const glm::vec3 p = glm::clamp(glm::vec3(center + half * random.point()), glm::vec3(box.lo), glm::vec3(box.hi));
        const auto hoisted = hoisted_at(entry.snippet, 1e5 * n);
        const float whole = evaluate_at<float>(*line, {p.x, p.y, p.z}, hoisted);
        CHECK(same(whole, evaluate_at<float>(shorter, {p.x, p.y, p.z}, hoisted)));
        CHECK((std::isnan(whole) ? bounds.maybe_nan : bounds.lo <= whole && whole <= bounds.hi));
      }
    }
  }
  MESSAGE("steps " << before << " -> " << after << ", " << decided << " boxes decided");
  CHECK(after < before);
  CHECK(decided > 100);
}

TEST_CASE("unions lose the parts that are far away, smooth ones and intersections too") {
  const std::string parts =
      "float d = length(p - vec3(0.8, 0.0, 0.0)) - 0.1; float e = length(p + vec3(0.8, 0.0, 0.0)) - 0.1;";
  const Box near_d{{0.7, -0.1, -0.1}, {0.9, 0.1, 0.1}};
  const auto shortened = [&](const std::string& result) {
    const StraightLine line = line_of(snippet_of(parts + result));
    std::vector<BoxValue> values;
    evaluate_steps(line, near_d, {}, values);
    return shorten(line, values).steps.size();
  };
  const std::size_t alone = shortened("return d;");
  CHECK(shortened("return min(d, e);") == alone);
  CHECK(shortened("return min(e, d);") == alone);
  CHECK(shortened("return -max(-d, -e);") == alone + 2);
  CHECK(shortened("return d < e ? d : e;") == alone);
  CHECK(shortened("if (d < e) return d; return e;") == alone);
  CHECK(shortened("float h = max(0.2 - abs(d - e), 0.0); return min(d, e) - h * h / 0.8;") == alone);
  CHECK(shortened("float h = clamp(0.5 + 0.5 * (e - d) / 0.2, 0.0, 1.0); return mix(e, d, h) - 0.2 * h * (1.0 - h);") ==
        alone);
  CHECK(shortened("float h = clamp(0.5 + 0.5 * (d - e) / 0.2, 0.0, 1.0); return mix(d, e, h) - 0.2 * h * (1.0 - h);") ==
        alone);
  CHECK(shortened("return d + e;") > alone);
}

TEST_CASE("nothing is left out where a NaN or the sign of a zero would show") {
  const auto steps = [](const std::string& body, const Box& box) {
    const StraightLine line = line_of(snippet_of(body));
    std::vector<BoxValue> values;
    evaluate_steps(line, box, {}, values);
    return std::pair{line.steps.size(), shorten(line, values).steps.size()};
  };
  const Box whole{glm::dvec3(-1.0), glm::dvec3(1.0)};
  const auto [nan_all, nan_left] = steps("return min(sqrt(p.x) + 5.0, p.y);", whole);  // a device may give either
  CHECK(nan_left == nan_all);
  const auto [zero_all, zero_left] = steps("return 1.0 / (p.x + 0.0 * max(p.y - 3.0, 0.0));", whole);
  CHECK(zero_left >= 5);
  const auto [inf_all, inf_left] = steps("return p.x + (1.0 / p.y) * max(p.z - 3.0, 0.0);", whole);  // inf * 0
  CHECK(inf_left >= 5);
}
