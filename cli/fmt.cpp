// dmvv fmt FILE...: scenes in their canonical layout.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <memory>

#include "base/files.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/outputs.h"
#include "voml/format.h"

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;

struct FmtOptions {
  std::vector<std::string> paths;
  bool check = false;
};

struct Formatted {
  std::string before;
  std::string after;
};

/// Nothing, and the reader's words on stderr, for what cannot be read.
std::optional<Formatted> format(const std::string& name, std::string text, Context& context) {
  Diagnostics diagnostics;
  const SourceId source = diagnostics.add_source(name, text);
  auto formatted = voml::format_document(source, diagnostics);
  print_diagnostics(diagnostics, context);
  context.stopwatch.lap("format");
  if (!formatted) return std::nullopt;
  return Formatted{std::move(text), std::move(*formatted)};
}

/// Puts `text` in place of a file, by a rename: a link stays a link, and the file keeps its permissions.
void replace(const std::string& path, std::string_view text) {
  std::error_code error;
  const fs::path target = fs::canonical(path, error);
  if (error) fail_with({Fault::input, fmt::format("cannot write '{}': {}", path, error.message()), {}});
  if (access(target.c_str(), W_OK) != 0) {
    fail_with({Fault::input, fmt::format("cannot write '{}': no permission", path), {}});
  }
  Outputs outputs;
  outputs.announce(target.string());
  outputs.write(target.string(), [&](const std::string& temporary) -> Result<void> {
    auto written = write_file(temporary, text);
    std::error_code ignored;  // the text matters more
    fs::permissions(temporary, fs::status(target, ignored).permissions(), ignored);
    return written;
  });
  outputs.commit();
}

bool format_file(const std::string& path, const FmtOptions& options, Context& context) {
  const auto formatted = format(path, read_bytes(path), context);
  if (!formatted) return false;
  if (formatted->before == formatted->after) return true;
  if (!options.check) replace(path, formatted->after);
  context.stopwatch.lap("write");
  if (!context.quiet) {
    print_result(fmt::format("{}: {}\n", path, options.check ? "not in canonical layout" : "formatted"));
  }
  return !options.check;
}

bool format_input(const FmtOptions& options, Context& context) {
  const std::string name = "<stdin>";
  const auto formatted = format(name, std::string(std::istreambuf_iterator<char>(std::cin), {}), context);
  if (!formatted) return false;
  if (!options.check) print_result(formatted->after);
  const bool same = formatted->before == formatted->after;
  if (options.check && !same && !context.quiet) print_result(name + ": not in canonical layout\n");
  return !options.check || same;
}

int run_fmt(const FmtOptions& options, Context& context) {
  if (std::ranges::count(options.paths, "-") > 1) fail_usage("the standard input is named twice");
  bool all_done = true;
  for (const std::string& path : options.paths) {
    all_done &= path == "-" ? format_input(options, context) : format_file(path, options, context);
  }
  return all_done ? exit_done : exit_input;
}

}  // namespace

void add_fmt(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<FmtOptions>();
  CLI::App& command = *app.add_subcommand("fmt", "Lay scenes out in the canonical way; what they mean stays the same");
  command.add_option("FILE", options->paths, "VOML files, changed in place; - reads stdin and writes stdout")
      ->required()
      ->type_name("");
  command.add_flag("--check", options->check,
                   "Change nothing; name the files that are laid out otherwise, and exit with 1");
  add_common_options(command, invocation.context);
  command.footer("Example:  dmvv fmt --check examples/*/*.voml");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return run_fmt(*options, context); };
  });
}

}  // namespace dmvv::cli
