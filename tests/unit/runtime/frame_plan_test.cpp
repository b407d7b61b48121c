// What a frame does, without a device: the plan, where its steps wait, and how it is printed.
#include <doctest/doctest.h>

#include <fstream>
#include <sstream>

#include "runtime/frame/frame_plan.h"

using namespace dmvv;
using namespace dmvv::runtime;

namespace {

FrameRequest request_of(Strategy strategy, std::vector<bool> stages_go_on = {}) {
  return {.size_px = {1920, 1080},
          .tiles = {{{0, 0}, {1920, 1080}}},
          .kept = {{}},
          .surface = SurfaceKind::mesh,
          .wants_normals = true,
          .has_media = false,
          .passes = {},
          .strategy = strategy,
          .brings_home = true,
          .stages_go_on = std::move(stages_go_on)};
}

std::vector<Step> steps_of(const TilePlan& tile) {
  std::vector<Step> steps;
  for (const PlannedStep& planned : tile.steps) steps.push_back(planned.step);
  return steps;
}

/// Compares with tests/golden/frames/NAME.txt, which DMVV_UPDATE_GOLDENS=1 writes anew.
void check_golden(const std::string& name, const FramePlan& plan) {
  const std::string path = std::string(DMVV_SOURCE_DIR) + "/tests/golden/frames/" + name + ".txt";
  if (std::getenv("DMVV_UPDATE_GOLDENS") != nullptr) std::ofstream(path) << to_text(plan);
  std::ifstream file(path);
  std::ostringstream expected;
  expected << file.rdbuf();
  CHECK_MESSAGE(to_text(plan) == expected.str(), path);
}

}  // namespace

TEST_CASE("one picture: the mesh, the pixels that show it, their answers") {
  const FramePlan plan = plan_frame(request_of({}));
  REQUIRE(plan.tiles.size() == 1);
  CHECK(steps_of(plan.tiles[0]) == std::vector{Step::raster, Step::clear, Step::list, Step::count_lists, Step::evaluate,
                                               Step::report, Step::bring_home});
  CHECK(plan.tiles[0].steps[4].list == DMVV_TO_EVALUATE);
}

TEST_CASE("with leaders, what they do not answer for is evaluated; with verdicts, what is proven is painted") {
  const FramePlan plan = plan_frame(request_of({.classifies = true, .leads = true}));
  CHECK(steps_of(plan.tiles[0]) == std::vector{Step::raster, Step::clear, Step::classify, Step::count_lists,
                                               Step::paint, Step::lead, Step::follow, Step::count_lists, Step::evaluate,
                                               Step::count_hits, Step::count_hits, Step::report, Step::bring_home});
  CHECK(plan.tiles[0].steps[8].list == DMVV_LEFT);
}

TEST_CASE("stages follow each other; pixels go on only from those that say so") {
  const FramePlan plan = plan_frame(request_of({}, {true, false}));
  CHECK(steps_of(plan.tiles[0]) == std::vector{Step::raster, Step::clear, Step::list, Step::count_lists,
                                               Step::count_stages, Step::stage, Step::distribute, Step::count_stages,
                                               Step::stage, Step::report, Step::bring_home});
}

TEST_CASE("a slice has no mesh; without lists all pixels are evaluated") {
  FrameRequest request = request_of({});
  request.surface = SurfaceKind::slice;
  request.passes.pixel_list = false;
  const FramePlan plan = plan_frame(request);
  CHECK(steps_of(plan.tiles[0]) ==
        std::vector{Step::slice, Step::clear, Step::evaluate, Step::report, Step::bring_home});
  CHECK(plan.tiles[0].steps[2].list == no_list);
}

TEST_CASE("rays: tiles first, then the pixels of those that are left, then which way what they met faces") {
  FrameRequest request = request_of({});
  request.surface = SurfaceKind::rays;
  check_golden("rays", plan_frame(request));
  CHECK(steps_of(plan_frame(request).tiles[0]) == std::vector{Step::set_out, Step::cones, Step::trace, Step::normals,
                                                              Step::clear, Step::list, Step::count_lists,
                                                              Step::evaluate, Step::report, Step::bring_home});
  request.wants_normals = false;
  CHECK(steps_of(plan_frame(request).tiles[0])[3] == Step::clear);
}

