// The whole way on a small range: measured, fitted, told as JSON.
#include "bench/run.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "bench/report.h"
#include "bench/workload.h"

using namespace dmvv;
using namespace dmvv::bench;

namespace {

/// Quick cases of a section, with as little effort as tells something.
std::vector<Case> few(const std::string& section, const std::vector<std::string>& variant_names) {
  std::vector<Case> chosen;
  for (Case& what : make_plan({.quick = true, .examples = "/no/such/folder"}).cases) {
    if (what.section != section) continue;
    if (std::find(variant_names.begin(), variant_names.end(), what.variant) == variant_names.end()) continue;
    what.effort.max_frames = what.effort.min_frames = 2;
    what.effort.probe_rounds = 1;
    what.effort.points = 1000;
    what.size_px = {64, 64};
    chosen.push_back(std::move(what));
  }
  return chosen;
}

}  // namespace

TEST_CASE("trilinear grids converge with the square of their step, and no certain point is wrong") {
  const auto measurements = run_cases({}, few("boundary", {"auto", "table"}), {});
  REQUIRE(measurements.size() >= 4);
  for (const Measurement& m : measurements) {
    CAPTURE(m.what.id);
    REQUIRE(m.failure.empty());
    REQUIRE(m.points);
    REQUIRE(m.pixels);
    REQUIRE(m.displacement);
    CHECK(m.points->wrong == 0);
    CHECK(m.pixels->wrong == 0);
    CHECK(m.points->compared > 900);
    CHECK(m.pixels->compared > 10000);
    CHECK(m.displacement->lost == 0);
    CHECK(m.displacement->max >= m.displacement->rms);
    CHECK(m.displacement->rms > 0.0);
    CHECK(m.color_rmse.value() < 1e-6);
    CHECK(m.frame_ms.size() == 2);
    CHECK(m.build_ms() > 0.0);
    // One texel of float32 a sample, borders included.
    const auto n = static_cast<std::uint64_t>(m.what.parameter->value) + 2;
    CHECK(m.upload_bytes >= 4 * n * n * n);
  }
  const auto fits = fit_series(measurements);
  REQUIRE(fits.size() == 2);
  for (const Fit& fit : fits) {
    CHECK(fit.expected == 2.0);
    CHECK(fit.tolerance == 0.1);
    CHECK(std::abs(fit.law.exponent - 2.0) <= 0.1);
    CHECK(fit.holds());
  }
}

TEST_CASE("more samples bring the colours nearer") {
  const auto measurements = run_cases({}, few("samples", {"auto"}), {});
  REQUIRE(measurements.size() == 4);
  for (std::size_t i = 1; i < measurements.size(); ++i) {
    CHECK(measurements[i].color_rmse.value() < measurements[i - 1].color_rmse.value());
  }
}

TEST_CASE("a case that cannot be measured says why, and the others are measured") {
  std::vector<Case> cases = few("growth", {"auto"});
  REQUIRE(cases.size() > 2);
  cases.resize(2);
  cases[0].scene = [] {
    SceneSource source = empty_cube();
    source.files = memory_files({{"scene.voml", "<MVV><OBJECT/></MVV>"}});
    return source;
  };
  std::vector<std::size_t> counts;
  const auto measurements = run_cases({}, cases, {.progress = {}, .done = [&](const std::vector<Measurement>& so_far) {
                                                    counts.push_back(so_far.size());
                                                  }});
  CHECK(counts == std::vector<std::size_t>{1, 2});
  REQUIRE(measurements.size() == 2);
  CHECK(measurements[0].failure.find("scene.voml") != std::string::npos);
  CHECK(measurements[1].failure.empty());
  const auto late = run_cases({}, cases, {.budget_s = 1e-9, .progress = {}, .done = {}});
  CHECK(late[1].failure.starts_with("left out"));
}
