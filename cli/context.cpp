#include "cli/context.h"

#include <fmt/core.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string_view>

namespace dmvv::cli {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

bool is_stderr_coloured() {
  static const bool coloured = isatty(STDERR_FILENO) && !std::getenv("NO_COLOR");
  return coloured;
}

std::string coloured(std::string_view text, std::string_view ansi) {
  return is_stderr_coloured() ? fmt::format("\033[{}m{}\033[0m", ansi, text) : std::string(text);
}
constexpr std::string_view red = "1;31";
constexpr std::string_view magenta = "1;35";

/// How long the process already existed before main: loading the shared libraries. /proc counts in clock ticks (10 ms).
Milliseconds age_of_process() {
  std::ifstream file("/proc/self/stat");
  std::string stat(std::istreambuf_iterator<char>(file), {});
  // The second field, the program's name, may hold blanks and ends with the last ')'; field 22 is the start time.
  const std::size_t name_end = stat.rfind(')');
  if (name_end == std::string::npos) return Milliseconds(0);
  std::istringstream fields(stat.substr(name_end + 1));
  std::string skipped;
  for (int field = 3; field < 22; ++field) fields >> skipped;
  double start_ticks = 0;
  timespec now{};
  if (!(fields >> start_ticks) || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return Milliseconds(0);
  const double now_s = static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  const double start_s = start_ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
  return Milliseconds(std::max(0.0, 1000.0 * (now_s - start_s)));
}

/// Colours the first "error[" or "warning[" word of each line.
std::string colour_severities(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); result += line + '\n') {
    for (const auto& [word, ansi] : {std::pair{": error[", red}, std::pair{": warning[", magenta}}) {
      const std::size_t begin = line.find(word);
      const std::size_t end = begin == std::string::npos ? begin : line.find(']', begin);
      if (end == std::string::npos) continue;
      line = line.substr(0, begin + 2) + coloured(line.substr(begin + 2, end - begin - 1), ansi) + line.substr(end + 1);
      break;
    }
  }
  return result;
}

}  // namespace

void fail_with(Error error) {
  const int exit_code = error.fault == Fault::input ? exit_input : exit_environment;
  throw Failure{exit_code, std::move(error)};
}

void fail_usage(std::string message, std::vector<std::string> reasons) {
  throw Failure{exit_environment, Error{Fault::environment, std::move(message), std::move(reasons)}};
}

Stopwatch::Stopwatch() : last_(Clock::now()) {
  const Milliseconds age = age_of_process();
  start_ = last_ - std::chrono::duration_cast<Clock::duration>(age);
  add("start", age.count());
}

void Stopwatch::add(const std::string& step, double ms) {
  for (Step& known : steps_) {
    if (known.name == step) return known.laps_ms.push_back(ms);
  }
  steps_.push_back({step, {ms}});
}

void Stopwatch::lap(const std::string& step) {
  const auto now = Clock::now();
  add(step, Milliseconds(now - last_).count());
  last_ = now;
}

void Stopwatch::lap(const runtime::Timings& inner, const std::string& rest) {
  const auto now = Clock::now();
  double unexplained = Milliseconds(now - last_).count();
  for (const runtime::Timing& timing : inner) {
    if (timing.step == runtime::gpu_step) continue;  // part of another step
    add(timing.step, timing.ms);
    unexplained -= timing.ms;
  }
  add(rest, std::max(0.0, unexplained));
  last_ = now;
}

double Stopwatch::seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

void Stopwatch::print() {
  lap("close");
  std::string table = "dmvv: timings in ms\n";
  for (Step& step : steps_) {
    auto& laps = step.laps_ms;
    table += fmt::format("  {:<10}{:>9.1f}", step.name, std::accumulate(laps.begin(), laps.end(), 0.0));
    if (laps.size() > 2) {
      const auto middle = laps.begin() + static_cast<std::ptrdiff_t>(laps.size() / 2);
      std::nth_element(laps.begin(), middle, laps.end());
      table += fmt::format("   {} times, median {:.2f}", laps.size(), *middle);
    }
    table += '\n';
  }
  table += fmt::format("  {:<10}{:>9.1f}\n", "total", Milliseconds(last_ - start_).count());
  std::fputs(table.c_str(), stderr);
}

void print_error(const Error& error) {
  std::string text = fmt::format("dmvv: {} {}\n", coloured("error:", red), error.message);
  for (const std::string& reason : error.reasons) text += fmt::format("  {}\n", reason);
  std::fputs(text.c_str(), stderr);
}

void print_warning(const std::string& message) {
  std::fputs(fmt::format("dmvv: {} {}\n", coloured("warning:", magenta), message).c_str(), stderr);
}

void print_diagnostics(const Diagnostics& diagnostics, const Context& context) {
  if (context.quiet && !diagnostics.has_errors()) return;
  const std::string text = diagnostics.render();
  std::fputs((is_stderr_coloured() ? colour_severities(text) : text).c_str(), stderr);
}

void stop_with(const Diagnostics& diagnostics, const Context& context) {
  print_diagnostics(diagnostics, context);
  throw Stop{exit_input};
}

std::string plural(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void print_result(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    fail_with({Fault::environment, "cannot write to the standard output", {}});
  }
}

}  // namespace dmvv::cli
