// Pictures by rays of whole scenes from files, beside the reference's rays: ray_agreement SCENE... [--every N]
//
// Whole, cut, from within and zoomed, where something moves at three times: how many rays the reference is certain of,
// how many of these the device doubts, and how many of the others it answers otherwise (spec/accuracy.md: none).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "base/files.h"
#include "compiler/compile.h"
#include "runtime/runtime.h"
#include "tests/support/rays.h"
#include "voml/scene.h"

using namespace dmvv;

namespace {

struct Options {
  std::vector<std::string> scenes;
  std::size_t every = 997;
  std::string codegen = "auto";
};

[[noreturn]] void stop(const std::string& why) {
  fmt::print(stderr, "ray_agreement: {}\n", why);
  std::exit(2);
}

compiler::Module read(const std::string& path) {
  Diagnostics diagnostics;
  auto scene = voml::read_scene(path, disk_files(), {}, diagnostics);
  auto module = scene ? compiler::lower(std::move(*scene), diagnostics) : std::nullopt;
  if (!module) stop(diagnostics.render());
  return std::move(*module);
}

struct NamedView {
  const char* name;
  runtime::View view;
};

std::vector<NamedView> views(const voml::Bounds& content) {
  runtime::View whole;
  whole.size_px = {1280, 720};
  whole.rays = whole.want_regions = whole.want_depth = whole.want_doubt = true;
  whole.camera = runtime::default_camera(content, whole.size_px, {});
  runtime::View cut = whole, within = whole, zoomed = whole;
  cut.cuts = {{{0.3, 0.2, 1.0}, 0.05}};
  within.camera.eye = {0.03, 0.11, 0.2};
  within.camera.look = {-0.5, -0.2, -1.0};
  within.camera.fov_deg = 70.0;
  within.cuts = {{{0.0, 0.0, 1.0}, 0.0}};
  zoomed.camera.fov_deg = 0.5;
  return {{"whole", whole}, {"cut", cut}, {"within", within}, {"zoomed", zoomed}};
}

/// Returns how many rays are wrong.
std::size_t compare(const std::string& path, runtime::Device& device, const Options& options) {
  const compiler::Module module = read(path);
  Diagnostics diagnostics;
  compiler::CompileOptions compile_options;
  compile_options.rays = true;
  if (options.codegen == "table") compile_options.codegen = compiler::Codegen::table;
  auto program = compiler::compile(module, compile_options, diagnostics);
  if (!program) stop(diagnostics.render());
  if (const auto made = compiler::to_spirv(*program, compiler::Source::rays); !made) stop(made.error().message);
  auto evaluator = runtime::Evaluator::create(device, *program);
  if (!evaluator) stop(evaluator.error().message);
  const compiler::RayReference reference(module);
  std::size_t wrong = 0;
  for (NamedView& named : views(program->content)) {
    for (const double time_ms : program->time_slots.empty() ? std::vector{0.0} : std::vector{0.0, 700.0, 2345.6}) {
      named.view.time_ms = time_ms;
      const auto picture = evaluator->render(named.view);
      if (!picture) stop(picture.error().message);
      const auto found = tests::compare_rays(reference, *program, named.view, *picture, options.every);
      fmt::print(
          "  {:<7} t = {:>6} ms: {} rays, {} uncertain, {} in doubt ({:.3f} % of all pixels), {} wrong; off by {:.1e} "
          "at most\n",
          named.name, time_ms, found.rays, found.uncertain, found.doubtful,
          100.0 * double(picture->doubtful_rays) / double(picture->depth.size()), found.wrong, found.largest_error);
      if (found.wrong != 0) fmt::print("    {}\n", found.first);
      std::fflush(stdout);
      wrong += found.wrong;
    }
  }
  return wrong;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Compares pictures by rays with the reference, on whole scenes.");
  app.add_option("SCENE", options.scenes, "VOML files")->required();
  app.add_option("--every", options.every, "Each pixel of so many is compared")->capture_default_str();
  app.add_option("--codegen", options.codegen, "auto or table")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  auto device = runtime::Device::create({.name = "", .validation = true});
  if (!device) stop(device.error().message);
  std::size_t wrong = 0;
  for (const std::string& path : options.scenes) {
    fmt::print("{}\n", std::filesystem::path(path).filename().string());
    wrong += compare(path, *device, options);
  }
  for (const std::string& message : device->validation_messages()) fmt::print("{}\n", message);
  fmt::print("{} wrong, {} messages of the validation layer\n", wrong, device->validation_messages().size());
  return wrong == 0 && device->validation_messages().empty() ? 0 : 1;
}
