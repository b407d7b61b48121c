// Frames of several tiles: what a frame keeps for the next one, it keeps at every size.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "runtime/runtime.h"
#include "tests/render/render_scenes.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

const char* const beating_text = R"(<MVV>
  <OBJECT name="ROOT"><SDF name="WALL" function="true">return p.x;</SDF>
    <SDF name="BALL" function="true">return length(p - vec3(0.4, 0.0, 0.2)) - 0.4 - 0.1 * sin(0.01 * t);</SDF>
    <REGION name="IN" type="color" rgb="1 0.2 0"/><REGION name="OUT" type="color" rgb="0 0 1"/><REGION name="LEFT" type="color" rgb="0 1 0"/>
    <MAPPINGS><SDF name="WALL"><POSITIVE><SDF name="BALL"><POSITIVE region="OUT"/><NEGATIVE region="IN"/></SDF></POSITIVE>
      <NEGATIVE region="LEFT"/></SDF></MAPPINGS></OBJECT></MVV>)";

struct Size {
  glm::uvec2 px;
  std::uint32_t samples;
};

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

double gpu_ms(const runtime::Timings& timings) {
  const auto found = std::ranges::find(timings, std::string(runtime::gpu_step), &runtime::Timing::step);
  return found == timings.end() ? 0.0 : found->ms;
}

runtime::View view_of(const Size& size) {
  runtime::View view;
  view.size_px = size.px;
  view.samples = size.samples;
  view.camera.eye = {2.0, 1.5, 5.0};
  view.cuts = {{{0.0, 0.0, 1.0}, 0.2}};
  view.want_regions = true;
  view.colors = runtime::Colors::bytes;
  return view;
}

}  // namespace

TEST_CASE("a frame in which nothing changes is kept, however many tiles it has") {
  compiler::CompileOptions options;
  options.many_frames = true;
  const auto [program, judge] = tests::judged(tests::lowered(beating_text), options);
  for (const Size& size : {Size{{1280, 720}, 1}, Size{{2560, 1440}, 1}, Size{{1920, 1080}, 2}}) {
    CAPTURE(size.px.x);
    CAPTURE(size.samples);
    auto evaluator = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
    runtime::View view = view_of(size);
    const auto first = evaluator.render(view);
    REQUIRE(first);
    const std::string plan = evaluator.plan(view).value();
    const std::size_t tiles = count_of(plan, "tile ");
    CHECK(count_of(plan, ", kept") == tiles);
    CHECK(plan == evaluator.plan(view).value());  // asking changes nothing
    runtime::Timings timings;
    const auto again = evaluator.render(view, &timings);
    REQUIRE(again);
    CHECK(gpu_ms(timings) == 0.0);  // nothing was submitted
    CHECK(again->regions == first->regions);
    CHECK(again->rgba8 == first->rgba8);
  }
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}

TEST_CASE("while only the time changes, no tile draws its surface, and what stands still is kept") {
  compiler::CompileOptions options;
  options.many_frames = true;
  const auto [program, judge] = tests::judged(tests::lowered(beating_text), options);
  auto kept = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
  auto anew = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
  runtime::View view = view_of({{2560, 1440}, 1});
  view.disabled_passes = {"trials"};
  for (int frame = 0; frame < 4; ++frame) {
    view.time_ms = 40.0 * frame;
    if (frame > 0) {
      const std::string plan = kept.plan(view).value();
      CHECK(count_of(plan, "raster") == 0);
      CHECK(count_of(plan, "what stands still is kept") == count_of(plan, "\ntile "));
    }
    const auto got = kept.render(view);
    runtime::View plain = view;
    plain.disabled_passes = {"verdicts", "reach", "keep-still", "keep-picture", "keep-surface"};
    const auto expected = anew.render(plain);
    REQUIRE(got);
    REQUIRE(expected);
    CHECK(got->regions == expected->regions);
    CHECK(got->rgba8 == expected->rgba8);
  }
}

TEST_CASE("a picture stays on the device until somebody wants it, and is what it would have been") {
  compiler::CompileOptions options;
  options.many_frames = true;
  const auto [program, judge] = tests::judged(tests::lowered(beating_text), options);
  auto evaluator = runtime::Evaluator::create(device(), program, nullptr, {}, judge).value();
  auto anew = runtime::Evaluator::create(device(), program).value();
  for (const Size& size : {Size{{640, 360}, 1}, Size{{2560, 1440}, 1}}) {
    CAPTURE(size.px.x);
    runtime::View view = view_of(size);
    for (int frame = 0; frame < 6; ++frame) {  // each begins while the one before is under way
      view.time_ms = 40.0 * frame;
      REQUIRE(evaluator.draw(view));
    }
    runtime::Timings timings;
    REQUIRE(evaluator.finish(&timings));
    CHECK(gpu_ms(timings) > 0.0);
    const std::string plan = evaluator.plan(view).value();
    CHECK(count_of(plan, "bring home") == count_of(plan, "\ntile "));  // that alone is left to do
    CHECK(count_of(plan, ", kept") == count_of(plan, "\ntile "));
    CHECK(count_of(plan, "report") == 0);
    const auto got = evaluator.render(view);
    const auto expected = anew.render(view);
    REQUIRE(got);
    REQUIRE(expected);
    CHECK(got->regions == expected->regions);
    CHECK(got->rgba8 == expected->rgba8);
    CHECK(count_of(evaluator.plan(view).value(), "bring home") == 0);  // it is home now
  }
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}

TEST_CASE("while frames are drawn, another thread makes the next scene ready on the same device") {
  const compiler::Program program = tests::compiled(tests::lowered(beating_text), {});
  auto evaluator = runtime::Evaluator::create(device(), program).value();
  runtime::View view = view_of({{320, 180}, 1});
  const auto expected = evaluator.render(view);
  REQUIRE(expected);
  std::atomic<bool> stop = false;
  std::thread next([&] {
    while (!stop) {
      auto other = runtime::Evaluator::create(device(), program).value();
      const auto picture = other.render(view);
      if (!picture || picture->rgba8 != expected->rgba8) stop = true;
    }
  });
  int drawn = 0;
  for (; drawn < 60 && !stop; ++drawn) {
    view.time_ms = 10.0 * (drawn % 7);
    if (!evaluator.draw(view)) break;
  }
  const bool went_on = !stop.exchange(true);
  next.join();
  CHECK(drawn == 60);
  CHECK(went_on);
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}
