// Options that several subcommands share, and the stages they steer: from a file's name to a Module, Program or Device.
#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/files.h"
#include "cli/context.h"
#include "compiler/compile.h"
#include "compiler/ir/module.h"
#include "runtime/runtime.h"
#include "session/session.h"
#include "voml/assets/mesh.h"
#include "voml/scene.h"

namespace dmvv::cli {

struct SceneOptions {
  std::string path;
  std::string root;
  bool strict = false;
};

struct DeviceChoice {
  std::string name;
  bool validation = false;
  bool no_cache = false;
};

struct CodegenChoice {
  std::string codegen = "auto";
  std::string atlas = "r32f";
  std::string filter = "hardware";
  std::vector<std::string> disabled_passes;
};

/// --quiet and --timings, which every subcommand has.
void add_common_options(CLI::App& command, Context& context);
/// SCENE, --root, --strict.
void add_scene_options(CLI::App& command, SceneOptions& options);
void add_root_and_strict(CLI::App& command, SceneOptions& options);
/// --device; `use` says what for.
void add_device_name(CLI::App& command, DeviceChoice& choice, const char* use);
/// --device and --validation, to draw on.
void add_drawing_device(CLI::App& command, DeviceChoice& choice);
/// Those, and --no-cache.
void add_device_options(CLI::App& command, DeviceChoice& choice);
/// --codegen, --atlas, --filter, --disable.
void add_codegen_options(CLI::App& command, CodegenChoice& choice);
/// --time, a finite number of milliseconds.
void add_time_option(CLI::App& command, double& time_ms);

/// Refuses unknown forms and passes as wrong usage, listing the known ones.
compiler::CompileOptions compile_options(const CodegenChoice& choice);

/// The session of a command that was given these options, which tells the command's stopwatch of its steps.
session::Session make_session(Context& context);
session::Session make_session(const DeviceChoice& choice, Context& context);
session::SceneFile scene_file(const SceneOptions& options, const ReadFile& files = disk_files());

/// The value, or the end of the command: mistakes of authors are printed from `diagnostics`.
template <class T>
T must(Result<T> result, const Diagnostics& diagnostics, const Context& context) {
  if (!result && diagnostics.has_errors()) stop_with(diagnostics, context);
  return must(std::move(result));
}

/// SCENE -> Module; mistakes are printed and stop the command. Warnings wait in `diagnostics`.
compiler::Module read_module(session::Session& session, const SceneOptions& options, Context& context,
                             Diagnostics& diagnostics);
/// A scene on the session's device, ready for points of `source`. Prints the warnings that `diagnostics` holds.
session::Loaded load(session::Session& session, voml::Scene scene, const compiler::CompileOptions& form,
                     compiler::Source source, Context& context, Diagnostics& diagnostics,
                     runtime::Timings* timings = nullptr);

/// The exit code of a command that used a device: messages of the validation layer go to stderr and make it 2.
int exit_code_of(const std::vector<std::string>& validation_messages);

/// Reads a mesh; mistakes are printed and stop the command.
voml::Mesh read_mesh(const std::string& path, Context& context, Diagnostics& diagnostics,
                     const ReadFile& files = disk_files());

/// A whole file, of at most 4 GiB.
std::string read_bytes(const std::string& path, const ReadFile& files = disk_files());

}  // namespace dmvv::cli
