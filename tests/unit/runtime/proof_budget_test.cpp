// How much is spent on proofs: told what frames took, without a device or a judge.
#include <doctest/doctest.h>

#include "runtime/frame/proof_budget.h"

using namespace dmvv::runtime;

TEST_CASE("a span is a moment while time stands, and sixteen frames while it goes on") {
  ProofBudget budget;
  CHECK(budget.begin_span(100.0) == TimeSpan{100.0, 100.0});
  budget.note_time(100.0);
  CHECK(budget.begin_span(140.0) == TimeSpan{140.0, 140.0 + 15.0 * 40.0});
  budget.note_time(140.0);
  CHECK(budget.begin_span(100.0) == TimeSpan{100.0 - 15.0 * 40.0, 100.0});  // backwards
}

TEST_CASE("a cell is split when its pixels have cost half as much as splitting it") {
  ProofBudget budget;
  CHECK(budget.hits_to_split() == ProofBudget::most_hits);  // nothing is known of pixels yet
  budget.note_frame(100'000, 10.0, false);                  // 10 ms for 100,000 pixels: 100 ns each
  CHECK(budget.ns_a_pixel() == doctest::Approx(100.0));
  CHECK(budget.hits_to_split() == static_cast<std::uint32_t>(0.5 * budget.ns_a_cell() / 100.0));
}

TEST_CASE("a frame that draws the surface as well is a guess, which a measured one replaces for good") {
  ProofBudget budget;
  budget.note_frame(100'000, 20.0, true);
  CHECK(budget.ns_a_pixel() == doctest::Approx(100.0));  // half of the frame
  budget.note_frame(100'000, 30.0, false);
  CHECK(budget.ns_a_pixel() == doctest::Approx(300.0));
  budget.note_frame(100'000, 20.0, true);
  CHECK(budget.ns_a_pixel() == doctest::Approx(300.0));
  budget.note_frame(10, 5.0, false);  // few pixels: what a frame costs anyway would be theirs
  CHECK(budget.ns_a_pixel() == doctest::Approx(300.0));
}

TEST_CASE("splitting takes a quarter of a frame, and always a cell") {
  ProofBudget budget;
  budget.note_splitting(1000, 1e9, false);  // a millisecond a cell
  const double cell_ms = 1e-6 * budget.ns_a_cell();
  CHECK(budget.affordable_cells(0.0) == 1);
  CHECK(budget.affordable_cells(41.0 * cell_ms) == 11);
}

TEST_CASE("spans that save less than they cost are left out, twice as long each time, up to a limit") {
  ProofBudget budget;
  double now = 0.0;
  const auto begin = [&] {
    budget.note_time(now);
    now += 1000.0;
    return budget.begin_span(now).has_value();
  };
  budget.begin_span(now);
  std::uint32_t expected_pause = 1;
  for (int round = 0; round < 10; ++round) {
    budget.note_splitting(10, 1e6, true);  // spent, and no frame saved anything
    std::uint32_t pause = 0;
    while (!begin()) ++pause;
    CHECK(pause == expected_pause);
    expected_pause = std::min(2 * expected_pause, ProofBudget::longest_pause);
  }
}

TEST_CASE("a span that pays is followed by the next one at once") {
  ProofBudget budget;
  budget.begin_span(0.0);
  budget.note_time(0.0);
  budget.note_frame(100'000, 10.0, false);  // the span's first frame: everything is evaluated
  budget.note_splitting(10, 1e6, true);     // a millisecond is spent
  budget.note_frame(10'000, 1.0, false);    // 90,000 pixels of 100 ns are saved: nine milliseconds
  CHECK(budget.begin_span(40.0).has_value());
}
