// A bar that shows on a terminal how far a long command is.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace dmvv::cli {

/// "frames [########------------] 120/300  40 %  1:23 left". The time left is told once something is done; `seconds`
/// were spent on the `fresh` of the `done` that were not there before.
std::string progress_text(const std::string& what, std::size_t done, std::size_t total, std::size_t fresh,
                          double seconds);

/// Writes to stderr, at most ten times a second, and only if that is a terminal and `quiet` is not set.
/// The line is cleared when the bar goes out of scope.
class ProgressBar {
 public:
  /// Nothing is drawn within the first `patience`: what ends by then needs no bar.
  ProgressBar(std::string what, std::size_t total, std::size_t already_done, bool quiet,
              std::chrono::milliseconds patience = std::chrono::milliseconds(0));
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  /// One more is done.
  void advance() { advance_to(done_ + 1); }
  void advance_to(std::size_t done);

 private:
  using Clock = std::chrono::steady_clock;
  void draw();

  std::string what_;
  std::size_t total_, done_, already_done_;
  bool visible_;
  std::chrono::milliseconds patience_;
  Clock::time_point start_, last_drawn_;
};

}  // namespace dmvv::cli
