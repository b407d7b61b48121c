// Inside the runtime only: which of some ways to do the same is fastest, found by trying.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace dmvv::runtime {

/// Ways 0, 1, ... are tried in turn now and then; the fastest is kept for a while, for longer and longer while it stays
/// the fastest. Pure: times are what it is told.
class Autotuner {
 public:
  static constexpr std::uint32_t first_hold = 16, longest_hold = 1024;  ///< frames
  /// A trial judges a way by the last frames that it drew.
  static constexpr std::size_t judged_frames = 3;
  /// A trial gives so many frames to a way that speeds up with use.
  static constexpr std::size_t learning_frames = 12;

  /// Until the first trial, `start` is the way. `learns` says which ways become faster by being used, if any do.
  Autotuner(std::size_t ways, std::size_t start, std::vector<bool> learns = {})
      : samples_(ways), learns_(std::move(learns)), best_(start) {
    learns_.resize(ways, false);
  }

  /// The way of the next frame, among those that are possible.
  std::size_t begin(std::span<const bool> possible) {
    if (!trying_ && hold_ == 0) start_trial();
    while (trying_ && !possible[order_[next_]]) advance();
    if (trying_) return order_[next_];
    if (hold_ > 0) --hold_;
    return possible[best_] ? best_ : 0;
  }

  /// What that frame took.
  void end(std::size_t way, double ms) {
    if (!trying_) return watch(way, ms);
    std::vector<double>& taken = samples_[way];
    taken.push_back(ms);
    least_ = std::min(least_, ms);
    if (taken.size() >= (learns_[way] ? learning_frames : judged_frames) || ms > hopeless * least_) advance();
  }

 private:
  static constexpr double hopeless = 1.5;  ///< times the least: such a way is not tried again in this trial
  static constexpr double other_scene = 2.0;
  static constexpr std::uint32_t frames_of_other_scene = 3;

  void start_trial() {
    for (std::vector<double>& taken : samples_) taken.clear();
    order_.clear();
    order_.push_back(best_);
    for (std::size_t way = 0; way < samples_.size(); ++way) {
      if (way != best_) order_.push_back(way);
    }
    next_ = 0;
    least_ = unknown;
    trying_ = true;
  }

  void advance() {
    if (++next_ != order_.size()) return;
    trying_ = false;
    std::size_t fastest = best_;
    expected_ms_ = unknown;
    for (const std::size_t way : order_) {
      const std::vector<double>& taken = samples_[way];
      if (taken.empty()) continue;
      const double ms = last_median(taken);
      if (ms >= expected_ms_) continue;
      expected_ms_ = ms;
      fastest = way;
    }
    next_hold_ = fastest == best_ ? std::min(2 * next_hold_, longest_hold) : first_hold;
    hold_ = next_hold_;
    best_ = fastest;
    surprises_ = 0;
  }

  static double last_median(const std::vector<double>& taken) {
    std::vector<double> last(taken.end() - static_cast<std::ptrdiff_t>(std::min(taken.size(), judged_frames)),
                             taken.end());
    std::ranges::sort(last);
    return last[last.size() / 2];
  }

  /// Frames that take much longer, or shorter, than the trial found are of something else: that is tried anew.
  void watch(std::size_t way, double ms) {
    if (way != best_ || expected_ms_ == unknown) return;
    const bool is_other = ms > other_scene * expected_ms_ || other_scene * ms < expected_ms_;
    surprises_ = is_other ? surprises_ + 1 : 0;
    if (surprises_ >= frames_of_other_scene) hold_ = 0;
  }

  static constexpr double unknown = 1e300;
  std::vector<std::vector<double>> samples_;  ///< milliseconds, of this trial
  std::vector<bool> learns_;                  ///< of each way
  std::vector<std::size_t> order_;            ///< of this trial: the best one first
  std::size_t next_ = 0;                      ///< place in order_
  std::size_t best_;
  bool trying_ = false;
  double least_ = unknown, expected_ms_ = unknown;
  std::uint32_t hold_ = first_hold, next_hold_ = first_hold, surprises_ = 0;
};

}  // namespace dmvv::runtime
