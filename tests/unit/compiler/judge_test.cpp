// Verdicts are proofs: whatever is drawn at random in a decided cell, the reference says the same.
#include "compiler/proofs/judge.h"
#include "compiler/grids/sample.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "compiler/grids/grid_range.h"
#include "tests/support/scenes.h"
#include "tests/support/verdicts.h"

using namespace dmvv;
using namespace dmvv::compiler;

namespace {

/// As it is made beside a program that draws many frames.
std::shared_ptr<const Judge> judge_of(const Module& module, CompileOptions options = {}) {
  options.many_frames = true;
  Diagnostics diagnostics;
  auto made = build(module, options, diagnostics);
  REQUIRE_MESSAGE(made, diagnostics.render());
  return make_judge(std::move(made->module), std::move(made->records), options);
}

Verdict verdict(const Judge& judge, const glm::dvec3& lo, const glm::dvec3& hi, const Judge::Times* times = nullptr) {
  return Inquiry(judge, times != nullptr ? *times : judge.always(), snippet::Box{lo, hi}).verdict();
}

std::string name(const Judge& judge, const Verdict& verdict) {
  if (!verdict.decided) return verdict.moves ? "moves" : "open";
  return verdict.region.valid() ? at(judge.module().regions, verdict.region).name : "empty";
}

const char* const ball_text = R"(<MVV><OBJECT name="O">
  <SDF name="S" function="true">return length(p) - 0.5;</SDF>
  <REGION name="IN" type="color" rgb="1 0 0"/><REGION name="OUT" type="color" rgb="0 0 1"/>
  <MAPPINGS><SDF name="S"><POSITIVE region="OUT"/><NEGATIVE region="IN"/></SDF></MAPPINGS>
</OBJECT></MVV>)";

/// Everything that a way through a scene can consist of: grids, tilings, seeds, INDEX boxes, rotations, time.
const char* const rich_text = R"(<MVV>
  <OBJECT name="CORE">
    <SDF name="S" file="sphere.lxn" offset="0.05"/>
    <REGION name="SEED" type="color" rgb="0.9 0.8 0.1"/><REGION name="AIR" type="empty"/>
    <MAPPINGS><SDF name="S"><POSITIVE region="AIR"/><NEGATIVE region="SEED"/></SDF></MAPPINGS>
  </OBJECT>
  <OBJECT name="PULSE">
    <SDF name="S" function="true">return length(p) - 0.6 - 0.2 * sin(0.002 * t);</SDF>
    <REGION name="BEAT" type="color" rgb="1 0 0.2"/><REGION name="AIR" type="empty"/>
    <MAPPINGS><SDF name="S"><POSITIVE region="AIR"/><NEGATIVE region="BEAT"/></SDF></MAPPINGS>
  </OBJECT>
  <OBJECT name="ROOT">
    <SDF name="PLANE" file="plane.lxn" rotate="0 30 10"/>
    <SDF name="SPOTS" file="sphere.lxn" type="seeding" seedFile="seeds.txt" scale="0.15 0.2 0.15"/>
    <SDF name="TILES" file="sphere.lxn" type="tiling" scale="0.2 0.2 0.2" offset="-0.2"/>
    <REGION name="LEFT" type="color" rgb="0.2 0.6 0.2">
      <INDEX size="8 8 8" translate="-0.4 0 0" scale="0.6 0.9 0.9">
        <EMBEDDED name="CORE" seedFile="seeds.txt" scale="0.2 0.2 0.3" rotate="20 0 40"/></INDEX>
    </REGION>
    <REGION name="RIGHT" type="color" rgb="0.3 0.3 0.9"><EMBEDDED name="PULSE" translate="0.5 0 0" scale="0.4 0.4 0.4"/></REGION>
    <REGION name="SPOT" type="color" rgb="1 1 1"/>
    <MAPPINGS><SDF name="SPOTS">
      <POSITIVE><SDF name="PLANE">
        <POSITIVE region="RIGHT"/>
        <NEGATIVE><SDF name="TILES"><POSITIVE region="LEFT"/><NEGATIVE region="SPOT"/></SDF></NEGATIVE>
      </SDF></POSITIVE>
      <NEGATIVE region="SPOT"/></SDF></MAPPINGS>
  </OBJECT></MVV>)";

Module rich_module() {
  tests::Random random(3);
  std::string seeds;
  for (int i = 0; i < 30; ++i) {
    const glm::dvec3 p = random.point(-0.5, 0.5);
    seeds += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  }
  return tests::lowered(
      rich_text, {{"sphere.lxn", tests::sphere_lxn(16, 0.7)}, {"plane.lxn", tests::plane_lxn()}, {"seeds.txt", seeds}});
}

}  // namespace

