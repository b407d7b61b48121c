// Which strategy a frame takes: told what earlier frames took.
#include <doctest/doctest.h>

#include "runtime/frame/strategy.h"

using namespace dmvv::runtime;

namespace {
constexpr StrategyChoice::Program everything{.has_judge = true, .has_leaders = true};
}

TEST_CASE("the first frame takes no proofs; nor does one without lists of pixels or at times beyond any proof") {
  StrategyChoice choice(everything);
  CHECK(choice.begin({}, true) == Strategy{});
  choice.note_picture();
  CHECK(choice.begin({.pixel_list = false}, true) == Strategy{});
  CHECK(choice.begin({}, false) == Strategy{});
}

TEST_CASE("without trials all that is possible is taken") {
  StrategyChoice choice(everything);
  choice.note_picture();
  const FramePasses all{.trials = false};
  CHECK(choice.begin(all, true) == Strategy{true, true});
  FramePasses some = all;
  some.verdicts = false;
  CHECK(choice.begin(some, true) == Strategy{false, true});
  some.reach = false;
  CHECK(choice.begin(some, true) == Strategy{});
  StrategyChoice poor(StrategyChoice::Program{});
  poor.note_picture();
  CHECK(poor.begin(all, true) == Strategy{});
}

TEST_CASE("leaders wait until frames have taken as long as their kernel takes to compile") {
  StrategyChoice choice({.has_judge = false, .has_leaders = true});
  choice.note_picture();
  choice.note_compilation(100.0);
  bool has_led = false;
  double taken_ms = 0.0;
  for (int frame = 0; frame < 200; ++frame) {
    const Strategy strategy = choice.begin({}, true);
    if (strategy.leads) {
      has_led = true;
      CHECK(taken_ms >= 100.0);
    }
    choice.end(strategy, {}, 2.0, 0.0);
    taken_ms += 2.0;
  }
  CHECK(has_led);
}

TEST_CASE("the strategy that is fastest is found and kept") {
  StrategyChoice choice(everything);
  choice.note_picture();
  int fastest = 0;
  for (int frame = 0; frame < 400; ++frame) {
    const Strategy strategy = choice.begin({}, true);
    const bool is_best = strategy == Strategy{.classifies = false, .leads = true};
    choice.end(strategy, {}, is_best ? 1.0 : 5.0, 0.0);
    if (frame >= 200 && is_best) ++fastest;
  }
  CHECK(fastest > 150);
}

TEST_CASE("names of passes switch them off") {
  const std::vector<std::string> off{"verdicts", "keep-still"};
  const FramePasses passes = FramePasses::without(off);
  CHECK(passes == FramePasses{.verdicts = false, .keep_still = false});
}
