// Inside the runtime only: which of some ways to do the same is fastest, found by trying.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dmvv::runtime {

/// Ways 0, 1, ... are tried in turn now and then; the fastest is kept for a while, for longer and longer while it stays
/// the fastest. Pure: times are what it is told.
class Trials {
 public:
  static constexpr std::uint32_t first_hold = 16, longest_hold = 1024;  ///< frames
  static constexpr std::size_t frames_a_way = 3;

  /// Until the first trial, `start` is the way.
  Trials(std::size_t ways, std::size_t start) : samples_(ways), best_(start) {}

  /// The way of the next frame, among those that are possible.
  std::size_t begin(std::span<const bool> possible) {
    if (!trying_ && hold_ == 0) start_trial();
    while (trying_ && !possible[*next_]) advance();
    if (trying_) return *next_;
    if (hold_ > 0) --hold_;
    return possible[best_] ? best_ : 0;
  }

  /// What that frame took.
  void end(std::size_t way, double ms) {
    if (!trying_) return watch(way, ms);
    std::vector<double>& taken = samples_[way];
    taken.push_back(ms);
    least_ = std::min(least_, ms);
    if (taken.size() >= frames_a_way || ms > hopeless * least_) advance();
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
    next_ = order_.begin();
    least_ = unknown;
    trying_ = true;
  }

  void advance() {
    if (++next_ != order_.end()) return;
    trying_ = false;
    std::size_t fastest = best_;
    expected_ms_ = unknown;
    for (const std::size_t way : order_) {
      std::vector<double>& taken = samples_[way];
      if (taken.empty()) continue;
      std::ranges::sort(taken);
      if (taken[taken.size() / 2] >= expected_ms_) continue;
      expected_ms_ = taken[taken.size() / 2];
      fastest = way;
    }
    next_hold_ = fastest == best_ ? std::min(2 * next_hold_, longest_hold) : first_hold;
    hold_ = next_hold_;
    best_ = fastest;
    surprises_ = 0;
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
  std::vector<std::size_t> order_;            ///< of this trial: the best one first
  std::vector<std::size_t>::iterator next_;
  std::size_t best_;
  bool trying_ = false;
  double least_ = unknown, expected_ms_ = unknown;
  std::uint32_t hold_ = first_hold, next_hold_ = first_hold, surprises_ = 0;
};

}  // namespace dmvv::runtime
