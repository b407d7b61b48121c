// Whole scenes from files, on the device and by the reference: scene_agreement SCENE... [--points N] [--seed N]
//
// For every form of generated code and, where something moves, five moments up to an hour: how many points the
// reference is certain of, and how many of these the device answers otherwise (spec/accuracy.md promises: none).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "base/files.h"
#include "compiler/ir/legend.h"
#include "runtime/runtime.h"
#include "tests/random/points.h"
#include "tests/support/agreement.h"

using namespace dmvv;

namespace {

struct Options {
  std::vector<std::string> scenes;
  std::size_t points = 100000;
  std::uint64_t seed = 1;
};

[[noreturn]] void stop(const std::string& why) {
  fmt::print(stderr, "scene_agreement: {}\n", why);
  std::exit(2);
}

compiler::Module read(const std::string& path) {
  Diagnostics diagnostics;
  auto scene = voml::read_scene(path, disk_files(), {}, diagnostics);
  auto module = scene ? compiler::lower(std::move(*scene), diagnostics) : std::nullopt;
  if (!module) stop(diagnostics.render());
  return std::move(*module);
}

struct Form {
  std::string name;
  compiler::Program program;
  runtime::Evaluator evaluator;
};

std::vector<Form> forms_of(const compiler::Module& module, runtime::Device& device) {
  std::vector<Form> forms;
  for (const tests::Setting& setting : tests::agreeing_settings()) {
    Diagnostics diagnostics;
    auto program = compiler::compile(module, setting.options, diagnostics);
    if (!program) stop(diagnostics.render());
    if (const auto compiled = compiler::to_spirv(*program, compiler::Source::points); !compiled) {
      stop(compiled.error().message);
    }
    auto evaluator = runtime::Evaluator::create(device, *program);
    if (!evaluator) stop(evaluator.error().message);
    forms.push_back({setting.name, std::move(*program), std::move(*evaluator)});
  }
  return forms;
}

/// Compares one moment; returns how many answers are wrong.
std::size_t compare_at(const compiler::Module& module, std::vector<Form>& forms, double time_ms,
                       const Options& options) {
  const compiler::Reference reference(module);
  const auto legend = compiler::legend(module);
  const auto points = tests::random_scenes::draw_points(module, reference, time_ms, options.seed, options.points).all;
  std::vector<compiler::ReferenceAnswer> expected;
  std::size_t certain = 0;
  for (const glm::dvec3& p : points) {
    expected.push_back(reference.evaluate(p, time_ms));
    certain += expected.back().certain ? 1 : 0;
  }
  std::size_t all_wrong = 0;
  for (Form& form : forms) {
    const auto answers = form.evaluator.probe(points, time_ms);
    if (!answers && answers.error().fault == Fault::input) {  // the device's rounds do not suffice, and it says so
      fmt::print("  {:<12} t = {:>9} ms: no answer: {}\n", form.name, time_ms, answers.error().message);
      continue;
    }
    if (!answers) stop(answers.error().message);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!expected[i].certain) continue;
      const auto fault = tests::compare(legend, expected[i], form.program.regions, (*answers)[i]);
      if (fault && wrong++ == 0) {
        fmt::print("  first at {} {} {}: expected {}, got {}\n", points[i].x, points[i].y, points[i].z, fault->expected,
                   fault->got);
      }
    }
    fmt::print("  {:<12} t = {:>9} ms: {} points, {} certain, {} wrong\n", form.name, time_ms, points.size(), certain,
               wrong);
    std::fflush(stdout);
    all_wrong += wrong;
  }
  return all_wrong;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Compares every form of generated code with the reference, on whole scenes.");
  app.add_option("SCENE", options.scenes, "VOML files")->required();
  app.add_option("--points", options.points, "Points a scene and moment")->capture_default_str();
  app.add_option("--seed", options.seed, "Seed of the points")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  auto device = runtime::Device::create({.name = "", .validation = true});
  if (!device) stop(device.error().message);
  std::size_t wrong = 0;
  for (const std::string& path : options.scenes) {
    fmt::print("{}\n", std::filesystem::path(path).filename().string());
    const compiler::Module module = read(path);
    auto forms = forms_of(module, *device);
    for (const double time_ms : tests::times_of(forms.front().program)) {
      wrong += compare_at(module, forms, time_ms, options);
    }
  }
  for (const std::string& message : device->validation_messages()) fmt::print("{}\n", message);
  fmt::print("{} wrong, {} messages of the validation layer\n", wrong, device->validation_messages().size());
  return wrong == 0 && device->validation_messages().empty() ? 0 : 1;
}
