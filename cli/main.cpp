// The program `dmvv`: arguments in, exit code out. Each subcommand has its own file.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <new>
#include <variant>

#include "base/text.h"
#include "cli/commands.h"

namespace dmvv::cli {
namespace {

/// `--aov region=F depth=G` becomes `--aov region=F --aov depth=G`: an option that took all words that follow would
/// take the scene's name as well.
std::vector<std::string> arguments(int count, char** words) {
  std::vector<std::string> result;
  bool follows_aov = false;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const bool is_aov = word.starts_with("region=") || word.starts_with("depth=");
    if (is_aov && follows_aov && result.back() != "--aov") result.push_back("--aov");
    follows_aov = word == "--aov" || word.starts_with("--aov=") || (is_aov && follows_aov);
    result.push_back(word);
  }
  std::ranges::reverse(result);  // as CLI11 wants them
  return result;
}

int report_usage(const CLI::App& app, const CLI::ParseError& error) {
  std::string command = "dmvv";
  for (const CLI::App* chosen : app.get_subcommands()) command += ' ' + chosen->get_name();
  std::string message = error.what();
  if (app.get_subcommands().empty()) {
    const std::vector<std::string> words = app.remaining();
    message = words.empty() ? "no command given" : fmt::format("unknown command '{}'", words.front());
  }
  std::vector<std::string> ways_out{fmt::format("see {} --help", command)};
  const auto is_number = [](const std::string& word) { return std::holds_alternative<double>(parse_number(word)); };
  if (!app.get_subcommands().empty() && std::ranges::any_of(app.remaining(true), is_number)) {
    ways_out.insert(ways_out.begin(), "numbers that belong together stand in quotes, as in --point \"0 0.2 0.1\"");
  }
  print_error({Fault::environment, message, ways_out});
  return exit_environment;
}

int run(Invocation& invocation) {
  try {
    return invocation.command(invocation.context);
  } catch (const Failure& failure) {
    print_error(failure.error);
    return failure.exit_code;
  } catch (const Stop& stop) {
    return stop.exit_code;
  } catch (const std::bad_alloc&) {
    print_error({Fault::environment, "out of memory", {}});
  } catch (const std::exception& error) {
    print_error({Fault::environment, fmt::format("internal error: {}", error.what()), {"please report this"}});
  }
  return exit_environment;
}

int main_function(int count, char** words) {
  Invocation invocation;
  CLI::App app("Compiles VOML scenes, trees of signed distance functions embedded in each other, and draws them.",
               "dmvv");
  app.set_version_flag("--version", "dmvv " DMVV_VERSION);
  app.footer(
      "Example:  dmvv render examples/orange/orange.voml -o orange.png --cut \"0 0 1 0\"\n"
      "Exit codes: 0 done, 1 the fault of a file, 2 wrong usage or the machine. dmvv COMMAND --help says more.");
  app.require_subcommand(1);
  add_new(app, invocation);
  add_check(app, invocation);
  add_fmt(app, invocation);
  add_render(app, invocation);
  add_animate(app, invocation);
  add_probe(app, invocation);
  add_compile(app, invocation);
  add_info(app, invocation);
  add_sdf(app, invocation);
  add_mesh(app, invocation);
  add_seeds(app, invocation);
  add_bench(app, invocation);
  try {
    app.parse(arguments(count, words));
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code() == 0 ? app.exit(error) : report_usage(app, error);
  }
  const int exit_code = run(invocation);
  if (invocation.context.timings) invocation.context.stopwatch.print();
  return exit_code;
}

}  // namespace
}  // namespace dmvv::cli

/// jemalloc reads it when the process starts. Large pages: a third of the time from a scene to its first picture went
/// into faults of small ones, lavapipe's memory included. One arena, and nothing goes back: what a frame frees, the
/// next one takes.
extern "C" {
const char* malloc_conf = "thp:always,metadata_thp:auto,narenas:1,dirty_decay_ms:-1,muzzy_decay_ms:-1";
}

int main(int count, char** words) { return dmvv::cli::main_function(count, words); }
