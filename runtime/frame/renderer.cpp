// A frame: what is looked at, what the images hold of it, what is to be done, and what comes back.
#include "runtime/frame/renderer.h"

#include <chrono>
#include <cmath>
#include <glm/common.hpp>

#include "compiler/snippet/time_range.h"
#include "runtime/frame/resolve.h"

namespace dmvv::runtime {
namespace {

std::vector<Tile> tiles_of(const PixelRange& seen, vk::Extent2D extent) {
  std::vector<Tile> tiles;
  for (std::uint32_t y = seen.lo.y; y < seen.hi.y; y += extent.height) {
    for (std::uint32_t x = seen.lo.x; x < seen.hi.x; x += extent.width) {
      tiles.push_back({{x, y}, glm::min(glm::uvec2(extent.width, extent.height), seen.hi - glm::uvec2(x, y))});
    }
  }
  return tiles;
}

std::uint32_t evaluated_pixels(const gpu::PixelListHeader& counted, bool with_leaders) {
  const auto& counts = counted.counts;
  return with_leaders ? counts[DMVV_LEADERS_OF_TILES] + counts[DMVV_LEFT] : counts[DMVV_TO_EVALUATE];
}

bool has_step(const TilePlan& tile, Step step) {
  return std::ranges::find(tile.steps, step, &PlannedStep::step) != tile.steps.end();
}

bool draws_surface(const TilePlan& tile) {
  return has_step(tile, Step::raster) || has_step(tile, Step::slice) || has_step(tile, Step::trace);
}

SurfaceKind surface_of(const FrameSetup& setup) {
  if (setup.slice) return SurfaceKind::slice;
  return setup.rays ? SurfaceKind::rays : SurfaceKind::mesh;
}

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Renderer::Renderer(const Device::Impl& gpu, SceneOnDevice& scene, const compiler::Program& program,
                   std::shared_ptr<const compiler::Judge> judge, std::unique_ptr<Rasteriser> prepared)
    : gpu_(gpu),
      scene_(scene),
      judge_(std::move(judge)),
      content_(program.content),
      kernels_(gpu, scene, program, make_set_layout(gpu, verdict_bindings)),
      rasteriser_(std::move(prepared)),
      strategies_({.has_judge = judge_ != nullptr, .has_leaders = kernels_.has_leaders()}) {}

Result<Renderer::Job> Renderer::set_up(const View& view) {
  if (!rasteriser_) rasteriser_ = std::make_unique<Rasteriser>(gpu_);
  if (!view.slice && !view.rays) {
    if (const auto set = rasteriser_->set_mesh(support_mesh(view)); !set) return tl::unexpected(set.error());
  }
  auto setup = plan_frame_setup(view, view.rays ? content_ : rasteriser_->bounds(), longest_picture_px);
  if (!setup) return tl::unexpected(setup.error());
  Job job;
  job.setup = std::move(*setup);
  job.passes = FramePasses::without(view.disabled_passes);
  // The mean of samples is taken in float, and so are media and what is behind them.
  const bool is_blended = view.samples > 1 || (view.rays && !view.slice && kernels_.has_media());
  job.outputs = {is_blended ? Colors::floats : view.colors, view.want_regions || view.want_depth,
                 view.want_depth || view.want_positions || (view.want_normals && !view.slice),
                 view.want_doubt && view.rays && !view.slice};
  job.wants_normals = view.shading == Shading::lit || view.want_normals;
  job.kind = {job.passes.pixel_list, job.outputs.colors == Colors::bytes, job.outputs.regions};
  const glm::uvec2 tile_px = largest_tile(job.setup.size_px, view.samples);
  job.extent = vk::Extent2D{tile_px.x, tile_px.y};
  job.tiles = tiles_of(job.setup.seen, job.extent);
  return job;
}

gpu::FrameParams Renderer::params_of(const Job& job, const Tile& tile) const {
  gpu::FrameParams params = job.setup.pixels;
  params.width = tile.size_px.x;
  params.height = tile.size_px.y;
  return params;
}

SurfaceKey Renderer::surface_key(const Job& job, const Tile& tile) const {
  const bool is_of_rays = job.setup.rays.has_value();
  return {job.setup.raster,
          job.setup.slice,
          is_of_rays,
          is_of_rays ? scene_.time_values() : std::vector<float>{},
          rasteriser_->mesh_serial(),
          job.setup.has_caps,
          tile};
}

/// What is asked of the tiles, and what their images hold of it. Tiles that share images hold nothing for each other.
FrameRequest Renderer::request(const Job& job, const std::vector<Tile>& tiles) {
  FrameRequest request{.size_px = job.setup.size_px,
                       .tiles = tiles,
                       .kept = {},
                       .surface = surface_of(job.setup),
                       .wants_normals = job.wants_normals,
                       .has_media = kernels_.has_media(),
                       .passes = job.passes,
                       .strategy = {},
                       .stages_go_on = kernels_.stages_go_on()};
  request.kept.resize(tiles.size());
  for (std::size_t i = 0; i < tiles.size() && images_->keeps(tiles.size()); ++i) {
    const TileImages& held = images_->of_tile(i);
    const ShadingKey shading{params_of(job, tiles[i]), scene_.time_values()};
    KeptTile& kept = request.kept[i];
    kept.surface = held.drawn == surface_key(job, tiles[i]);
    kept.picture = kept.surface && held.shaded == shading;
    kept.home = kept.picture && held.is_home;
    kept.other_time = kept.surface && held.shaded && only_time_differs(*held.shaded, shading);
  }
  return request;
}

/// The strategy is chosen for frames that evaluate something.
FramePlan Renderer::plan_job(const Job& job, const std::vector<Tile>& tiles, bool brings_home,
                             StrategyChoice& strategies) {
  FrameRequest asked = request(job, tiles);
  asked.brings_home = brings_home;
  if (!is_kept(asked)) {
    const bool is_time_provable = std::abs(scene_.now_ms()) <= compiler::longest_ms;
    asked.strategy = strategies.begin(job.passes, is_time_provable);
  }
  return plan_frame(asked);
}

void Renderer::make_images(const Job& job) {
  if (images_ && images_->serves(job.extent, job.tiles.size(), job.outputs)) return;
  images_.reset();
  rasteriser_->set_extent(job.extent);
  const FrameNeeds needs{.leaders = kernels_.has_leaders(),
                         .verdicts = judge_ != nullptr,
                         .rays = kernels_.has_rays(),
                         .media = kernels_.has_media(),
                         .stages = static_cast<std::uint32_t>(kernels_.stages_go_on().size())};
  images_.emplace(gpu_, kernels_.io_layout(), job.extent, job.tiles.size(), job.outputs, needs,
                  rasteriser_->take_surface(job.extent));
}

/// Makes what is missing for this kind of picture, and draws a few pixels, so that the driver compiles it now. They are
/// drawn into the frame's own images: lavapipe compiles a kernel anew for images whose sides are powers of two.
Result<void> Renderer::warm_up(const Job& job, Timings* timings) {
  const bool is_warm = job.setup.slice || (job.setup.rays ? has_traced_ : rasteriser_->is_ready(job.setup));
  const bool has_images = images_ && images_->serves(job.extent, job.tiles.size(), job.outputs);
  const bool has_kernels = kernels_.has_evaluation(job.kind);
  if (is_warm && has_images && has_kernels) return {};
  const Stopwatch watch(timings, "pipeline");
  const auto start = std::chrono::steady_clock::now();
  make_images(job);
  const std::vector<Tile> corner{{{0, 0}, glm::min(warm_up_px, job.setup.size_px)}};
  constexpr bool brings_home = true;  // whatever pictures do
  if (auto begun = begin(job, plan_job(job, corner, brings_home, strategies_), {}); !begun) return begun;
  end();
  has_traced_ = has_traced_ || job.setup.rays;
  if (!has_kernels) strategies_.note_compilation(milliseconds_since(start));
  return {};
}

Submission Renderer::submit(const FrameUnderWay& frame, const TilePlan& planned, const ShadingKey& shading,
                            TileImages& held) {
  const auto& [classifies, leads] = frame.plan.strategy;
  gpu::FrameParams params = shading.params;
  params.has_leaders = leads;
  params.lists_all = frame.job.passes.pixel_list ? 0 : 1;
  params.keeps_still = planned.keeps_still;
  if (classifies) verdicts_->fill(params);
  TileWork work{planned,
                frame.job.setup,
                frame.job.passes,
                frame.job.kind,
                params,
                kernels_,
                scene_,
                classifies ? &*verdicts_ : nullptr,
                *rasteriser_,
                *images_,
                held};
  return gpu_.queue.submit([&](const vk::raii::CommandBuffer& commands) { record_tile(commands, work); });
}

void Renderer::begin_tile(FrameUnderWay& frame, std::size_t i) {
  const TilePlan& planned = frame.plan.tiles[i];
  // The host writes what a surface is drawn from, and tiles that share images overwrite each other.
  if (draws_surface(planned) || !images_->keeps(frame.plan.tiles.size())) settle(frame);
  TileImages& held = images_->of_tile(i);
  TileUnderWay tile{
      i, surface_key(frame.job, planned.tile), {params_of(frame.job, planned.tile), scene_.time_values()}, {}};
  if (is_evaluated(planned)) {  // a failure must leave no name on what is half done
    if (draws_surface(planned)) held.drawn.reset();
    held.shaded.reset();
    held.is_home = false;
  }
  if (!planned.steps.empty()) tile.work = submit(frame, planned, tile.shading, held);
  frame.tiles.push_back(std::move(tile));
}

void Renderer::settle(FrameUnderWay& frame) {
  Done& done = frame.done;
  for (TileUnderWay& tile : frame.tiles) {
    const TilePlan& planned = frame.plan.tiles[tile.number];
    TileImages& held = images_->of_tile(tile.number);
    done.device_ms += tile.work.wait();
    if (is_evaluated(planned)) {
      held.drawn = tile.surface;
      held.shaded = std::move(tile.shading);
      done.worked = true;
      done.drew |= draws_surface(planned);
      done.evaluated += evaluated_pixels(counted(held).pixels, frame.plan.strategy.leads);
    }
    if (frame.job.setup.rays) {
      done.doubtful += counted(held).rays.doubtful;
      done.begun_within += counted(held).rays.begun_within;
      done.unfinished += counted(held).rays.unfinished;
    }
    held.is_home |= has_step(planned, Step::bring_home);
    done.unfinished += counted(held).pixels.unfinished;
    done.is_complete &= surface_of(frame.job.setup) != SurfaceKind::mesh || rasteriser_->is_complete();
    if (frame.take) frame.take(tile.number);
  }
  frame.tiles.clear();
}

Result<void> Renderer::begin(const Job& job, FramePlan plan, Take take) {
  if (auto made = kernels_.prepare(plan, job.kind); !made) return made;
  if (plan.strategy.classifies) {
    if (!verdicts_) verdicts_.emplace(gpu_, judge_, kernels_.verdict_layout());
    verdicts_->begin_frame(scene_.now_ms());
  }
  under_way_.emplace(FrameUnderWay{job, std::move(plan), std::move(take), {}, {}});
  for (std::size_t i = 0; i < under_way_->plan.tiles.size(); ++i) begin_tile(*under_way_, i);
  return {};
}

Renderer::Done Renderer::end() {
  FrameUnderWay frame = std::move(*under_way_);
  under_way_.reset();
  settle(frame);
  const Done& done = frame.done;
  if (!done.worked) return done;
  const Strategy& strategy = frame.plan.strategy;
  const double splitting_ms =
      strategy.classifies ? verdicts_->end_frame(done.evaluated, done.device_ms, done.drew) : 0.0;
  strategies_.end(strategy, frame.job.passes, done.device_ms, splitting_ms);
  return done;
}

Result<FramePlan> Renderer::plan(const View& view) {
  const auto job = set_up(view);
  if (!job) return tl::unexpected(job.error());
  make_images(*job);
  StrategyChoice unchanged = strategies_;  // asking changes nothing
  constexpr bool brings_home = true;
  return plan_job(*job, job->tiles, brings_home, unchanged);
}

Result<void> Renderer::draw(const View& view, Timings* timings) {
  const auto job = set_up(view);
  if (!job) return tl::unexpected(job.error());
  if (auto ready = warm_up(*job, timings); !ready) return ready;
  const Stopwatch watch(timings, "frame");
  constexpr bool brings_home = false;
  return begin(*job, plan_job(*job, job->tiles, brings_home, strategies_), {});
}

Result<void> Renderer::finish(Timings* timings) {
  if (!under_way_) return {};
  const Done done = end();
  strategies_.note_picture();
  doubtful_ = done.doubtful;
  begun_within_ = done.begun_within;
  if (!done.is_complete) {
    return fail(Fault::input, "large triangles of the support mesh lie over each other too often to be drawn",
                {"render a smaller picture, or move the eye out of the mesh"});
  }
  if (done.unfinished != 0) {
    return fail(Fault::input,
                fmt::format("{} pixels needed more loop rounds than this device grants (65,535)", done.unfinished),
                {"split the scene's longest lists of seeds or embedded objects, or use another device"});
  }
  if (timings != nullptr && gpu_.queue.is_timed()) timings->push_back({gpu_step, done.device_ms});
  return {};
}

Result<Picture> Renderer::render(const View& view, Timings* timings) {
  const auto job = set_up(view);
  if (!job) return tl::unexpected(job.error());
  if (const auto ready = warm_up(*job, timings); !ready) return tl::unexpected(ready.error());

  const Stopwatch watch(timings, "frame");
  Picture picture = empty_picture(view);
  const auto take = [&](std::size_t i) {
    const Tile& tile = job->tiles[i];
    resolve_tile(pixels_of(images_->of_tile(i), tile, job->outputs), tile, job->setup, view.samples, picture);
  };
  constexpr bool brings_home = true;
  if (auto begun = begin(*job, plan_job(*job, job->tiles, brings_home, strategies_), take); !begun)
    return tl::unexpected(std::move(begun.error()));
  if (auto done = finish(timings); !done) return tl::unexpected(std::move(done.error()));
  picture.doubtful_rays = doubtful_;
  picture.eye_within = begun_within_ != 0;
  if (!view.slice && !view.rays && !view.cuts.empty()) picture.edges = rasteriser_->edges();
  return picture;
}

}  // namespace dmvv::runtime
