#include "cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <utility>

namespace dmvv::cli {
namespace {

std::string clock_text(double seconds) {
  const auto s = static_cast<long long>(std::ceil(seconds));
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

}  // namespace

std::string progress_text(const std::string& what, std::size_t done, std::size_t total, std::size_t fresh,
                          double seconds) {
  constexpr std::size_t width = 20;
  const std::size_t filled = total == 0 ? width : done * width / total;
  std::string text = fmt::format("{} [{:#<{}}{:-<{}}] {}/{} {:3} %", what, "", filled, "", width - filled, done, total,
                                 total == 0 ? 100 : done * 100 / total);
  if (fresh != 0) {
    text +=
        fmt::format("  {} left", clock_text(seconds / static_cast<double>(fresh) * static_cast<double>(total - done)));
  }
  return text;
}

ProgressBar::ProgressBar(std::string what, std::size_t total, std::size_t already_done, bool quiet,
                         std::chrono::milliseconds patience)
    : what_(std::move(what)),
      total_(total),
      done_(already_done),
      already_done_(already_done),
      visible_(!quiet && isatty(STDERR_FILENO)),
      patience_(patience),
      start_(Clock::now()) {
  if (visible_ && patience_.count() == 0) draw();
}

ProgressBar::~ProgressBar() {
  if (visible_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::advance_to(std::size_t done) {
  done_ = done;
  if (!visible_) return;
  const auto now = Clock::now();
  if (now - start_ >= patience_ && now - last_drawn_ >= std::chrono::milliseconds(100)) draw();
}

void ProgressBar::draw() {
  last_drawn_ = Clock::now();
  const double seconds = std::chrono::duration<double>(last_drawn_ - start_).count();
  const std::string text = progress_text(what_, done_, total_, done_ - already_done_, seconds);
  std::fputs(fmt::format("\r{}\033[K", text).c_str(), stderr);
}

}  // namespace dmvv::cli
