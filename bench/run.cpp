#include "bench/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "bench/memory.h"
#include "bench/statistics.h"
#include "bench/truth.h"
#include "bench/workload.h"

namespace dmvv::bench {
namespace {

using Clock = std::chrono::steady_clock;
using compiler::Source;

constexpr std::uint32_t largest_batch = 1u << 18;  // one dispatch of Evaluator::probe
constexpr std::uint32_t cautious_batch = 1u << 14;
constexpr double long_ms = 300.0;  // for a batch
const runtime::Plane inner_plane{{0.0, 0.0, 1.0}, 0.05};
constexpr std::uint32_t small_batch = 64;

double since_ms(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void add(std::vector<Step>& steps, const std::string& name, double ms) {
  const auto known = std::ranges::find(steps, name, &Step::name);
  if (known != steps.end()) {
    known->ms.push_back(ms);
  } else {
    steps.push_back({name, {ms}});
  }
}

double ms_of(const runtime::Timings& timings, std::string_view step) {
  double ms = 0.0;
  for (const runtime::Timing& timing : timings) ms += timing.step == step ? timing.ms : 0.0;
  return ms;
}

compiler::CompileOptions compile_options(const Settings& settings) {
  compiler::CompileOptions options;
  options.codegen = settings.codegen;
  options.atlas_format = settings.atlas;
  options.filter = settings.filter;
  options.disabled_passes = settings.disabled_passes;
  options.many_frames = settings.verdicts;
  return options;
}

/// The steps of one build, as a session tells of them: what comes twice is added up.
class BuildSteps {
 public:
  void begin() {
    ms_.clear();
    last_ = Clock::now();
  }
  void lap(const char* step) {
    ms_[step] += since_ms(last_);
    last_ = Clock::now();
  }
  void end(std::vector<Step>& steps) const {
    for (const char* step : {"read", "compile", "SPIR-V"}) {
      if (const auto found = ms_.find(step); found != ms_.end()) add(steps, step, found->second);
    }
  }

 private:
  std::map<std::string, double> ms_;
  Clock::time_point last_ = Clock::now();
};

/// A case on a device of its own.
struct Bench {
  BuildSteps steps;
  session::Session session;

  explicit Bench(const session::Options& options) : session(options, [this](const char* step) { steps.lap(step); }) {}
  Bench(const Bench&) = delete;
};

/// From text to an evaluator, as `dmvv render` goes; with a view to the first picture.
Result<session::Loaded> build(Bench& bench, const SceneSource& source, const Settings& settings, Source points_of,
                              const runtime::View* view, bool is_first, std::vector<Step>& steps) {
  Diagnostics diagnostics;
  runtime::Timings timings;
  bench.steps.begin();
  auto scene = bench.session.read({source.path, source.root, source.files}, diagnostics);
  if (!scene) return tl::unexpected(input_error(source.path, diagnostics));
  auto loaded = bench.session.load(std::move(*scene), compile_options(settings), points_of, diagnostics, &timings);
  if (!loaded && diagnostics.has_errors()) return tl::unexpected(input_error(source.path, diagnostics));
  if (!loaded) return loaded;
  bench.steps.end(steps);
  add(steps, "upload", ms_of(timings, "upload"));
  if (view != nullptr) {
    const auto picture = loaded->evaluator.render(*view, &timings);
    if (!picture) return tl::unexpected(picture.error());
    if (is_first) add(steps, "pipeline", ms_of(timings, "pipeline"));  // the driver knows it from then on
  }
  return loaded;
}

/// The view of a frame: the camera swings to and fro, or time goes on.
runtime::View view_of_frame(runtime::View view, Motion motion, std::size_t frame) {
  constexpr double step_ms = 40.0, swing_deg = 3.0;
  constexpr std::size_t frames_a_swing = 23;
  if (motion == Motion::time) view.time_ms += step_ms * static_cast<double>(frame);
  if (motion == Motion::camera) {
    const double turn = static_cast<double>(frame % frames_a_swing) / frames_a_swing * 2.0 * std::numbers::pi;
    const double angle = std::sin(turn) * swing_deg * std::numbers::pi / 180.0;
    const glm::dvec3 axis = glm::normalize(view.camera.up), from_look = view.camera.eye - view.camera.look;
    const glm::dvec3 along = glm::dot(axis, from_look) * axis;  // Rodrigues' formula
    view.camera.eye = view.camera.look + along + std::cos(angle) * (from_look - along) +
                      std::sin(angle) * glm::cross(axis, from_look);
  }
  return view;
}

/// Pixels of a frame that have another region if nothing is left out of it.
Result<void> measure_differing(runtime::Evaluator& evaluator, runtime::View view, Measurement& result) {
  view.want_regions = true;
  const auto picture = evaluator.render(view);
  if (!picture) return tl::unexpected(picture.error());
  for (const runtime::FramePassInfo& pass : runtime::frame_pass_names()) view.disabled_passes.emplace_back(pass.name);
  const auto anew = evaluator.render(view);
  if (!anew) return tl::unexpected(anew.error());
  result.differing = 0;
  for (std::size_t i = 0; i < anew->regions.size(); ++i)
    *result.differing += anew->regions[i] != picture->regions[i] ? 1 : 0;
  return {};
}

Result<void> time_frames(runtime::Evaluator& evaluator, const runtime::View& view, const Effort& effort,
                         Measurement& result) {
  const Motion motion = result.what.settings.motion;
  std::size_t frame = 0;
  const auto draw = [&]() -> Result<runtime::Timings> {
    runtime::Timings timings;
    const auto picture = evaluator.render(view_of_frame(view, motion, ++frame), &timings);
    if (!picture) return tl::unexpected(picture.error());
    return timings;
  };
  while (result.settle_frames < effort.settle_frames && result.settle_ms < effort.settle_ms) {
    const auto timings = draw();
    if (!timings) return tl::unexpected(timings.error());
    ++result.settle_frames;
    result.settle_ms += ms_of(*timings, "frame");
  }
  const auto start = Clock::now();
  while (result.frame_ms.size() < effort.max_frames &&
         (result.frame_ms.size() < effort.min_frames || since_ms(start) < effort.frames_ms)) {
    const auto timings = draw();
    if (!timings) return tl::unexpected(timings.error());
    result.frame_ms.push_back(ms_of(*timings, "frame"));
    const bool has_gpu = std::ranges::any_of(*timings, [](const auto& t) { return t.step == runtime::gpu_step; });
    if (has_gpu) result.gpu_ms.push_back(ms_of(*timings, runtime::gpu_step));
  }
  if (!result.what.settings.verdicts) return {};
  return measure_differing(evaluator, view_of_frame(view, motion, ++frame), result);
}

/// The region numbers and colours of one picture against the reference at the very points it evaluated.
Result<void> measure_pixels(runtime::Evaluator& evaluator, Truth& truth, const Effort& effort, Measurement& result) {
  runtime::View view = truth.view(effort.error_size_px);
  // On the faces of the standard cube nothing is certain: a scene that is seen there is compared inside it.
  if (truth.source().mesh_path.empty() && view.cuts.empty() && !view.slice) view.slice = inner_plane;
  view.shading = runtime::Shading::none;
  view.want_regions = view.want_positions = true;
  const auto picture = evaluator.render(view);
  if (!picture) return tl::unexpected(picture.error());
  const PixelErrors errors =
      compare_pixels(truth.at_positions(picture->positions, result.what.settings.filter), *picture);
  result.pixels = errors.regions;
  result.color_rmse = errors.rmse;
  return {};
}

/// The colours of a slice with some samples a pixel against those of very many.
Result<void> measure_sampling(runtime::Evaluator& evaluator, Truth& truth, const Case& what, Measurement& result) {
  runtime::View view = truth.view(what.effort.error_size_px);
  view.samples = what.settings.samples;
  const auto picture = evaluator.render(view);
  if (!picture) return tl::unexpected(picture.error());
  const auto& expected = truth.mean_colors(*view.slice, view.size_px, what.effort.truth_samples);
  double squares = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      const double difference = picture->rgba[4 * i + static_cast<std::size_t>(channel)] - expected[i][channel];
      squares += difference * difference;
    }
  }
  result.color_rmse = std::sqrt(squares / (3.0 * static_cast<double>(expected.size())));
  return {};
}

Result<void> measure_shape(runtime::Evaluator& evaluator, const compiler::Program& program, const Shape& shape,
                           Measurement& result) {
  const auto inside = [&](std::span<const glm::dvec3> points) -> Result<std::vector<char>> {
    const auto answers = evaluator.probe(points);
    if (!answers) return tl::unexpected(answers.error());
    std::vector<char> sides;
    sides.reserve(points.size());
    for (const compiler::PointAnswer& answer : *answers) {
      sides.push_back(!answer.path.empty() && program.regions[answer.path.back().region].region == "R.INSIDE" ? 1 : 0);
    }
    return sides;
  };
  const auto found = measure_displacement(shape.surface, inside, shape.reach);
  if (!found) return tl::unexpected(found.error());
  result.displacement = *found;
  return {};
}

/// Cost of a point: the kernel `points` on a large batch, less that on a small one.
Result<void> time_points(runtime::Evaluator& evaluator, Truth& truth, const Effort& effort, Measurement& result) {
  // Pixel centres of a slice row by row, as pictures have them: neighbours in a dispatch are neighbours in space. Every
  // 16th row comes first, so that a small batch sees the whole slice as well.
  const runtime::SliceFrame frame = runtime::slice_frame(inner_plane, {512, 512});
  std::vector<glm::dvec3> points;
  for (std::uint32_t i = 0; i < largest_batch; ++i) {
    const std::uint32_t turn = i / 512, row = turn % 32 * 16 + turn / 32;
    points.push_back(frame.origin + static_cast<double>(i % 512) * frame.step_x +
                     static_cast<double>(row) * frame.step_y);
  }
  const auto kernel_ms = [&](std::uint32_t count) -> Result<double> {
    runtime::Timings timings;
    const auto answers = evaluator.probe(std::span(points).first(count), truth.source().time_ms, &timings);
    if (!answers) return tl::unexpected(answers.error());
    const double gpu_ms = ms_of(timings, runtime::gpu_step);
    return gpu_ms > 0.0 ? gpu_ms : ms_of(timings, "probe");
  };
  // ---- how many points are enough; the driver's compilation is over then ----
  kernel_ms(small_batch);
  const auto trial = kernel_ms(cautious_batch);
  if (!trial) return tl::unexpected(trial.error());
  const bool is_slow = *trial * largest_batch / cautious_batch > long_ms;
  const std::uint32_t large_batch = is_slow ? cautious_batch : largest_batch;

  const auto start = Clock::now();
  for (std::uint32_t round = 0; round < effort.probe_rounds; ++round) {
    const auto small = kernel_ms(small_batch);
    if (!small) return tl::unexpected(small.error());
    const auto large = kernel_ms(large_batch);
    if (!large) return tl::unexpected(large.error());
    result.point_ns.push_back(1e6 * (*large - *small) / (large_batch - small_batch));
    if (since_ms(start) > effort.frames_ms) break;
  }
  return {};
}

Result<void> measure_on(Bench& bench, Truth& truth, Measurement& result) {
  const Case& what = result.what;
  runtime::View view = truth.view(what.size_px);
  view.samples = what.settings.samples;
  view.colors = runtime::Colors::bytes;
  view.steady_colors = what.settings.motion != Motion::camera;
  view.disabled_passes = what.settings.disabled_passes;
  if (what.settings.motion == Motion::none) {
    for (const char* pass : {"keep-picture", "keep-surface", "keep-still"}) view.disabled_passes.emplace_back(pass);
  }

  // ---- builds, the first with its memory ----
  const SceneSource source = what.settings.surface_alone ? empty_cube() : truth.source();
  std::optional<session::Loaded> built;
  for (std::uint32_t i = 0; i < std::max(1u, what.effort.builds); ++i) {
    built.reset();
    const PeakMemory memory;
    auto made = build(bench, source, what.settings, Source::surface, &view, i == 0, result.steps);
    if (!made) return tl::unexpected(made.error());
    if (i == 0) result.peak_bytes = memory.bytes().value_or(0);
    built.emplace(std::move(*made));
  }
  result.statistics = built->program.statistics;
  result.upload_bytes = result.statistics.bytes.buffers + result.statistics.bytes.textures;
  if (view.slice) result.pixel_pitch = glm::length(runtime::slice_frame(*view.slice, view.size_px).step_x);

  // ---- pictures ----
  if (const auto done = time_frames(built->evaluator, view, what.effort, result); !done) return done;
  if (what.effort.truth_samples != 0) {
    if (const auto done = measure_sampling(built->evaluator, truth, what, result); !done) return done;
  } else if (what.effort.error_size_px.x != 0) {
    if (const auto done = measure_pixels(built->evaluator, truth, what.effort, result); !done) return done;
  }

  // ---- points ----
  if (what.effort.points == 0 && what.effort.probe_rounds == 0 && !what.shape) return {};
  if (const auto made = compiler::to_spirv(built->program, Source::points); !made) return made;
  auto device = bench.session.device();
  if (!device) return tl::unexpected(device.error());
  auto evaluator = runtime::Evaluator::create(*device, built->program);
  if (!evaluator) return tl::unexpected(evaluator.error());
  built->evaluator = std::move(*evaluator);
  if (what.effort.points != 0) {
    const auto answers = built->evaluator.probe(truth.points(what.effort.points), truth.source().time_ms);
    if (!answers) return tl::unexpected(answers.error());
    result.points = compare_points(truth.at_points(what.effort.points, what.settings.filter), *answers);
  }
  if (what.shape) {
    if (const auto done = measure_shape(built->evaluator, built->program, *what.shape, result); !done) return done;
  }
  return what.effort.probe_rounds != 0 ? time_points(built->evaluator, truth, what.effort, result) : Result<void>{};
}

Result<void> measure(const session::Options& options, Truth& truth, Measurement& result) {
  Bench bench(options);
  if (const auto device = bench.session.device(); !device) return tl::unexpected(device.error());
  auto done = measure_on(bench, truth, result);
  result.validation_messages = bench.session.validation_messages();
  return done;
}

std::string one_line(const Error& error) {
  return error.reasons.empty() ? error.message : error.message + ": " + error.reasons.front();
}

}  // namespace

