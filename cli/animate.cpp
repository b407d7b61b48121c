// dmvv animate SCENE -o CLIP|FRAMES --to MS: an animation's frames, and a clip of them.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <csignal>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "base/content_hash.h"
#include "base/text.h"
#include "cli/commands.h"
#include "cli/encoder.h"
#include "cli/frame_folder.h"
#include "cli/frames.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "cli/view_options.h"
#include "session/timeline.h"

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

struct AnimateOptions {
  SceneOptions scene;
  ViewOptions view;
  CodegenChoice codegen;
  DeviceChoice device;
  std::string output;
  double from_ms = 0;
  double to_ms = 0;
  double fps = 30;
  std::string frames;
  bool restart = false;
  bool keep_frames = false;
};

struct Clip {
  ClipFormat format;
  std::string ffmpeg;
};

/// What is to be made, known before the scene is.
struct Plan {
  session::Timeline times;
  std::uint32_t count;
  FrameRange range;
  FrameNames names;
  std::optional<Clip> clip;  ///< none: the frames are the result
};

// --- stopping between frames

volatile std::sig_atomic_t stop_signal = 0;
void note_signal(int number) { stop_signal = number; }

/// The first Ctrl-C (or SIGTERM) is noted, the second ends the program as usual: no file is ever torn.
void notice_signals() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESTART | SA_RESETHAND;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

int stopped(const Context& context) {
  if (!context.quiet) print_warning("stopped; what is done is kept, and the same command goes on from there");
  return 128 + stop_signal;
}

// --- what the options say

std::string ending_of(const std::string& path) { return lower_case(fs::path(path).extension().string()); }

std::optional<Clip> plan_clip(const AnimateOptions& options, glm::uvec2 size_px) {
  const std::string ending = ending_of(options.output);
  if (ending == ".png") {
    if (options.keep_frames) fail_usage("--keep-frames is for clips: frames that are the result stay anyway");
    return std::nullopt;
  }
  const ClipFormat format = ending == ".webm" ? ClipFormat::webm : ClipFormat::mp4;
  if (format == ClipFormat::mp4 && (size_px.x % 2 != 0 || size_px.y % 2 != 0)) {
    fail_usage(
        fmt::format("--size: {}x{} cannot be an .mp4 clip, whose sides are even", size_px.x, size_px.y),
        {fmt::format("use --size {}x{}, or a .webm clip", size_px.x + size_px.x % 2, size_px.y + size_px.y % 2)});
  }
  return Clip{format, must(find_ffmpeg())};
}

Plan make_plan(const AnimateOptions& options, glm::uvec2 size_px) {
  Outputs().announce(options.output, {".mp4", ".webm", ".png"});
  const auto times = session::make_timeline(options.from_ms, options.to_ms, options.fps);
  if (!times) fail_usage(times.error().message, times.error().reasons);
  const std::uint32_t count = times->count();
  const FrameRange range = options.frames.empty() ? FrameRange{0, count - 1}
                                                  : must_parse("--frames", parse_frame_range(options.frames, count));
  std::optional<Clip> clip = plan_clip(options, size_px);
  const std::string frames = clip ? options.output + ".frames/frame_%06d.png" : options.output;
  return {*times, count, range, must_parse("--output", FrameNames::parse(frames)), std::move(clip)};
}

