#include "runtime/frame/proof_budget.h"

namespace dmvv::runtime {

std::optional<TimeSpan> ProofBudget::begin_span(double time_ms) {
  judge_span();
  is_in_span_ = false;
  const double end = has_time_ ? time_ms + (frames_a_span - 1.0) * (time_ms - last_time_ms_) : time_ms;
  if (pause_ > 0 && end != time_ms) {
    --pause_;
    return std::nullopt;
  }
  is_in_span_ = true;
  return TimeSpan{std::min(time_ms, end), std::max(time_ms, end)};
}

/// Was the span worth it? If not, the next ones are left out, more and more.
void ProofBudget::judge_span() {
  if (!is_in_span_) return;
  if (saved_ns_ < spent_ns_) {
    pause_ = next_pause_;
    next_pause_ = std::min(2 * next_pause_, longest_pause);
  } else {
    next_pause_ = 1;
  }
  spent_ns_ = saved_ns_ = 0.0;
  first_count_ = 0;
}

std::uint32_t ProofBudget::hits_to_split() const {
  if (ns_a_pixel_ == 0.0) return most_hits;
  const double hits = 0.5 * ns_a_cell() / ns_a_pixel_;
  return static_cast<std::uint32_t>(std::clamp(hits, double{least_hits}, double{most_hits}));
}

void ProofBudget::note_frame(std::uint32_t evaluated, double ms, bool drew) {
  // Few pixels are measured badly: what a frame costs anyway would be counted as theirs.
  if (2 * std::size_t{evaluated} >= most_evaluated_ && evaluated != 0 && !(drew && is_pixel_measured_)) {
    most_evaluated_ = std::max<std::size_t>(most_evaluated_, evaluated);
    is_pixel_measured_ = !drew;
    ns_a_pixel_ = 1e6 * ms / evaluated * (drew ? share_of_evaluation : 1.0);
  }
  // What the span's verdicts save is seen against its first frame, which has few of them.
  first_count_ = std::max(first_count_, evaluated);
  saved_ns_ += ns_a_pixel_ * (first_count_ - evaluated);
}

void ProofBudget::note_splitting(std::size_t cells, double ns, bool of_span) {
  split_ns_ = memory_of_splits * split_ns_ + ns;
  split_cells_ = memory_of_splits * split_cells_ + static_cast<double>(cells);
  if (of_span) spent_ns_ += ns;
}

}  // namespace dmvv::runtime