TEST_CASE("what the images hold is not done again, tile by tile") {
  FrameRequest request = request_of({});
  request.tiles = {{{0, 0}, {1920, 540}}, {{0, 540}, {1920, 540}}};
  request.kept = {{.surface = true, .picture = true, .home = true}, {.surface = true}};
  SUBCASE("on the device alone: it is brought home, if it is wanted there") {
    request.kept[0].home = false;
    CHECK(steps_of(plan_frame(request).tiles[0]) == std::vector{Step::bring_home});
    CHECK_FALSE(is_evaluated(plan_frame(request).tiles[0]));
    request.brings_home = false;
    CHECK(plan_frame(request).tiles[0].steps.empty());
    CHECK(steps_of(plan_frame(request).tiles[1]).back() == Step::report);
    CHECK(is_evaluated(plan_frame(request).tiles[1]));
  }
  SUBCASE("kept") {
    const FramePlan plan = plan_frame(request);
    CHECK(plan.tiles[0].steps.empty());
    CHECK(steps_of(plan.tiles[1]).front() == Step::clear);  // the surface is there
  }
  SUBCASE("with the passes off, all is done anew") {
    request.passes.keep_picture = request.passes.keep_surface = false;
    const FramePlan plan = plan_frame(request);
    CHECK(steps_of(plan.tiles[0]).front() == Step::raster);
    CHECK(steps_of(plan.tiles[1]).front() == Step::raster);
  }
}

TEST_CASE("what stands still is kept only with verdicts, on a surface that was not drawn anew") {
  FrameRequest request = request_of({.classifies = true});
  request.kept = {{.surface = true, .other_time = true}};
  CHECK(plan_frame(request).tiles[0].keeps_still);
  request.passes.keep_surface = false;
  CHECK_FALSE(plan_frame(request).tiles[0].keeps_still);
  request.passes.keep_surface = true;
  request.strategy = {};
  CHECK_FALSE(plan_frame(request).tiles[0].keeps_still);
}

TEST_CASE("steps wait for what they need and for nothing else") {
  const FramePlan plan = plan_frame(request_of({.classifies = true, .leads = true}));
  const std::vector<bool> waiting = waits(plan.tiles[0].steps);
  const std::vector<bool> expected{
      false,  // raster
      false,  // clear: touches nothing that raster does
      true,   // classify reads the surface, writes the lists that were cleared
      true,   // count lists
      true,   // paint reads the counts
      false,  // lead: other pixels than those painted
      true,   // follow reads the leaders
      true,   // count lists
      true,   // evaluate
      false,  // count hits: reads lists only
      false,  // count hits
      true,   // report reads what evaluate counts
      false,  // bring home: what it reads was written before that
  };
  CHECK(waiting == expected);
}

TEST_CASE("no step meets a resource in use, whatever the plan") {
  // The rule in other words than the code's: between two waits, who writes a resource is alone with it, and nobody
  // reads what another one adds to.
  for (std::size_t number = 0; number < Strategy::count; ++number) {
    for (const std::vector<bool>& stages : {std::vector<bool>{}, {true, true, false}}) {
      const FramePlan plan = plan_frame(request_of(Strategy::of_number(number), stages));
      const auto& steps = plan.tiles[0].steps;
      const std::vector<bool> waiting = waits(steps);
      for (std::size_t a = 0; a < steps.size(); ++a) {
        for (std::size_t b = a + 1; b < steps.size() && !waiting[b]; ++b) {
          const StepUse& first = use_of(steps[a].step);
          const StepUse& second = use_of(steps[b].step);
          const auto touches = [](const StepUse& use, Resource r) {
            const auto in = [&](const std::vector<Resource>& list) {
              return std::find(list.begin(), list.end(), r) != list.end();
            };
            return in(use.reads) || in(use.adds) || in(use.writes);
          };
          for (const Resource r : first.writes) CHECK_FALSE(touches(second, r));
          for (const Resource r : second.writes) CHECK_FALSE(touches(first, r));
        }
      }
    }
  }
}

TEST_CASE("plans as text") {
  check_golden("picture", plan_frame(request_of({})));
  check_golden("verdicts_and_leaders", plan_frame(request_of({.classifies = true, .leads = true})));
  check_golden("stages", plan_frame(request_of({.classifies = true}, {true, true, false})));
  FrameRequest tiles = request_of({.classifies = true});
  tiles.size_px = {2560, 1440};
  tiles.tiles = {
      {{0, 0}, {2048, 1024}}, {{2048, 0}, {512, 1024}}, {{0, 1024}, {2048, 416}}, {{2048, 1024}, {512, 416}}};
  tiles.kept = {{.surface = true, .picture = true}, {.surface = true, .other_time = true}, {.surface = true}, {}};
  check_golden("tiles", plan_frame(tiles));
}
