// Random scenes on every evaluator: random_scenes [--scenes N] [--points N] [--seed N] [--print SEED]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "cli/progress.h"
#include "tests/random/report.h"

using namespace dmvv;
using namespace dmvv::tests::random_scenes;

namespace {

void print_scene(std::uint64_t seed, const std::vector<NamedSnippet>& snippets) {
  for (const auto& [path, bytes] : print(generate(seed, snippets))) {
    fmt::print("---- {} ({} bytes)\n", path, bytes.size());
    if (!path.ends_with(".lxn") && !path.ends_with(".png")) fmt::print("{}", bytes);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t seed = 1, shown = 0;
  std::size_t scenes = 2000, most_faults = 3;
  CheckOptions options;
  CLI::App app("Draws scenes from seeds and compares every form of generated code with the reference.");
  app.add_option("--scenes", scenes, "How many scenes")->capture_default_str();
  app.add_option("--points", options.points, "Points a scene and moment")->capture_default_str();
  app.add_option("--seed", seed, "Seed of the first scene; the others follow")->capture_default_str();
  app.add_option("--faults", most_faults, "Stop after so many scenes with a fault")->capture_default_str();
  const auto* show = app.add_option("--print", shown, "Print the scene of this seed and stop");
  CLI11_PARSE(app, argc, argv);
  const auto snippets = read_snippets(DMVV_SOURCE_DIR "/tests/snippets");
  if (*show) return print_scene(shown, snippets), 0;

  auto device = runtime::Device::create({.name = "", .validation = true});
  if (!device) return fmt::print(stderr, "{}\n", device.error().message), 2;
  Counts counts;
  std::size_t faults = 0;
  {
    cli::ProgressBar bar("scenes", scenes, 0, false);
    for (std::uint64_t i = seed; i < seed + scenes && faults < most_faults; ++i, bar.advance()) {
      const Scene scene = generate(i, snippets);
      const auto fault = check(*device, scene, i, options, counts);
      if (!fault) continue;
      ++faults;
      fmt::print("\nseed {}, made smaller:\n{}", i, describe(shrink_fault(*device, scene, i, *fault, options)));
      std::fflush(stdout);
    }
  }
  fmt::print("{} scenes, {} programs, {} answers compared; uncertain: {} of {} points anywhere, {} of {} chosen ones\n",
             counts.scenes, counts.programs, counts.answers, counts.uniform_uncertain, counts.uniform,
             counts.other_uncertain, counts.other);
  fmt::print("{} scenes with a fault\n", faults);
  return faults == 0 ? 0 : 1;
}