double Measurement::build_ms() const {
  double sum = 0.0;
  for (const Step& step : steps) sum += median(step.ms);
  return sum;
}

std::vector<double> samples_of(const Measurement& measurement, const std::string& step) {
  const auto found = std::ranges::find(measurement.steps, step, &Step::name);
  return found == measurement.steps.end() ? std::vector<double>{} : found->ms;
}

std::vector<Measurement> run_cases(const session::Options& device, const std::vector<Case>& cases,
                                   const RunOptions& options) {
  const auto start = Clock::now();
  std::vector<Measurement> results;
  std::string scene_key;
  Result<std::unique_ptr<Truth>> truth = fail(Fault::input, "no scene");
  for (const Case& what : cases) {
    if (options.progress) options.progress(what);
    Measurement result;
    result.what = what;
    if (options.budget_s > 0.0 && since_ms(start) > 1e3 * options.budget_s) {
      result.failure = "left out: the time for this run was over";
    } else {
      if (what.scene_key != scene_key) {
        truth = fail(Fault::input, "no scene");  // the last scene's memory goes first
        truth = Truth::create(what.scene());
        scene_key = what.scene_key;
      }
      if (!truth) {
        result.failure = one_line(truth.error());
      } else {
        if (what.needs_grids && !(*truth)->has_grids()) continue;
        if (const auto done = measure(device, **truth, result); !done) result.failure = one_line(done.error());
      }
    }
    results.push_back(std::move(result));
    if (options.done) options.done(results);
  }
  return results;
}

}  // namespace dmvv::bench
