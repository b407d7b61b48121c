// dmvv bench [SCENE...] --json FILE --plots DIR: run time and error of many settings, side by side.
#include "bench/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "base/limits.h"
#include "bench/gnuplot.h"
#include "bench/stress.h"
#include "cli/commands.h"
#include "cli/driver_cache.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "cli/view_options.h"

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;

constexpr double quick_budget_s = 32.0;  // one case that has begun may still take some seconds
constexpr double budget_s = 540.0;

struct BenchOptions {
  std::vector<std::string> scenes;
  std::string set = "standard";
  bool quick = false;
  std::string json;
  std::string plots;
  std::string plot_format = "svg";
  std::string examples;
  bool driver_cache = false;
  ViewOptions view;
  double time_ms = 0.0;
  DeviceChoice device;
};

/// build/bin/dmvv -> build/examples
std::string default_examples() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? "examples" : (program.parent_path().parent_path() / "examples").string();
}

/// The user's scenes with the view options; a known example is looked at as its own page does.
std::vector<bench::SceneSource> sources(const BenchOptions& options) {
  const runtime::View view = parse_view(options.view);
  std::vector<bench::SceneSource> scenes;
  for (const std::string& path : options.scenes) {
    bench::SceneSource source;
    source.name = fs::path(path).stem().string();
    const auto same = std::ranges::count(scenes, source.name, &bench::SceneSource::name);
    if (same != 0) source.name = path;
    source.path = path;
    source.files = disk_files();
    source.mesh_path = options.view.mesh;
    source.cuts = view.cuts;
    if (!options.view.camera.empty()) source.camera = view.camera;
    source.time_ms = options.time_ms;
    scenes.push_back(std::move(source));
  }
  return scenes;
}

bench::PlanOptions plan_options(const BenchOptions& options) {
  const auto& sets = bench::set_names();
  if (std::ranges::find(sets, options.set, &bench::SetName::name) == sets.end()) {
    std::vector<std::string> reasons;
    for (const auto& set : sets) reasons.push_back(fmt::format("{:<12} {}", set.name, set.what));
    fail_usage(fmt::format("--set: unknown set '{}'", options.set), std::move(reasons));
  }
  bench::PlanOptions plan;
  plan.set = options.set;
  plan.quick = options.quick;
  plan.examples = options.examples.empty() ? default_examples() : options.examples;
  plan.scenes = sources(options);
  plan.size_px = parse_view(options.view).size_px;
  return plan;
}

/// Makes the folder of the plots; its parent must be there.
void make_folder(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return;
  fs::create_directory(path, error);
  if (error) fail_with({Fault::input, fmt::format("cannot make the folder '{}': {}", path, error.message()), {}});
}

void write_json(const BenchOptions& options, const bench::Report& report) {
  if (options.json.empty()) return;
  Outputs outputs;
  outputs.announce(options.json, {".json"});
  outputs.write_bytes(options.json, bench::to_json(report));
  outputs.commit();
}

void write_plots(const BenchOptions& options, const std::string& gnuplot, const bench::Report& report) {
  if (options.plots.empty()) return;
  Outputs outputs;
  for (const bench::Plot& plot : bench::make_plots(report)) {
    const std::string path = (fs::path(options.plots) / (plot.name + '.' + options.plot_format)).string();
    outputs.announce(path);
    outputs.write(path, [&](const std::string& temporary) { return bench::draw(gnuplot, plot, temporary); });
  }
  outputs.commit();
}

/// A report that grows, and is on disk as it stands after every case: a run that is stopped leaves a JSON of what was
/// measured, in which the cases that were not begun say so.
class GrowingReport {
 public:
  GrowingReport(const BenchOptions& options, std::vector<bench::Case> cases)
      : options_(options), cases_(std::move(cases)) {}

  bench::Report& report() { return report_; }
  /// The number of the last case that was begun.
  void begin(std::size_t number) { begun_ = number; }

  void write() {
    bench::Report now = report_;
    now.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    for (std::size_t i = begun_; i < cases_.size(); ++i) {
      bench::Measurement left;
      left.what = cases_[i];
      left.failure = "not measured: the run ended before";
      now.measurements.push_back(std::move(left));
    }
    now.fits = bench::fit_series(report_.measurements);
    write_json(options_, now);
  }

 private:
  const BenchOptions& options_;
  std::vector<bench::Case> cases_;
  bench::Report report_;
  std::size_t begun_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Where a run stands: a bar on a terminal, else a line a step.
class BenchProgress {
 public:
  BenchProgress(std::size_t total, bool quiet) : bar_("bench", total, 0, quiet), total_(total), quiet_(quiet) {}

  /// Step `number`, from 1, begins.
  void begin(std::size_t number, const std::string& what) {
    bar_.advance_to(number - 1);
    if (quiet_ || isatty(STDERR_FILENO) != 0) return;
    std::fputs(fmt::format("bench: {}/{} {}\n", number, total_, what).c_str(), stderr);
  }

