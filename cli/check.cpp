// dmvv check SCENE...: every mistake of every scene, with its place.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "base/files.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "compiler/reference/lint.h"

namespace dmvv::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> paths;
  SceneOptions scene;
};

/// A bar for a step of one scene, drawn where the step takes more than a second.
class StepBar {
 public:
  StepBar(std::string what, bool quiet) : what_(std::move(what)), quiet_(quiet) {}

  void operator()(std::size_t done, std::size_t total) {
    using namespace std::chrono_literals;
    const auto spent = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start_);
    if (!bar_) bar_.emplace(what_, total, 0, quiet_, std::max(1ms, 1000ms - spent));
    bar_->advance_to(done);
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool quiet_;
  Clock::time_point start_ = Clock::now();
  std::optional<ProgressBar> bar_;
};

bool is_fine(const std::string& path, const CheckOptions& options, Context& context) {
  Diagnostics diagnostics(options.scene.strict);
  auto scene = voml::read_scene(path, disk_files(), {options.scene.root, true}, diagnostics);
  std::string counts;
  if (scene) {
    counts = fmt::format("{}, {}, {}", plural(scene->objects.size(), "object"), plural(scene->sdfs.size(), "SDF"),
                         plural(scene->regions.size(), "region"));
    const auto module = [&] {
      StepBar bar(path + ": functions", context.quiet);
      return compiler::lower(std::move(*scene), diagnostics, {.check_everything = true, .progress = std::ref(bar)});
    }();
    StepBar bar(path + ": SDFs", context.quiet);
    if (module) compiler::lint(*module, diagnostics, std::ref(bar));
  }
  context.stopwatch.lap("check");
  print_diagnostics(diagnostics, context);
  if (diagnostics.has_errors()) return false;
  const std::size_t warnings = diagnostics.warning_count();
  const std::string verdict = warnings == 0 ? "fine" : "usable, " + plural(warnings, "warning");
  if (!context.quiet) print_result(fmt::format("{}: {}: {}\n", path, verdict, counts));
  return true;
}

int check(const CheckOptions& options, Context& context) {
  bool all_fine = true;
  for (const std::string& path : options.paths) all_fine &= is_fine(path, options, context);
  return all_fine ? exit_done : exit_input;
}

}  // namespace

void add_check(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App& command = *app.add_subcommand("check", "Report every mistake in scenes and the files they name");
  command.add_option("SCENE", options->paths, "VOML files")->required()->type_name("");
  add_root_and_strict(command, options->scene);
  add_common_options(command, invocation.context);
  command.footer("Example:  dmvv check --strict examples/*/*.voml");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return check(*options, context); };
  });
}

}  // namespace dmvv::cli
