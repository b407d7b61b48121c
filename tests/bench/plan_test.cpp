// The table of cases, and the scenes it makes.
#include "bench/plan.h"

#include <doctest/doctest.h>

#include <set>

#include "bench/truth.h"
#include "bench/workload.h"

using namespace dmvv;
using namespace dmvv::bench;

TEST_CASE("cases have names of their own, and those of a scene stand together") {
  for (const SetName& set : set_names()) {
    for (const bool quick : {false, true}) {
      CAPTURE(set.name);
      const Plan plan = make_plan({.set = set.name, .quick = quick, .examples = "/no/such/folder"});
      std::set<std::string> ids, finished;
      std::string scene;
      for (const Case& what : plan.cases) {
        CHECK_MESSAGE(ids.insert(what.id).second, what.id);
        if (what.scene_key == scene) continue;
        CHECK_MESSAGE(finished.insert(scene).second, what.scene_key);
        scene = what.scene_key;
      }
    }
  }
}

TEST_CASE("scenes that are not there are told, with the place where they were looked for") {
  const Plan plan = make_plan({.set = "thesis", .examples = "/no/such/folder"});
  CHECK(plan.cases.empty());
  REQUIRE(plan.missing.size() == 5);
  CHECK(plan.missing[1].scene == "skin");
  CHECK(plan.missing[1].reason == "not there yet: no /no/such/folder/skin/skin.voml");
}

TEST_CASE("each setting differs from the first in one thing, and every pass is among them") {
  const Settings& first = variants().front().settings;
  for (const Variant& row : variants()) {
    const Settings& s = row.settings;
    const int differences = (s.codegen != first.codegen) + (s.atlas != first.atlas) + (s.filter != first.filter) +
                            (s.samples != first.samples) + (s.motion != first.motion || s.verdicts != first.verdicts) +
                            static_cast<int>(s.disabled_passes.size());
    CHECK(differences == (&row == &variants().front() ? 0 : 1));
  }
  for (const compiler::PassInfo& pass : compiler::pass_names())
    CHECK(variant("no " + std::string(pass.name)).settings.disabled_passes.size() == 1);
}

TEST_CASE("made scenes are what their names say") {
  struct Expected {
    SceneSource source;
    std::size_t objects, candidates, sdfs, grids;
    std::uint32_t depth;
  };
  const std::vector<Expected> table{{many_objects(100), 2, 100, 2, 0, 2},
                                    {nested_objects(7), 8, 7, 7, 0, 8},
                                    {many_grids(5, 8), 6, 5, 5, 5, 2},
                                    {decision_tree(TreeForm::chain, Source::analytic, 9), 1, 0, 9, 0, 1},
                                    {decision_tree(TreeForm::full, Source::grid, 3), 1, 0, 7, 7, 1},
                                    {empty_cube(), 1, 0, 0, 0, 1}};
  for (const Expected& expected : table) {
    CAPTURE(expected.source.name);
    Diagnostics diagnostics;
    auto scene = voml::read_scene(expected.source.path, expected.source.files, {}, diagnostics);
    REQUIRE_MESSAGE(scene, diagnostics.render());
    const auto module = compiler::lower(std::move(*scene), diagnostics);
    REQUIRE_MESSAGE(module, diagnostics.render());
    CHECK(diagnostics.render().empty());
    std::size_t candidates = 0;
    for (const compiler::Region& region : module->regions) {
      for (const auto& group : region.groups) candidates += group.candidates.size();
    }
    CHECK(module->objects.size() == expected.objects);
    CHECK(candidates == expected.candidates);
    CHECK(module->sdfs.size() == expected.sdfs);
    CHECK(module->grids.size() == expected.grids);
    CHECK(module->depth == expected.depth);
  }
}

TEST_CASE("the balls of many objects fill the same share of the cube, however many there are") {
  for (const std::uint32_t count : {100u, 1000u, 3000u}) {
    auto truth = Truth::create(many_objects(count));
    REQUIRE(truth);
    std::size_t inside = 0;
    for (const auto& answer : (*truth)->at_points(4000, compiler::Filter::hardware))
      inside += answer.path.size() == 2 ? 1 : 0;
    const double share = static_cast<double>(inside) / 4000.0;
    // 4/3 pi (0.95 * 0.44)^3 of each cell that is taken; 1000 takes all of 10^3, 3000 takes 3000 of 15^3, 100 of 5^3.
    const double side = std::ceil(std::cbrt(count) - 1e-9);
    CHECK(share == doctest::Approx(0.306 * count / (side * side * side)).epsilon(0.1));
  }
}
