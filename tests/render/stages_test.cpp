// Pixels evaluated in stages (compiler/plan/stage_plan.h) and by one kernel: the same pictures, bit by bit.
#include <doctest/doctest.h>

#include "runtime/runtime.h"
#include "tests/render/render_scenes.h"
#include "tests/support/scene_table.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

compiler::CompileOptions wherever_it_can_be() {
  compiler::CompileOptions options;
  options.many_frames = true;
  options.stages = {.least_program_lines = 0, .least_lines = 1};
  return options;
}

std::vector<runtime::View> views() {
  runtime::View view;
  view.size_px = {160, 90};
  view.camera.eye = {2.0, 1.5, 4.0};
  view.want_regions = true;
  std::vector<runtime::View> all{view, view, view, view};
  all[1].cuts = {{{0.0, 0.0, 1.0}, 0.1}};
  all[2].slice = runtime::Plane{{0.3, -0.2, 1.0}, 0.07};
  all[2].time_ms = 40.0;
  all[3].cuts = {{{1.0, 0.0, 0.2}, -0.2}};
  all[3].colors = runtime::Colors::bytes;
  all[3].camera.fov_deg = 12.0;
  return all;
}

/// Returns how many stages there are.
std::size_t check_same_pictures(const compiler::Module& module) {
  compiler::CompileOptions options = wherever_it_can_be();
  const tests::Judged in_parts = tests::judged(module, options);
  const compiler::Program& staged = in_parts.program;
  options.disabled_passes = {"stages"};
  const tests::Judged at_once_too = tests::judged(module, options);
  const compiler::Program& whole = at_once_too.program;
  CHECK_FALSE(whole.find_kernel("pixels")->is_staged());
  auto in_stages = runtime::Evaluator::create(device(), staged, nullptr, {}, in_parts.judge).value();
  auto at_once = runtime::Evaluator::create(device(), whole, nullptr, {}, at_once_too.judge).value();
  for (runtime::View view : views()) {
    view.disabled_passes = {"trials", "verdicts", "reach"};
    const auto expected = at_once.render(view);
    const auto got = in_stages.render(view);
    view.disabled_passes = {"trials"};  // verdicts and leaders leave few pixels to the stages
    const auto left = in_stages.render(view);
    view.disabled_passes = {"trials", "verdicts", "reach", "pixel-list", "keep-picture"};
    const auto unlisted = in_stages.render(view);
    REQUIRE(expected);
    for (const auto* picture : {&got, &left, &unlisted}) {
      REQUIRE(*picture);
      CHECK((*picture)->regions == expected->regions);
      CHECK((*picture)->rgba == expected->rgba);
      CHECK((*picture)->rgba8 == expected->rgba8);
    }
  }
  return staged.find_kernel("pixels")->is_staged() ? staged.find_kernel("pixels")->shaders.size() : 0;
}

}  // namespace

TEST_CASE("stages show what one kernel shows") {
  std::size_t divided = 0;
  for (const tests::SceneCase& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    divided += check_same_pictures(tests::lowered(scene.text, scene.files)) != 0;
  }
  const Folder folder;
  for (const RenderScene& scene : write_render_scenes(folder)) {
    CAPTURE(scene.name);
    divided += check_same_pictures(tests::lowered_file(scene.path)) != 0;
  }
  CHECK(divided >= 5);
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}

TEST_CASE("a program without its stages' code says which kernel it lacks") {
  Diagnostics diagnostics;
  for (const tests::SceneCase& scene : tests::conformance_scenes()) {
    auto program = compiler::compile(tests::lowered(scene.text, scene.files), wherever_it_can_be(), diagnostics);
    REQUIRE(program);
    if (!program->find_kernel("pixels")->is_staged()) continue;
    REQUIRE(compiler::to_spirv(*program, compiler::Source::points));
    auto evaluator = runtime::Evaluator::create(device(), *program).value();
    const auto picture = evaluator.render(views().front());
    REQUIRE_FALSE(picture);
    CHECK(picture.error().message == "the program was compiled without its kernel 'pixels'");
    return;
  }
  FAIL("no scene is divided");
}
