// What every subcommand shares: how it was called, how it speaks, how it stops, and the time it takes.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "base/result.h"
#include "runtime/runtime.h"

namespace dmvv::cli {

inline constexpr int exit_done = 0;
inline constexpr int exit_input = 1;        ///< the fault of a file or scene
inline constexpr int exit_environment = 2;  ///< wrong usage, or the machine

/// Thrown by a command that cannot go on; main prints it.
struct Failure {
  int exit_code;
  Error error;
};

/// Thrown by a command that has printed why it cannot go on.
struct Stop {
  int exit_code;
};

[[noreturn]] void fail_with(Error error);
[[noreturn]] void fail_usage(std::string message, std::vector<std::string> reasons = {});

/// The value, or the end of the command with exit code 1 or 2.
template <class T>
T must(Result<T> result) {
  if (!result) fail_with(std::move(result.error()));
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// The value of an option's text; a wrong one is wrong usage. `option` names it in the message.
template <class T>
T must_parse(const std::string& option, Result<T> result) {
  if (!result) fail_usage(option + ": " + result.error().message, std::move(result.error().reasons));
  return std::move(*result);
}

/// Wall time since the process was started, as steps without gaps: each lap ends where the next begins.
class Stopwatch {
 public:
  Stopwatch();

  /// The time since the last lap was spent on `step`. A step that comes again is added to; of one that comes
  /// often, the table tells the median as well.
  void lap(const std::string& step);
  /// The same time, of which `inner` is known to have been spent on the steps it names; what remains is `rest`.
  void lap(const runtime::Timings& inner, const std::string& rest);
  /// Seconds since the process was started.
  double seconds() const;
  /// Ends with the step "close" and prints the table on stderr.
  void print();

 private:
  struct Step {
    std::string name;
    std::vector<double> laps_ms;
  };
  void add(const std::string& step, double ms);

  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_;
  std::vector<Step> steps_;
};

struct Context {
  bool quiet = false;
  bool timings = false;
  Stopwatch stopwatch;
};

/// The command that the arguments chose.
struct Invocation {
  Context context;
  std::function<int(Context&)> command;
};

void print_error(const Error& error);
void print_warning(const std::string& message);
/// Prints to stderr; warnings alone are kept back by --quiet.
void print_diagnostics(const Diagnostics& diagnostics, const Context& context);
/// Prints the diagnostics and stops with exit code 1.
[[noreturn]] void stop_with(const Diagnostics& diagnostics, const Context& context);

/// "1 seed", "2 seeds"
std::string plural(std::size_t count, std::string_view noun);

/// Writes to stdout. A reader that closed the pipe or a full disk ends the command.
void print_result(const std::string& text);

}  // namespace dmvv::cli
