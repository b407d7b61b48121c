// Frame after frame of one evaluator, with verdicts and what stands still kept, against pictures drawn anew.
#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include "runtime/runtime.h"
#include "tests/render/render_scenes.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

const char* const beating_text = R"(<MVV>
  <OBJECT name="BALL"><SDF name="S" function="true">return length(p) - 0.7 - 0.2 * sin(0.01 * t);</SDF>
    <REGION name="IN" type="color" rgb="1 0.2 0"/><REGION name="AIR" type="empty"/>
    <MAPPINGS><SDF name="S"><POSITIVE region="AIR"/><NEGATIVE region="IN"/></SDF></MAPPINGS></OBJECT>
  <OBJECT name="ROOT"><SDF name="CUT" function="true">return p.x + 0.3 * p.z;</SDF>
    <REGION name="BEATS" type="color" rgb="0 0 1"><EMBEDDED name="BALL" type="seeding" seedFile="seeds.txt" scale="0.3 0.3 0.3"/></REGION>
    <REGION name="STANDS" type="color" rgb="0 1 0"/>
    <MAPPINGS><SDF name="CUT"><POSITIVE region="BEATS"/><NEGATIVE region="STANDS"/></SDF></MAPPINGS></OBJECT></MVV>)";

compiler::Module beating() {
  return tests::lowered(beating_text, {{"seeds.txt", "0.3 0.2 0\n0.2 -0.3 0.1\n0.4 0 0.4\n-0.1 0.1 0.2\n"}});
}

compiler::CompileOptions judged() {
  compiler::CompileOptions options;
  options.many_frames = true;
  options.stages = {.least_program_lines = 0, .least_lines = 1};
  return options;
}

runtime::View view_at(double angle, double time_ms) {
  runtime::View view;
  view.size_px = {160, 90};
  view.camera.eye = {6.0 * std::sin(angle), 2.0, 6.0 * std::cos(angle)};
  view.cuts = {{{0.0, 0.0, 1.0}, 0.1}};
  view.time_ms = time_ms;
  view.want_regions = true;
  return view;
}

/// Frames as an animation shows them: the camera goes and stops, time goes on, stands and jumps.
std::vector<runtime::View> film() {
  std::vector<runtime::View> views;
  for (int i = 0; i < 12; ++i) views.push_back(view_at(0.05 * i, 0.0));
  for (int i = 0; i < 40; ++i) views.push_back(view_at(0.5, 25.0 * i));
  for (int i = 0; i < 6; ++i) views.push_back(view_at(0.5 + 0.02 * i, 1000.0 - 40.0 * i));
  views.push_back(view_at(0.5, 86400000.0));
  views.push_back(view_at(0.5, 12.0));
  for (int i = 0; i < 4; ++i) views.push_back(view_at(0.5, 12.0));
  return views;
}

}  // namespace

TEST_CASE("no frame shows that verdicts were used, that what stands still was kept, or in which order") {
  const Folder folder;
  std::vector<std::pair<std::string, compiler::Module>> modules{{"beating", beating()}};
  for (const RenderScene& scene : write_render_scenes(folder))
    modules.emplace_back(scene.name, tests::lowered_file(scene.path));
  for (const auto& scene : modules) {
    CAPTURE(scene.first);
    const auto [program, judge] = tests::judged(scene.second, judged());
    auto kept = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
    auto kept_steady = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
    auto everything = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
    auto anew = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
    std::size_t differing_bytes = 0, unsteady = 0, pixels = 0, different_regions = 0;
    float largest_difference = 0.0f;
    for (runtime::View view : film()) {
      const auto steady = kept_steady.render(view);
      view.disabled_passes = {"trials"};  // verdicts and leaders in each frame, whether they pay or not
      const auto all = everything.render(view);
      REQUIRE(all);
      view.steady_colors = false;
      view.disabled_passes = {};
      const auto got = kept.render(view);
      view.disabled_passes = {"verdicts", "reach", "keep-still", "keep-picture", "keep-surface"};
      const auto expected = anew.render(view);
      REQUIRE(got);
      REQUIRE(expected);
      REQUIRE(steady);
      unsteady += steady->rgba != expected->rgba || steady->regions != expected->regions;
      unsteady += all->rgba != expected->rgba || all->regions != expected->regions;
      pixels += expected->regions.size();
      for (std::size_t i = 0; i < got->regions.size(); ++i)
        different_regions += got->regions[i] != expected->regions[i];
      for (std::size_t i = 0; i < got->rgba.size(); ++i) {
        largest_difference = std::max(largest_difference, std::abs(got->rgba[i] - expected->rgba[i]));
        differing_bytes += runtime::to_byte(got->rgba[i]) != runtime::to_byte(expected->rgba[i]);
      }
    }
    CHECK(unsteady == 0);
    CHECK(different_regions == 0);
    CHECK(largest_difference < 1e-3f);  // a bitmap's coordinates are composed in double in place of step by step
    CHECK(differing_bytes < pixels / 10000);
  }
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}

TEST_CASE("each pass of a frame can be switched off alone") {
  const auto [program, judge] = tests::judged(beating(), judged());
  auto plain = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
  for (const runtime::FramePassInfo& pass : runtime::frame_pass_names()) {
    CAPTURE(pass.name);
    auto without = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
    for (int i = 0; i < 8; ++i) {
      runtime::View view = view_at(0.3, 30.0 * (i / 2));
      const auto expected = plain.render(view);
      view.disabled_passes = {std::string(pass.name)};
      const auto got = without.render(view);
      REQUIRE(got);
      CHECK(got->regions == expected->regions);
      CHECK(got->rgba == expected->rgba);
    }
  }
}