 private:
  ProgressBar bar_;
  std::size_t total_;
  bool quiet_;
};

bench::StressFigure figure_of(const stress::Case& c) {
  return {c.name, c.what, c.measured, c.bound, c.at_least, c.unit, c.detail, c.held};
}

bench::StartOptions start_options(const BenchOptions& options) {
  bench::StartOptions starts{.program = fs::read_symlink("/proc/self/exe").string()};
  if (options.quick) starts.cold = 1, starts.warm = 3;
  return starts;
}

int bench_command(const BenchOptions& options, Context& context) {
  // What can be refused is refused before the work.
  const bench::PlanOptions plan_of = plan_options(options);
  if (options.plot_format != "svg" && options.plot_format != "png") {
    fail_usage(fmt::format("--plot-format: unknown format '{}'", options.plot_format), {"use svg or png"});
  }
  if (!options.json.empty()) Outputs().announce(options.json, {".json"});
  std::string gnuplot;
  if (!options.plots.empty()) {
    gnuplot = must(bench::find_gnuplot());
    make_folder(options.plots);
  }
  for (const bench::SceneSource& scene : plan_of.scenes) must(disk_files()(scene.path, max_file_bytes));
  const bench::Plan plan = bench::make_plan(plan_of);

  // The driver's cache begins empty: a pipeline that an earlier run compiled would cost nothing.
  const auto forget_pipelines = [&] {
    if (!options.driver_cache) empty_driver_cache();
  };
  forget_pipelines();
  const session::Options opening{
      .device = options.device.name, .validation = options.device.validation, .caches = false};
  runtime::Device device = must(session::Session(opening).device());
  context.stopwatch.lap("device");
  GrowingReport growing(options, plan.cases);
  bench::Report& report = growing.report();
  report.set = options.scenes.empty() ? options.set : "scenes";
  report.quick = options.quick;
  report.machine = bench::this_machine(device.info());
  report.missing = plan.missing;
  const bool stresses = options.scenes.empty() && options.set == "stress";
  growing.write();
  {
    std::size_t step = 0;
    BenchProgress progress(plan.cases.size() + plan.starts.size() + (stresses ? 1 : 0), context.quiet);
    bench::RunOptions run;
    run.budget_s = options.quick                                         ? quick_budget_s
                   : options.scenes.empty() && options.set == "standard" ? budget_s
                                                                         : 0.0;
    run.progress = [&](const bench::Case& next) {
      forget_pipelines();
      progress.begin(++step, next.id);
      growing.begin(step);
    };
    run.done = [&](const std::vector<bench::Measurement>& so_far) {
      report.measurements = so_far;
      growing.write();
    };
    report.measurements = bench::run_cases(opening, plan.cases, run);
    for (const bench::SceneSource& scene : plan.starts) {
      progress.begin(++step, "start of " + scene.name);
      report.starts.push_back(bench::measure_starts(scene, start_options(options)));
      growing.write();
    }
    if (stresses) {
      progress.begin(++step, "stress cases");
      must(stress::run(device, {.long_form = !options.quick}, [&](const stress::Case& c) {
        report.stress.push_back(figure_of(c));
        growing.write();
      }));
    }
  }
  context.stopwatch.lap("bench");

  std::vector<std::string> messages = device.validation_messages();
  for (const bench::Measurement& m : report.measurements)
    messages.insert(messages.end(), m.validation_messages.begin(), m.validation_messages.end());
  if (const int exit_code = exit_code_of(messages); exit_code != exit_done) {
    if (std::error_code error; !options.json.empty()) fs::remove(options.json, error);  // its figures are worth nothing
    return exit_code;
  }
  growing.write();
  report.fits = bench::fit_series(report.measurements);
  write_plots(options, gnuplot, report);
  print_result(bench::to_table(report));
  return exit_done;
}

}  // namespace

void add_bench(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<BenchOptions>();
  options->view.size = "640x360";
  CLI::App& command = *app.add_subcommand("bench", "Measure run time and error of every setting, side by side");
  command.add_option("SCENE", options->scenes, "VOML files, measured with every setting; none: a set")->type_name("");
  command.add_option("--set", options->set, "standard (default), thesis, stress, speed or growth")->type_name("NAME");
  command.add_flag("--quick", options->quick, "Fewer cases, less certain figures: ends within 50 s");
  command.add_option("--json", options->json, "Write every figure and sample: .json")->type_name("FILE");
  command.add_option("--plots", options->plots, "Draw plots into a folder (needs gnuplot)")->type_name("DIR");
  command.add_option("--plot-format", options->plot_format, "svg (default) or png")->type_name("FORMAT");
  command
      .add_option("--examples", options->examples,
                  "Folder of the built examples; default: build/examples of this program")
      ->type_name("DIR");
  add_seen_options(command, options->view);
  add_time_option(command, options->time_ms);
  add_drawing_device(command, options->device);
  command.add_flag("--driver-cache", options->driver_cache, "Let the driver's shader cache speed pipelines up");
  add_common_options(command, invocation.context);
  command.footer(
      "Examples:  dmvv bench --json bench.json --plots plots\n"
      "           dmvv bench --quick --set thesis\n"
      "           dmvv bench scene.voml --mesh body.ply --cut \"0 0 1 0\" --json scene.json\n"
      "--size, --camera, --mesh, --cut and --time are those of the scenes given; frames are 640x360 if not said.\n"
      "How to read what it prints: bench/README.md.");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return bench_command(*options, context); };
  });
}

}  // namespace dmvv::cli
