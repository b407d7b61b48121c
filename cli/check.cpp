// dmvv check SCENE...: every mistake of every scene, with its place.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/options.h"
#include "compiler/lint.h"
#include "voml/files.h"

namespace dmvv::cli {
namespace {

struct CheckOptions {
  std::vector<std::string> paths;
  SceneOptions scene;
};

bool is_fine(const std::string& path, const CheckOptions& options, Context& context) {
  Diagnostics diagnostics(options.scene.strict);
  auto scene = voml::read_scene(path, disk_files(), {options.scene.root, true}, diagnostics);
  std::string counts;
  if (scene) {
    counts = fmt::format("{}, {}, {}", plural(scene->objects.size(), "object"), plural(scene->sdfs.size(), "SDF"),
                         plural(scene->regions.size(), "region"));
    const auto module = compiler::lower(std::move(*scene), diagnostics, {.check_everything = true});
    if (module) compiler::lint(*module, diagnostics);
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
