// Which way is fastest, by times that are made up.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <map>

#include "runtime/frame/autotuner.h"

using dmvv::runtime::Autotuner;

namespace {

/// Frames whose ways take these times; how often each way was taken.
std::map<std::size_t, int> run(Autotuner& trials, const std::array<double, 3>& ms, const std::array<bool, 3>& possible,
                               int frames) {
  std::map<std::size_t, int> taken;
  for (int i = 0; i < frames; ++i) {
    const std::size_t way = trials.begin(possible);
    CHECK(possible[way]);
    ++taken[way];
    trials.end(way, ms[way]);
  }
  return taken;
}

constexpr std::array all{true, true, true};

}  // namespace

TEST_CASE("the way it starts with is kept until the first trial, then the fastest is") {
  Autotuner trials(3, 1);
  CHECK(run(trials, {10.0, 20.0, 30.0}, all, Autotuner::first_hold)[1] == Autotuner::first_hold);
  CHECK(run(trials, {10.0, 20.0, 30.0}, all, 200)[0] > 180);
}

TEST_CASE("a way that is much slower is left after one frame, and tried less and less often") {
  Autotuner trials(3, 0);
  auto taken = run(trials, {10.0, 100.0, 100.0}, all, 5000);
  CHECK(taken[1] + taken[2] < 24);
  CHECK(taken[1] > 0);
}

TEST_CASE("another scene is noticed at once") {
  Autotuner trials(3, 0);
  run(trials, {10.0, 12.0, 13.0}, all, 2000);
  CHECK(run(trials, {50.0, 12.0, 13.0}, all, 100)[1] > 80);
}

TEST_CASE("only what is possible is tried") {
  Autotuner trials(3, 2);
  CHECK(run(trials, {10.0, 1.0, 20.0}, {true, false, true}, 300)[0] > 200);
  CHECK(run(trials, {10.0, 1.0, 20.0}, {true, false, false}, 100)[0] == 100);
}

TEST_CASE("a way that becomes faster by being used is given the time to") {
  const auto frames_of_learner = [](Autotuner trials) {
    int used = 0, late = 0;
    for (int i = 0; i < 800; ++i) {
      const std::size_t way = trials.begin(all);
      used += way == 1;
      late += i >= 600 && way == 1;
      trials.end(way, way == 1 ? std::max(4.0, 13.0 - 0.1 * used) : 10.0);  // as fast as the others after 30 frames
    }
    return late;
  };
  CHECK(frames_of_learner(Autotuner(3, 0, {false, true, false})) > 180);
  CHECK(frames_of_learner(Autotuner(3, 0)) < 20);
}
