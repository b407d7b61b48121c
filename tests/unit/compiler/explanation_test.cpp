// Explanations: what was asked is what the specification says is asked, with values and distances from mathematics.
#include "compiler/reference/explanation.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::compiler;
using namespace dmvv::tests;

namespace {

struct Explained {
  explicit Explained(const std::string& text, Files files = {})
      : module(lowered(text, std::move(files))), reference(module) {}
  Explanation at(const glm::dvec3& p, double t = 0.0) const {
    return explain(module, reference, Filter::hardware, p, t);
  }
  Module module;
  Reference reference;
};

const char* const nested = R"(<MVV>
  <OBJECT name="CORE"><SDF name="PLANE" function="true">return 2.0 * p.x - 0.5;</SDF>
    <REGION name="R.CORE" type="color" rgb="1 0 0"/></OBJECT>
  <OBJECT name="ALL"><SDF name="WALL" function="true" offset="0.25">return p.y - 0.001 * t;</SDF>
    <REGION name="R.ALL" type="color" rgb="0 0 1">
      <EMBEDDED name="CORE" translate="0.5 0 0" scale="0.25 0.25 0.25"/>
      <EMBEDDED name="CORE" scale="0.5 0.5 0.5" rotate="0 0 90"/></REGION>
    <REGION name="R.OUT" type="empty"/>
    <MAPPINGS><SDF name="WALL"><POSITIVE region="R.OUT"/><NEGATIVE region="R.ALL"/></SDF></MAPPINGS></OBJECT>
</MVV>)";

}  // namespace

TEST_CASE("decisions, candidates and local points down to the region") {
  const Explained scene(nested);
  const Explanation e = scene.at({0.1, 0.2, 0.0});
  REQUIRE(e.visit.size() == 1);
  const Visit& all = e.visit[0];
  REQUIRE(all.decisions.size() == 1);
  CHECK(all.decisions[0].negative);
  CHECK(all.decisions[0].placements[0].value == doctest::Approx(0.2));
  CHECK(all.decisions[0].distance == doctest::Approx(0.05));  // y = 0.25 is the wall
  REQUIRE(all.groups.size() == 1);
  REQUIRE(all.groups[0].candidates.size() == 2);
  const AskedCandidate& first = all.groups[0].candidates[0];
  CHECK(!first.held);  // from 0.25 to 0.75 along x
  CHECK(first.local.x == doctest::Approx(-1.6));
  CHECK(first.distance == doctest::Approx(0.15));
  CHECK(first.visit.empty());
  const AskedCandidate& second = all.groups[0].candidates[1];
  CHECK(second.held);
  CHECK(second.number == 1);
  CHECK(second.local.x == doctest::Approx(0.4));  // its x axis is the root's y axis
  CHECK(second.local.y == doctest::Approx(-0.2));
  REQUIRE(second.visit.size() == 1);
  const AskedDecision& plane = second.visit[0].decisions[0];
  CHECK(!plane.negative);  // 2 * 0.4 - 0.5
  CHECK(plane.placements[0].value == doctest::Approx(0.3));
  CHECK(plane.distance == doctest::Approx(0.075));  // at y = 0.125 of the root
  CHECK(!second.visit[0].answers);
  CHECK(all.answers);
  CHECK(e.answer.path == std::vector<PathStep>{{all.region.index, 0}});
  CHECK(e.nearest.what == "SDF WALL of ALL");
  CHECK(e.nearest.distance == doctest::Approx(0.05));
}

TEST_CASE("time moves a boundary, and its distance") {
  const Explained scene(nested);
  const Explanation e = scene.at({0.9, 0.6, 0.9}, 400.0);  // the wall at 0.65
  CHECK(e.visit[0].decisions[0].negative);
  CHECK(e.visit[0].decisions[0].distance == doctest::Approx(0.05));
  CHECK(!scene.at({0.9, 0.6, 0.9}, 300.0).visit[0].answers);
}

TEST_CASE("outside of the root nothing is asked; its face is near") {
  const Explained scene(nested);
  const Explanation e = scene.at({1.5, 0, 0});
  CHECK(e.visit.empty());
  CHECK(e.answer.number == 0);
  CHECK(e.nearest.what == "the cube of ALL");
  CHECK(e.nearest.distance == doctest::Approx(0.5));
}

TEST_CASE("seeds: the cell, those asked, the nearest way in or out") {
  std::string seeds;
  for (int i = 0; i < 16; ++i) seeds += std::to_string(-0.46875 + 0.0625 * i) + " 0 0\n";  // at x = -15/16, ..., 15/16
  const Explained scene(R"(<MVV><OBJECT name="ROW">
    <SDF name="BALLS" function="true" type="seeding" seedFile="s.txt" scale="0.05 0.05 0.05">return length(p) - 0.8;</SDF>
    <REGION name="R" type="color" rgb="1 1 1"/></OBJECT></MVV>)",
                        {{"s.txt", seeds}});
  const Explanation in = scene.at({0.0625 + 0.01, 0, 0});  // in ball 8, of radius 0.04
  const AskedDecision& inside = in.visit[0].decisions[0];
  CHECK(inside.negative);
  REQUIRE(inside.cell.has_value());
  CHECK(inside.cell->entries >= inside.placements.size());
  CHECK(inside.placements.back().placement == 8);
  CHECK(inside.placements.back().local.x == doctest::Approx(0.2));
  CHECK(inside.distance == doctest::Approx(0.03));
  const Explanation out = scene.at({0.0625, 0.045, 0});
  CHECK(!out.visit[0].decisions[0].negative);
  CHECK(out.visit[0].decisions[0].distance == doctest::Approx(0.005));
}

TEST_CASE("a grid: its box, and the slope between its samples") {
  const Explained scene(R"(<MVV><OBJECT name="A"><SDF name="S" file="p.lxn" scale="0.5 0.5 0.5"/>
    <REGION name="R" type="color" rgb="1 1 1"/></OBJECT></MVV>)",
                        {{"p.lxn", plane_lxn(4)}});
  const Explanation out = scene.at({0.75, 0, 0});
  CHECK(!out.visit[0].decisions[0].placements[0].held);
  CHECK(!out.visit[0].decisions[0].placements[0].value);
  CHECK(out.visit[0].decisions[0].distance == doctest::Approx(0.25));
  const Explanation in = scene.at({-0.1, 0.02, 0.01});  // the plane x = 0
  CHECK(in.visit[0].decisions[0].negative);
  CHECK(in.visit[0].decisions[0].distance == doctest::Approx(0.1).epsilon(1e-4));
}

TEST_CASE("explaining changes no answer") {
  const Explained scene(nested);
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 p = random.point(-1.1, 1.1);
    const ReferenceAnswer plain = scene.reference.evaluate(p, 10.0 * i);
    const Explanation e = scene.at(p, 10.0 * i);
    CHECK(e.answer.path == plain.path);
    CHECK(e.answer.number == plain.number);
    CHECK(e.answer.rgba == plain.rgba);
    CHECK(e.answer.certain == plain.certain);
    CHECK(e.nearest.distance >= 0.0);
  }
}
