// How much is spent on proofs, and whether proofs for a span of time pay: a pure policy, told what frames took.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace dmvv::runtime {

/// A span of time in milliseconds, lo <= hi.
struct TimeSpan {
  double lo;
  double hi;
  bool contains(double time_ms) const { return lo <= time_ms && time_ms <= hi; }
  friend bool operator==(const TimeSpan&, const TimeSpan&) = default;
};

/// Rent or buy: a cell is split when the pixels that it left to be evaluated have cost half as much as splitting it. So
/// what is spent on proofs is at most twice what was spent on evaluation.
class ProofBudget {
 public:
  static constexpr std::uint32_t least_hits = 8, most_hits = 1u << 20;
  static constexpr double frames_a_span = 16.0;
  static constexpr std::uint32_t longest_pause = 256;  ///< spans
  static constexpr double share_for_splitting = 0.25;  ///< of a frame's time, beside it

  // ---- spans of time ----

  /// The span that begins at a frame's time: the next frames while time goes on, this moment while it stands. Nothing
  /// while spans of time that goes on are left out, because one did not pay. Judges the span before.
  std::optional<TimeSpan> begin_span(double time_ms);
  void note_time(double time_ms) {
    last_time_ms_ = time_ms;
    has_time_ = true;
  }

  // ---- cells ----

  /// How many hits a cell gets before it is split.
  std::uint32_t hits_to_split() const;
  /// What a frame took: on the device, for so many evaluated pixels; `drew`: the surface as well.
  void note_frame(std::uint32_t evaluated, double ms, bool drew);
  /// How many cells may be split after a frame that took so long; at least one.
  std::size_t affordable_cells(double ms) const {
    return static_cast<std::size_t>(share_for_splitting * 1e6 * ms / ns_a_cell()) + 1;
  }
  void note_splitting(std::size_t cells, double ns, bool of_span);

  double ns_a_pixel() const { return ns_a_pixel_; }
  double ns_a_cell() const { return split_ns_ / split_cells_; }

 private:
  static constexpr double memory_of_splits = 0.9;
  static constexpr double share_of_evaluation = 0.5;  ///< of a frame that draws the surface as well: a guess
  void judge_span();

  double last_time_ms_ = 0.0;
  bool has_time_ = false;
  bool is_in_span_ = false;

  bool is_pixel_measured_ = false;  ///< in a frame without a surface to draw; else it is guessed
  double ns_a_pixel_ = 0.0;         ///< of evaluation, as last measured on many pixels; 0: not yet
  std::size_t most_evaluated_ = 0;
  double split_ns_ = 5e5, split_cells_ = 10.0;  ///< what splitting cost lately, and of how many cells

  double spent_ns_ = 0.0, saved_ns_ = 0.0;    ///< in this span
  std::uint32_t first_count_ = 0;             ///< most pixels that a frame of it had to evaluate
  std::uint32_t pause_ = 0, next_pause_ = 1;  ///< spans left out, now and after the next that does not pay
};

}  // namespace dmvv::runtime
