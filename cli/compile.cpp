// dmvv compile SCENE -o DIR: what the compiler makes of a scene, as files.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <set>

#include "cli/commands.h"
#include "cli/dump.h"
#include "cli/options.h"
#include "cli/outputs.h"
#include "compiler/layout/flatten.h"
#include "compiler/program_file.h"

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 7> dump_words{"module", "glsl", "spirv", "records", "atlas", "stats", "program"};

struct CompileOptions {
  SceneOptions scene;
  DeviceChoice device;
  CodegenChoice codegen;
  std::string folder;
  std::vector<std::string> dump;
  bool many_frames = false;
};

std::set<std::string> parse_dump(const std::vector<std::string>& words) {
  std::set<std::string> result;
  for (const std::string& word : words) {
    if (std::ranges::find(dump_words, word) == dump_words.end()) {
      fail_usage(fmt::format("--dump: unknown word '{}'", word),
                 {fmt::format("use some of {}, with commas between", fmt::join(dump_words, ", "))});
    }
    result.insert(word);
  }
  if (result.empty()) result.insert(dump_words.begin(), dump_words.end());
  return result;
}

/// A folder that is made when the first file is due, and goes again if the command fails.
class Folder {
 public:
  /// Refuses a path whose parent does not exist, or that is a file.
  explicit Folder(std::string path) : path_(std::move(path)) {
    const fs::path folder = fs::path(path_ + "/").parent_path();
    const fs::path parent = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
    std::error_code ignored;
    if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored)) {
      fail_with({Fault::input, fmt::format("cannot write into '{}': it is not a folder", path_), {}});
    }
    if (!fs::exists(folder, ignored) && !fs::is_directory(parent, ignored)) {
      fail_with({Fault::input,
                 fmt::format("cannot make '{}': the folder '{}' does not exist", path_, parent.string()),
                 {fmt::format("make it first: mkdir -p '{}'", parent.string())}});
    }
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    if (made_) fs::remove(path_, ignored);  // does nothing once files stand in it
  }

  void make() {
    std::error_code error;
    made_ = fs::create_directory(path_, error);
    if (error) fail_with({Fault::input, fmt::format("cannot make '{}': {}", path_, error.message()), {}});
  }
  std::string file(std::string_view name) const { return (fs::path(path_) / name).string(); }

 private:
  std::string path_;
  bool made_ = false;
};

std::string_view bytes_of(const auto& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0])};
}

/// Adds files one by one to a set that is written as a whole.
class Dump {
 public:
  explicit Dump(const Folder& folder) : folder_(folder) {}

  void add(const std::string& name, std::string_view bytes) {
    outputs_.announce(folder_.file(name));
    outputs_.write_bytes(folder_.file(name), bytes);
    names_.push_back(name);
  }
  void add_texture(const compiler::Texture& texture) {
    const std::string path = folder_.file(texture.name + ".exr");
    outputs_.announce(path);
    outputs_.write(path, [&](const std::string& temporary) { return write_texture(temporary, texture); });
    names_.push_back(texture.name + ".exr");
  }
  void commit() { outputs_.commit(); }
  std::size_t count() const { return names_.size(); }

 private:
  const Folder& folder_;
  Outputs outputs_;
  std::vector<std::string> names_;
};

/// "pixels", or "pixels.stage_2".
std::string name_of_shader(const compiler::Kernel& kernel, std::size_t stage) {
  return kernel.is_staged() ? fmt::format("{}.stage_{}", kernel.spec.name, stage) : std::string(kernel.spec.name);
}

void dump_program(Dump& dump, const std::set<std::string>& words, const compiler::Program& program) {
  for (const compiler::Kernel& kernel : program.kernels) {
    for (std::size_t stage = 0; stage < kernel.shaders.size(); ++stage) {
      const compiler::Shader& shader = kernel.shaders[stage];
      const std::string name = name_of_shader(kernel, stage);
      if (words.contains("glsl")) dump.add(name + ".comp", shader.glsl);
      if (!words.contains("spirv")) continue;
      dump.add(name + ".spv", bytes_of(shader.spirv));
      dump.add(name + ".spvasm", must(disassemble(shader.spirv)));
    }
  }
  if (words.contains("records")) {
    dump.add("records.txt", compiler::records_text(program));
    for (const compiler::Buffer& buffer : program.buffers) dump.add(buffer.name + ".bin", bytes_of(buffer.bytes));
  }
  if (words.contains("atlas")) {
    dump.add("atlas.txt", textures_text(program));
    for (const compiler::Texture& texture : program.textures) dump.add_texture(texture);
  }
  if (words.contains("stats")) dump.add("stats.txt", statistics_text(program));
  if (words.contains("program")) dump.add("program.dmvv", compiler::write_program(program));
}

int run_compile(const CompileOptions& options, Context& context) {
  const std::set<std::string> words = parse_dump(options.dump);
  compiler::CompileOptions form = compile_options(options.codegen);
  form.many_frames = options.many_frames;
  Folder folder(options.folder);

  Diagnostics diagnostics(options.scene.strict);
  session::Session session =
      options.device.name.empty() ? make_session(context) : make_session(options.device, context);
  compiler::Module module = read_module(session, options.scene, context, diagnostics);
  const std::string module_text = words.contains("module") ? compiler::to_text(module) : "";
  // A device named here lends its limits; without one, those that every Vulkan 1.2 GPU keeps hold.
  if (!options.device.name.empty()) must(session.device());
  compiler::Program program = must(session.build(std::move(module), form, diagnostics), diagnostics, context).program;
  print_diagnostics(diagnostics, context);
  if (words.contains("spirv") || words.contains("program")) {
    for (const auto source : {compiler::Source::points, compiler::Source::surface})
      must(compiler::to_spirv(program, source));
    context.stopwatch.lap("SPIR-V");
  }

  folder.make();
  Dump dump(folder);
  if (words.contains("module")) dump.add("module.txt", module_text);
  dump_program(dump, words, program);
  dump.commit();
  context.stopwatch.lap("write");
  if (!context.quiet) {
    const compiler::Statistics& s = program.statistics;
    print_result(fmt::format("{}: {} files; {} lines of GLSL, {} bytes of buffers, {} bytes of textures\n",
                             options.folder, dump.count(), s.code.glsl_lines, s.bytes.buffers, s.bytes.textures));
  }
  return exit_done;
}

}  // namespace

void add_compile(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<CompileOptions>();
  CLI::App& command = *app.add_subcommand("compile", "Write the shaders, records and textures made for a scene");
  add_scene_options(command, options->scene);
  command.add_option("-o,--output", options->folder, "Folder for the files; made if it is not there")
      ->required()
      ->type_name("DIR");
  command.add_option("--dump", options->dump, fmt::format("Which ones: {}; default all", fmt::join(dump_words, ",")))
      ->type_name("WORDS")
      ->delimiter(',')
      ->allow_extra_args(false);
  command.add_flag("--many-frames", options->many_frames,
                   "With the kernels that pay for many frames, as animate compiles a scene");
  add_codegen_options(command, options->codegen);
  add_device_name(command, options->device, "Compile for the limits of the Vulkan device whose name holds NAME");
  add_common_options(command, invocation.context);
  command.footer("Example:  dmvv compile orange.voml -o dump --dump glsl,stats --codegen table");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return run_compile(*options, context); };
  });
}

}  // namespace dmvv::cli