TEST_CASE("the range of a grid over a box holds its values, and over few voxels no others") {
  tests::Random random(1);
  const voml::Grid grid = tests::grid_of({9, 6, 7}, [&](const glm::dvec3&) { return random.in(-1.0, 1.0); });
  const GridRange range(grid);
  const auto at = [&](const glm::dvec3& c) {
    return sample(grid, grid.box_lo + (c + 0.5) / glm::dvec3(grid.size) * (grid.box_hi - grid.box_lo));
  };
  for (int i = 0; i < 2000; ++i) {
    const double width = i % 4 == 0 ? 9.0 : 1.0;
    const glm::dvec3 a(random.in(-1, 10), random.in(-1, 7), random.in(-1, 8));
    const glm::dvec3 b = a + width * random.point(0.0, 1.0);
    const Range found = range.over(a, b);
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (int k = 0; k < 40; ++k) {
      const double value = at(glm::mix(a, b, random.point(0.0, 1.0)));
      least = std::min(least, value), most = std::max(most, value);
    }
    for (int corner = 0; corner < 8; ++corner) {
      const double value = at({corner & 1 ? a.x : b.x, corner & 2 ? a.y : b.y, corner & 4 ? a.z : b.z});
      least = std::min(least, value), most = std::max(most, value);
    }
    CHECK(found.lo <= least + 1e-12);
    CHECK(found.hi >= most - 1e-12);
    // Within one voxel a trilinear function has its extremes at the corners.
    if (glm::floor(glm::clamp(a, glm::dvec3(0.0), glm::dvec3(7, 4, 5))) ==
        glm::floor(glm::clamp(b, glm::dvec3(0.0), glm::dvec3(7, 4, 5)))) {
      CHECK(found.lo == doctest::Approx(least).epsilon(1e-12));
      CHECK(found.hi == doctest::Approx(most).epsilon(1e-12));
    }
  }
}

TEST_CASE("a box on one side of a boundary is decided, one that it crosses is open") {
  const auto judge = judge_of(tests::lowered(ball_text));
  CHECK(name(*judge, verdict(*judge, {-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2})) == "IN");
  CHECK(name(*judge, verdict(*judge, {0.6, 0.0, 0.0}, {0.7, 0.1, 0.1})) == "OUT");
  CHECK(name(*judge, verdict(*judge, {0.4, 0.0, 0.0}, {0.6, 0.1, 0.1})) == "open");
  CHECK(name(*judge, verdict(*judge, {0.5, 0.0, 0.0}, {0.5, 0.0, 0.0})) ==
        "open");  // float32 may put it on either side
  CHECK(name(*judge, verdict(*judge, {0.4999, 0.0, 0.0}, {0.4999, 0.0, 0.0})) == "IN");
}

TEST_CASE("the open cells of a ball are those around its surface, not many more") {
  const auto judge = judge_of(tests::lowered(ball_text));
  constexpr int n = 64;
  int open = 0;
  for (int i = 0; i < n * n * n; ++i) {
    const glm::dvec3 lo = -1.0 + 2.0 / n * glm::dvec3(i % n, i / n % n, i / n / n);
    open += verdict(*judge, lo, lo + 2.0 / n).decided ? 0 : 1;
  }
  // A surface of area A meets some 3/2 A / h^2 cells of width h.
  const double expected = 1.5 * 4.0 * 3.14159265 * 0.25 / (4.0 / (n * n));
  CHECK(open > 0.8 * expected);
  CHECK(open < 1.4 * expected);
}

TEST_CASE("what moves is told from what stands still, for ever and for a span of time") {
  const auto judge = judge_of(rich_module());
  CHECK(judge->is_animated());
  const glm::dvec3 centre(0.5, 0.0, 0.0);
  CHECK(name(*judge, verdict(*judge, centre - 0.01, centre + 0.01)) == "BEAT");  // the pulse never leaves it
  const glm::dvec3 rim = centre + glm::dvec3(0.4 * 0.6, 0.0, 0.0);
  CHECK(name(*judge, verdict(*judge, rim - 1e-3, rim + 1e-3)) == "moves");
  const Judge::Times large = judge->times({700.0, 860.0}), small = judge->times({2280.0, 2430.0});  // near its extremes
  CHECK(name(*judge, verdict(*judge, rim - 1e-3, rim + 1e-3, &large)) == "BEAT");
  CHECK(name(*judge, verdict(*judge, rim - 1e-3, rim + 1e-3, &small)) == "RIGHT");
  CHECK_FALSE(judge_of(tests::lowered(ball_text))->is_animated());
}

