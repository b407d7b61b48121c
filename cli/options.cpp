#include "cli/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "cli/driver_cache.h"

namespace dmvv::cli {
namespace {

template <class T>
using Word = std::pair<std::string_view, T>;

constexpr Word<compiler::Codegen> codegens[] = {{"auto", compiler::Codegen::automatic},
                                                {"specialised", compiler::Codegen::specialised},
                                                {"table", compiler::Codegen::table},
                                                {"thesis", compiler::Codegen::thesis}};
constexpr Word<compiler::TexelFormat> atlas_formats[] = {{"r32f", compiler::TexelFormat::r32f},
                                                         {"r16f", compiler::TexelFormat::r16f},
                                                         {"snorm16", compiler::TexelFormat::snorm16},
                                                         {"snorm8", compiler::TexelFormat::snorm8}};
constexpr Word<compiler::Filter> filters[] = {{"hardware", compiler::Filter::hardware},
                                              {"shader", compiler::Filter::shader},
                                              {"tricubic", compiler::Filter::tricubic}};

/// The value of a word; refuses a word that is not in the table.
template <class T, std::size_t n>
T choose(const Word<T> (&words)[n], const std::string& word, std::string_view option, std::string_view what) {
  std::string known;
  for (std::size_t i = 0; i < n; ++i) {
    if (words[i].first == word) return words[i].second;
    known += fmt::format("{}{}", i == 0 ? "" : i + 1 < n ? ", " : " or ", words[i].first);
  }
  fail_usage(fmt::format("{}: unknown {} '{}'", option, what, word), {"use " + known});
}

}  // namespace

void add_common_options(CLI::App& command, Context& context) {
  command.add_flag("--quiet", context.quiet, "Print errors and results only");
  command.add_flag("--timings", context.timings, "Print on stderr where the time went");
}

void add_root_and_strict(CLI::App& command, SceneOptions& options) {
  command.add_option("--root", options.root, "Root object instead of the scene's last one")->type_name("NAME");
  command.add_flag("--strict", options.strict, "Treat warnings as errors");
}

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("SCENE", options.path, "VOML file")->required()->type_name("");
  add_root_and_strict(command, options);
}

void add_device_name(CLI::App& command, DeviceChoice& choice, const char* use) {
  command.add_option("--device", choice.name, use)->type_name("NAME");
}

void add_drawing_device(CLI::App& command, DeviceChoice& choice) {
  add_device_name(command, choice, "Vulkan device whose name holds NAME (any case); default: the best one");
  command.add_flag("--validation", choice.validation,
                   "Switch the Khronos validation layer on; its messages make the exit code 2");
}

void add_device_options(CLI::App& command, DeviceChoice& choice) {
  add_drawing_device(command, choice);
  command.add_flag("--no-cache", choice.no_cache,
                   "Compile everything anew: use neither the cache of compiled code nor the driver's");
}

void add_codegen_options(CLI::App& command, CodegenChoice& choice) {
  command
      .add_option("--codegen", choice.codegen,
                  "Shader form: auto (default; by the costs of the device), specialised, table, or thesis (with the "
                  "errors of the "
                  "published program)")
      ->type_name("FORM");
  command.add_option("--atlas", choice.atlas, "Texels of the distance atlas: r32f (default), r16f, snorm16 or snorm8")
      ->type_name("FORMAT");
  command
      .add_option("--filter", choice.filter,
                  "Distances between samples: hardware (default; trilinear), shader (trilinear in float32), tricubic")
      ->type_name("FILTER");
  command
      .add_option("--disable", choice.disabled_passes, "Switch a pass of the compiler or of a frame off (repeatable)")
      ->type_name("PASS")
      ->allow_extra_args(false);
}

void add_time_option(CLI::App& command, double& time_ms) {
  command.add_option("--time", time_ms, "Time since the start of the animation, in milliseconds (0)")
      ->type_name("MS")
      ->check([](const std::string& text) {
        double value = 0;
        return CLI::detail::lexical_cast(text, value) && std::isfinite(value) ? "" : "not a finite number: " + text;
      });
}

compiler::CompileOptions compile_options(const CodegenChoice& choice) {
  compiler::CompileOptions options;
  options.codegen = choose(codegens, choice.codegen, "--codegen", "form");
  options.atlas_format = choose(atlas_formats, choice.atlas, "--atlas", "format");
  options.filter = choose(filters, choice.filter, "--filter", "filter");
  const compiler::CompileOptions plain;
  const bool own_storage = options.atlas_format != plain.atlas_format || options.filter != plain.filter;
  if (options.codegen == compiler::Codegen::thesis && (own_storage || !choice.disabled_passes.empty())) {
    fail_usage("--codegen thesis has its own atlas and filter, and no passes",
               {"leave --atlas, --filter and --disable away"});
  }

  std::vector<compiler::PassInfo> passes = compiler::pass_names();
  for (const auto& pass : runtime::frame_pass_names()) passes.push_back({pass.name, pass.what});
  for (const std::string& name : choice.disabled_passes) {
    if (std::ranges::any_of(passes, [&](const auto& pass) { return pass.name == name; })) continue;
    std::vector<std::string> reasons{"passes that can be switched off:"};
    for (const auto& pass : passes) reasons.push_back(fmt::format("  {:<16} {}", pass.name, pass.what));
    fail_usage(fmt::format("--disable: unknown pass '{}'", name), std::move(reasons));
  }
  options.disabled_passes = choice.disabled_passes;
  return options;
}

namespace {

session::Session timed_session(session::Options options, Context& context) {
  return session::Session(std::move(options), [&context](const char* step) { context.stopwatch.lap(step); });
}

}  // namespace

session::Session make_session(Context& context) {
  return timed_session({.device = "", .validation = false, .caches = false}, context);
}

session::Session make_session(const DeviceChoice& choice, Context& context) {
  if (choice.no_cache) empty_driver_cache();
  session::Session session =
      timed_session({.device = choice.name, .validation = choice.validation, .caches = !choice.no_cache}, context);
  session.open_device();
  return session;
}

session::SceneFile scene_file(const SceneOptions& options, const ReadFile& files) {
  return {options.path, options.root, files};
}

compiler::Module read_module(session::Session& session, const SceneOptions& options, Context& context,
                             Diagnostics& diagnostics) {
  voml::Scene scene = must(session.read(scene_file(options), diagnostics), diagnostics, context);
  return must(session.lower(std::move(scene), diagnostics), diagnostics, context);
}

session::Loaded load(session::Session& session, voml::Scene scene, const compiler::CompileOptions& form,
                     compiler::Source source, Context& context, Diagnostics& diagnostics, runtime::Timings* timings) {
  auto loaded = must(session.load(std::move(scene), form, source, diagnostics, timings), diagnostics, context);
  print_diagnostics(diagnostics, context);
  return loaded;
}

int exit_code_of(const std::vector<std::string>& messages) {
  if (messages.empty()) return exit_done;
  print_error({Fault::environment, "the validation layer has " + plural(messages.size(), "message"), messages});
  return exit_environment;
}

voml::Mesh read_mesh(const std::string& path, Context& context, Diagnostics& diagnostics, const ReadFile& files) {
  auto mesh = voml::parse_mesh(path, read_bytes(path, files), diagnostics);
  context.stopwatch.lap("read");
  if (!mesh || diagnostics.has_errors()) stop_with(diagnostics, context);  // with --strict, warnings are errors
  return std::move(*mesh);
}

std::string read_bytes(const std::string& path, const ReadFile& files) { return must(files(path, max_file_bytes)); }

}  // namespace dmvv::cli
