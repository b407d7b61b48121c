// Options that several subcommands share, and the stages they steer: from a file's name to a Module, Program or Device.
#pragma once

#include <CLI/App.hpp>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "base/files.h"
#include "cli/context.h"
#include "compiler/compile.h"
#include "compiler/ir/module.h"
#include "runtime/runtime.h"
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
/// --device, --validation, --no-cache.
void add_device_options(CLI::App& command, DeviceChoice& choice);
/// --codegen, --atlas, --filter, --disable.
void add_codegen_options(CLI::App& command, CodegenChoice& choice);
/// --time, a finite number of milliseconds.
void add_time_option(CLI::App& command, double& time_ms);

/// Refuses unknown forms and passes as wrong usage, listing the known ones.
compiler::CompileOptions compile_options(const CodegenChoice& choice);

/// SCENE -> Scene -> Module; mistakes are printed and stop the command. Warnings wait in `diagnostics`.
voml::Scene read_scene(const SceneOptions& options, Context& context, Diagnostics& diagnostics,
                       const ReadFile& files = disk_files());
compiler::Module lower(voml::Scene scene, Context& context, Diagnostics& diagnostics,
                       const compiler::CodeCache& cache = {});

/// Module -> Program with the SPIR-V of the kernel, for a device if there is one. Prints what `diagnostics` holds.
compiler::Program compile(compiler::Module module, compiler::CompileOptions options,
                          std::optional<compiler::Kernel> kernel, const runtime::Device* device, Context& context,
                          Diagnostics& diagnostics, const compiler::CodeCache& cache = {});

/// A device that a thread of its own opens, and the user's cache of compiled code: none with --no-cache, or without a
/// cache folder.
struct OpeningDevice {
  std::shared_future<Result<runtime::Device>> device;
  compiler::CodeCache code;
};
OpeningDevice begin_device(const DeviceChoice& choice);
/// Waits for the device, once; the lap "device" is what there was to wait for.
runtime::Device await_device(const OpeningDevice& opening, Context& context);

/// Waits for what the pictures are drawn on; the lap "surface" is what there was to wait for.
runtime::PreparedSurface await_surface(std::future<Result<runtime::PreparedSurface>>& preparing, Context& context);

/// The exit code of a command that used a device: messages of the validation layer go to stderr and make it 2.
int exit_code_of(const std::vector<std::string>& validation_messages);

/// Reads a mesh; mistakes are printed and stop the command.
voml::Mesh read_mesh(const std::string& path, Context& context, Diagnostics& diagnostics,
                     const ReadFile& files = disk_files());

/// A whole file, of at most 4 GiB.
std::string read_bytes(const std::string& path, const ReadFile& files = disk_files());

}  // namespace dmvv::cli