TEST_CASE("in decided cells the reference says the same at every point, at every time, in every format") {
  const Module module = rich_module();
  std::vector<CompileOptions> settings(3);
  settings[1].filter = Filter::tricubic;
  settings[2].atlas_format = TexelFormat::snorm8;
  for (const CompileOptions& options : settings) {
    const auto judge = judge_of(module, options);
    Module passed = module;
    run_passes(passed, options);
    const Reference reference(passed, {.use_index = true, .format = options.atlas_format, .filter = options.filter});
    const Judge::Times span = judge->times({1000.0, 1400.0});
    tests::GrownTree always(*judge, judge->always()), for_span(*judge, span);
    tests::Random random(9);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 400; ++i) points.push_back(random.point());
    for (tests::GrownTree* tree : {&always, &for_span}) tree->grow(points, 3);

    int decided = 0, still = 0, wrong = 0;
    for (int i = 0; i < 6000; ++i) {
      // Half of them near the points at which the trees are fine.
      const glm::dvec3 p(glm::vec3(
          i % 2 == 0 ? random.point() : glm::clamp(points[random.below(400)] + random.point(-0.01, 0.01), -1.0, 1.0)));
      for (const double time_ms : {0.0, 1000.0, 1234.5, 1400.0, 3.6e6}) {
        const ReferenceAnswer expected = reference.evaluate(p, time_ms);
        if (!expected.certain) continue;
        if (const auto* outcome = always.outcome_at(p)) {
          ++decided;
          wrong += !tests::agrees(*outcome, expected);
        } else if ((always.word_at(p) & DMVV_VERDICT_STILL) != 0) {
          ++still;
          const ReferenceAnswer later = reference.evaluate(p, time_ms + 777.0);
          wrong += later.certain && later.path != expected.path;
        }
        const auto* outcome = for_span.outcome_at(p);
        if (outcome != nullptr && 1000.0 <= time_ms && time_ms <= 1400.0) wrong += !tests::agrees(*outcome, expected);
      }
    }
    CHECK(wrong == 0);
    CHECK(decided > 6000);
    CHECK(still > 1000);
  }
}

TEST_CASE("a box within a box is judged as by itself, and never otherwise") {
  const auto judge = judge_of(rich_module());
  tests::Random random(4);
  int decided_alone = 0, decided_within = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 lo = random.point(-1.0, 0.9);
    Inquiry wide(*judge, judge->always(), snippet::Box{lo, lo + 0.1});
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 at = lo + random.point(0.0, 0.09);
      const Verdict alone = verdict(*judge, at, at + 0.01),
                    within = Inquiry(wide, snippet::Box{at, at + 0.01}).verdict();
      decided_alone += alone.decided, decided_within += within.decided;
      if (alone.decided && within.decided) CHECK(alone.region == within.region);
    }
  }
  CHECK(decided_within > 0.98 * decided_alone);
}

TEST_CASE("a tree ends where its memory does, and says so") {
  const auto judge = judge_of(rich_module());
  tests::Random random(2);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 200; ++i) points.push_back(random.point());
  tests::GrownTree small(*judge, judge->always(), 5, 1);
  small.grow(points, 6);
  CHECK(small.tree().is_full());
  CHECK(small.tree().word_count() == 5 * DMVV_BRICK_WORDS);
  CHECK(small.tree().outcome_count() == 1);

  // However fine, a cell of the last level is not split, and holds the points that are found in it.
  tests::GrownTree deep(*judge, judge->always());
  const std::vector<glm::dvec3> rim{{0.5 + 0.4 * 0.6, 0.0, 0.0}};
  deep.grow(rim, 12);
  const std::uint32_t cell = deep.tree().cell_of(glm::vec3(rim[0]));
  CHECK((deep.tree().word(cell) & DMVV_VERDICT_FINAL) != 0);
  const snippet::Box box = deep.tree().box_of(cell);
  CHECK(box.hi.x - box.lo.x < 4.0 / DMVV_VERDICT_UNITS);
  CHECK(glm::all(glm::lessThanEqual(box.lo, rim[0])));
  CHECK(glm::all(glm::greaterThanEqual(box.hi, rim[0])));
}

TEST_CASE("the same splits give the same tree, whatever their order") {
  const auto judge = judge_of(rich_module());
  tests::GrownTree a(*judge, judge->always()), b(*judge, judge->always());
  std::vector<std::uint32_t> cells{0, 5, 17, 33, 50}, reversed(cells.rbegin(), cells.rend());
  a.tree().split(cells);
  b.tree().split(reversed);
  REQUIRE(a.tree().word_count() == b.tree().word_count());
  for (std::uint32_t i = 0; i < a.tree().word_count(); ++i) {
    CHECK((a.tree().word(i) & ~DMVV_VERDICT_VALUE) == (b.tree().word(i) & ~DMVV_VERDICT_VALUE));
  }
}