json numbers(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
json numbers(const runtime::Plane& plane) { return {plane.normal.x, plane.normal.y, plane.normal.z, plane.d}; }

json describe(const runtime::View& view, const std::string& root, const std::string& mesh_hash) {
  json cuts = json::array();
  for (const runtime::Plane& cut : view.cuts) cuts.push_back(numbers(cut));
  json result{{"root", root}, {"samples", view.samples}};
  if (view.slice) {
    result["slice"] = numbers(*view.slice);
    return result;
  }
  const runtime::Camera& camera = view.camera;
  result["camera"] = {{"eye", numbers(camera.eye)},
                      {"look", numbers(camera.look)},
                      {"up", numbers(camera.up)},
                      {"fov", camera.fov_deg}};
  result["mesh"] = view.mesh ? json(mesh_hash) : json();
  result["cuts"] = std::move(cuts);
  result["shading"] = view.shading == runtime::Shading::lit ? "lit" : "none";
  return result;
}

/// Everything that determines the frames, and the name of the scene for the reader.
json make_manifest(const AnimateOptions& options, const Plan& plan, const runtime::View& view,
                   const std::string& scene_hash, const std::string& mesh_hash, const runtime::DeviceInfo& device) {
  return {{"scene", fs::path(options.scene.path).filename().string()},
          {"scene_hash", scene_hash},
          {"version", DMVV_VERSION},
          {"device", device.name},
          {"driver", device.driver},
          {"span_ms", {plan.times.from_ms, plan.times.to_ms}},
          {"fps", plan.times.fps},
          {"frames", plan.count},
          {"names", plan.names.pattern()},
          {"size", {view.size_px.x, view.size_px.y}},
          {"view", describe(view, options.scene.root, mesh_hash)},
          {"shader",
           {{"codegen", options.codegen.codegen},
            {"atlas", options.codegen.atlas},
            {"filter", options.codegen.filter},
            {"disable", options.codegen.disabled_passes}}}};
}

// --- frames

/// Writes frames on other threads while the next ones are drawn.
class FrameWriter {
 public:
  explicit FrameWriter(const FrameFolder& folder, ProgressBar& progress) : folder_(folder), progress_(progress) {}

  void add(std::uint32_t frame, runtime::Picture picture) {
    constexpr std::size_t budget_bytes = std::size_t{256} << 20;
    const std::size_t bytes = picture.rgba8.size();
    const std::size_t most = std::clamp<std::size_t>(budget_bytes / bytes, 1, std::thread::hardware_concurrency() + 1);
    while (pending_.size() >= most) wait_for_first();
    pending_.push_back(
        std::async(std::launch::async, [this, frame, picture = std::move(picture)] { return write(frame, picture); }));
  }

  void finish() {
    while (!pending_.empty()) wait_for_first();
  }

 private:
  Result<void> write(std::uint32_t frame, const runtime::Picture& picture) const {
    const std::string name = folder_.names().name(frame);
    if (auto written = runtime::write_picture(folder_.partial(name), picture); !written) return written;
    return folder_.publish(name, folder_.path(frame));
  }

  void wait_for_first() {
    Result<void> written = pending_.front().get();
    pending_.pop_front();
    must(std::move(written));
    progress_.advance();
  }

  const FrameFolder& folder_;
  ProgressBar& progress_;
  std::deque<std::future<Result<void>>> pending_;
};

/// Draws the frames and writes them into the folder, until all are there or a signal came.
void draw_frames(runtime::Evaluator& evaluator, runtime::View view, const Plan& plan,
                 const std::vector<std::uint32_t>& frames, FrameFolder& folder, const AnimateOptions& options,
                 Context& context) {
  const auto draw = [&](std::uint32_t frame) {
    view.time_ms = plan.times.time_ms(frame);
    runtime::Timings timings;
    runtime::Picture picture = must(evaluator.render(view, &timings));
    context.stopwatch.lap(timings, "other");
    return picture;
  };
  // The first picture comes before the folder: a view that cannot be drawn leaves nothing behind.
  std::optional<runtime::Picture> first;
  if (!frames.empty()) first = draw(frames.front());
  must(folder.begin(options.restart));
  if (!first) return;
  warn_of_edges(first->edges, options.view, context);

  const std::size_t total = plan.range.last - plan.range.first + 1;
  ProgressBar progress("frames", total, total - frames.size(), context.quiet);
  FrameWriter writer(folder, progress);
  for (const std::uint32_t frame : frames) {
    if (stop_signal != 0) break;
    writer.add(frame, first ? std::move(*first) : draw(frame));
    first.reset();
    context.stopwatch.lap("encode");
  }
  writer.finish();
  context.stopwatch.lap("encode");
}

// --- the clip

/// Encodes all frames; nothing is written if a signal came before the end.
void encode(const Plan& plan, glm::uvec2 size_px, FrameFolder& folder, const std::string& target, Context& context) {
  constexpr std::string_view name = "clip";
  ProgressBar progress("clip", plan.count, 0, context.quiet);
  auto encoder = must(Encoder::start({plan.clip->ffmpeg, plan.clip->format, size_px, plan.times.fps,
                                      folder.partial(name), folder.partial("ffmpeg.log")}));
  for (std::uint32_t frame = 0; frame < plan.count; ++frame) {
    if (stop_signal != 0) return;
    must(encoder.write(must(read_frame(folder.path(frame), size_px, plan.clip->format))));
    progress.advance();
  }
  must(encoder.finish());
  if (stop_signal != 0) return;
  must(folder.publish(name, target));
  context.stopwatch.lap("clip");
}

int make_clip(const Plan& plan, glm::uvec2 size_px, FrameFolder& folder, const AnimateOptions& options,
              Context& context) {
  encode(plan, size_px, folder, options.output, context);
  if (stop_signal != 0) return stopped(context);
  if (!options.keep_frames && !folder.remove() && !context.quiet) {
    print_warning(fmt::format("'{}' is kept: another run is using it", folder.names().folder()));
  }
  return exit_done;
}

void print_summary(const Plan& plan, const AnimateOptions& options, const runtime::View& view, std::size_t drawn,
                   const runtime::DeviceInfo& device, const Context& context) {
  const std::size_t total = plan.range.last - plan.range.first + 1;
  std::string text =
      fmt::format("{}: {} of {}x{}", options.output, plural(total, "frame"), view.size_px.x, view.size_px.y);
  if (drawn < total) text += fmt::format(", {} of them drawn before", total - drawn);
  text += fmt::format(", {:.2f} s on {}\n", context.stopwatch.seconds(), device.name);
  if (plan.clip && !options.frames.empty()) {
    text +=
        fmt::format("the frames are in '{}'; the same command without --frames makes the clip\n", plan.names.folder());
  }
  print_result(text);
}

int animate(const AnimateOptions& options, Context& context) {
  // Everything that can be refused without the scene comes first.
  runtime::View view = parse_view(options.view);
  view.colors = runtime::Colors::bytes;
  compiler::CompileOptions form = compile_options(options.codegen);
  view.disabled_passes = form.disabled_passes;
  const Plan plan = make_plan(options, view.size_px);
  form.many_frames = plan.range.last > plan.range.first;
  view.rays = view.rays && form.codegen != compiler::Codegen::thesis;  // which draws the cube's faces
  form.rays = view.rays;

  session::Session session = make_session(options.device, context);
  Diagnostics diagnostics(options.scene.strict);
  ContentHash scene_hash, mesh_hash;
  voml::Scene scene = must(session.read(scene_file(options.scene, hashing(disk_files(), scene_hash)), diagnostics),
                           diagnostics, context);
  place_camera(view, options.view, hashing(disk_files(), mesh_hash), context, diagnostics);
  const runtime::Device device = must(session.device());
  if (form.codegen == compiler::Codegen::automatic) must(session.calibrate());  // many frames pay for it

  FrameFolder folder(plan.names, view.size_px,
                     make_manifest(options, plan, view, scene_hash.text(), mesh_hash.text(), device.info()));
  std::vector<std::uint32_t> frames;
  if (options.restart) {
    for (std::uint32_t frame = plan.range.first; frame <= plan.range.last; ++frame) frames.push_back(frame);
  } else {
    must(folder.check());
    frames = folder.missing(plan.range);
  }
  context.stopwatch.lap("resume");

  if (!view.rays) session.prepare_surface(view);
  runtime::Timings timings;
  auto [program, evaluator] = load(session, std::move(scene), form, kernels_for(view), context, diagnostics, &timings);
  frame_content(view, options.view, program.content);
  context.stopwatch.lap(timings, "other");

  notice_signals();
  draw_frames(evaluator, view, plan, frames, folder, options, context);
  if (const int exit_code = exit_code_of(session.validation_messages()); exit_code != exit_done) return exit_code;
  if (stop_signal != 0) return stopped(context);
  if (plan.clip && options.frames.empty()) {
    const int exit_code = make_clip(plan, view.size_px, folder, options, context);
    if (exit_code != exit_done) return exit_code;
  }
  if (!context.quiet) print_summary(plan, options, view, frames.size(), device.info(), context);
  return exit_done;
}

void add_span_options(CLI::App& command, AnimateOptions& options) {
  command.add_option("--from", options.from_ms, "Time of the first frame in milliseconds; default 0")->type_name("MS");
  command.add_option("--to", options.to_ms, "End of the span in milliseconds; no frame stands there itself")
      ->required()
      ->type_name("MS");
  command.add_option("--fps", options.fps, "Frames per second; default 30")->type_name("N");
  command
      .add_option("--frames", options.frames,
                  "Draw a share of the frames only, both included; clips are made without it, when all are there")
      ->type_name("FIRST-LAST");
  command.add_flag("--restart", options.restart, "Remove the frames that are there and draw all anew");
  command.add_flag("--keep-frames", options.keep_frames, "Keep the frames of a clip, in CLIP.frames");
}

}  // namespace

void add_animate(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<AnimateOptions>();
  CLI::App& command = *app.add_subcommand("animate", "Draw the frames of an animation, and make a clip of them");
  add_scene_options(command, options->scene);
  command
      .add_option("-o,--output", options->output,
                  "Clip (.mp4 opaque over white, .webm with alpha), or frames: a .png name with %04d in it")
      ->required()
      ->type_name("CLIP");
  add_span_options(command, *options);
  add_view_options(command, options->view);
  add_codegen_options(command, options->codegen);
  add_device_options(command, options->device);
  add_common_options(command, invocation.context);
  command.footer(
      "Example:  dmvv animate metaballs.voml -o metaballs.mp4 --to 10000 --fps 30 --size 640x360\n"
      "A run that was stopped goes on with the same command. Exit code 130: stopped by Ctrl-C.");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return animate(*options, context); };
  });
}

}  // namespace dmvv::cli
