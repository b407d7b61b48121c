// Comparing results: an injected slowdown is found, noise is not.
#include "bench/compare.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "bench/random.h"
#include "bench/report.h"

using namespace dmvv;
using namespace dmvv::bench;

namespace {

/// 40 cases of 15 frames that scatter by 10 %; the frames of case `slowed` take `factor` times as long.
Report noisy(std::uint64_t seed, int slowed = -1, double factor = 1.0, double load = 1.0) {
  Random random(seed);
  Report report;
  for (int i = 0; i < 40; ++i) {
    Measurement m;
    m.what.id = "case " + std::to_string(i);
    m.what.section = "scene";
    for (int k = 0; k < 15; ++k) {
      // The sum of twelve is nearly normal, with a deviation of one.
      double normal = -6.0;
      for (int j = 0; j < 12; ++j) normal += random.uniform();
      m.frame_ms.push_back((20.0 + i) * load * (i == slowed ? factor : 1.0) * (1.0 + 0.1 * normal));
    }
    m.points = RegionErrors{1000, 0, 0, 0};
    report.measurements.push_back(std::move(m));
  }
  return report;
}

std::vector<std::string> called(const Comparison& comparison, Verdict verdict) {
  std::vector<std::string> ids;
  for (const Change& change : comparison.changes) {
    if (change.verdict == verdict) ids.push_back(change.id + " " + change.figure);
  }
  return ids;
}

Comparison must_compare(const std::vector<std::pair<Report, Report>>& pairs) {
  std::vector<std::pair<std::string, std::string>> texts;
  for (const auto& [before, after] : pairs) texts.emplace_back(to_json(before), to_json(after));
  auto comparison = compare(texts);
  REQUIRE(comparison);
  return std::move(*comparison);
}

}  // namespace

TEST_CASE("noise is not called out, a slowdown is") {
  CHECK(called(must_compare({{noisy(1), noisy(2)}}), Verdict::slower).empty());
  const Comparison comparison = must_compare({{noisy(1), noisy(2, 7, 1.3)}});
  CHECK(called(comparison, Verdict::slower) == std::vector<std::string>{"case 7 frame"});
  CHECK(comparison.worse());
  CHECK(to_text(comparison).find("Slower: 1") != std::string::npos);
  const Comparison faster = must_compare({{noisy(1), noisy(2, 7, 0.7)}});
  CHECK(called(faster, Verdict::faster) == std::vector<std::string>{"case 7 frame"});
  CHECK_FALSE(faster.worse());
}

TEST_CASE("several pairs tell apart what one cannot") {
  // 12 %: within the noise of one pair's floor for some seeds, but in every one of five pairs.
  std::vector<std::pair<Report, Report>> pairs, idle;
  for (std::uint64_t i = 0; i < 5; ++i) {
    pairs.emplace_back(noisy(10 + i), noisy(20 + i, 3, 1.2));
    idle.emplace_back(noisy(10 + i), noisy(20 + i));
  }
  CHECK(called(must_compare(pairs), Verdict::slower) == std::vector<std::string>{"case 3 frame"});
  CHECK_FALSE(must_compare(idle).worse());
}

TEST_CASE("one sample a side needs a large difference") {
  Report before, after;
  Measurement m;
  m.what.id = "c";
  m.frame_ms = {10.0};
  before.measurements = {m};
  m.frame_ms = {12.5};
  after.measurements = {m};
  CHECK_FALSE(must_compare({{before, after}}).worse());
  m.frame_ms = {14.0};
  after.measurements = {m};
  CHECK(must_compare({{before, after}}).worse());
}

TEST_CASE("one more wrong point is called out, however fast it was") {
  Report after = noisy(2, 7, 0.5);
  after.measurements[4].points->wrong = 1;
  const Comparison comparison = must_compare({{noisy(1), after}});
  CHECK(called(comparison, Verdict::more_wrong) == std::vector<std::string>{"case 4 wrong points"});
  CHECK(comparison.worse());
}

TEST_CASE("cases of one side are named, and other files refused") {
  Report fewer = noisy(1);
  fewer.measurements.pop_back();
  CHECK(must_compare({{noisy(1), fewer}}).only_before == std::vector<std::string>{"case 39"});
  CHECK(must_compare({{fewer, noisy(1)}}).only_after == std::vector<std::string>{"case 39"});
  CHECK_FALSE(compare({}));
  CHECK_FALSE(compare({{"{}", "{}"}}));
  CHECK_FALSE(compare({{"not JSON", to_json(fewer)}}));
  CHECK_FALSE(compare({{R"({"schema":1})", to_json(fewer)}}));
}
