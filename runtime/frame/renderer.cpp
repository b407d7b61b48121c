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

bool draws_surface(const TilePlan& tile) { return has_step(tile, Step::raster) || has_step(tile, Step::slice); }

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Renderer::Renderer(const Device::Impl& gpu, SceneOnDevice& scene, const compiler::Program& program,
                   std::shared_ptr<const compiler::Judge> judge, std::unique_ptr<Rasteriser> prepared)
    : gpu_(gpu),
      scene_(scene),
      judge_(std::move(judge)),
      kernels_(gpu, scene, program, make_set_layout(gpu, verdict_bindings)),
      rasteriser_(std::move(prepared)),
      strategies_({.has_judge = judge_ != nullptr, .has_leaders = kernels_.has_leaders()}) {}

Result<Renderer::Job> Renderer::set_up(const View& view) {
  if (!rasteriser_) rasteriser_ = std::make_unique<Rasteriser>(gpu_);
  if (!view.slice) {
    if (const auto set = rasteriser_->set_mesh(support_mesh(view)); !set) return tl::unexpected(set.error());
  }
  auto setup = plan_frame_setup(view, rasteriser_->bounds(), longest_picture_px);
  if (!setup) return tl::unexpected(setup.error());
  Job job;
  job.setup = std::move(*setup);
  job.passes = FramePasses::without(view.disabled_passes);
  job.outputs = {view.samples == 1 ? view.colors : Colors::floats,  // the mean of samples is taken in float
                 view.want_regions || view.want_depth, view.want_depth || view.want_positions};
  job.kind = {job.passes.pixel_list, job.outputs.colors == Colors::bytes, job.outputs.regions};
  const glm::uvec2 tile_px = largest_tile(job.setup.size_px, view.samples);
  job.extent = vk::Extent2D{tile_px.x, tile_px.y};
  job.tiles = tiles_of(job.setup.seen, job.extent);
  return job;
}

gpu::PixelsParams Renderer::params_of(const Job& job, const Tile& tile) const {
  gpu::PixelsParams params = job.setup.pixels;
  params.width = tile.size_px.x;
  params.height = tile.size_px.y;
  return params;
}

SurfaceKey Renderer::surface_key(const Job& job, const Tile& tile) const {
  return {job.setup.raster, job.setup.slice, rasteriser_->mesh_serial(), job.setup.has_caps, tile};
}

/// What is asked of the tiles, and what their images hold of it. Tiles that share images hold nothing for each other.
FrameRequest Renderer::request(const Job& job, const std::vector<Tile>& tiles) {
  FrameRequest request{.size_px = job.setup.size_px,
                       .tiles = tiles,
                       .kept = {},
                       .is_slice = job.setup.slice.has_value(),
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
    kept.other_time = kept.surface && held.shaded && only_time_differs(*held.shaded, shading);
  }
  return request;
}

/// The strategy is chosen for frames that evaluate something.
FramePlan Renderer::plan_job(const Job& job, const std::vector<Tile>& tiles, StrategyChoice& strategies) {
  FrameRequest asked = request(job, tiles);
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
                         .stages = static_cast<std::uint32_t>(kernels_.stages_go_on().size())};
  images_.emplace(gpu_, kernels_.io_layout(), job.extent, job.tiles.size(), job.outputs, needs,
                  rasteriser_->take_surface(job.extent));
}

/// Makes what is missing for this kind of picture, and draws a few pixels, so that the driver compiles it now. They are
/// drawn into the frame's own images: lavapipe compiles a kernel anew for images whose sides are powers of two.
Result<void> Renderer::warm_up(const Job& job, Timings* timings) {
  const bool is_warm = job.setup.slice || rasteriser_->is_ready(job.setup);
  const bool has_images = images_ && images_->serves(job.extent, job.tiles.size(), job.outputs);
  const bool has_kernels = kernels_.has_evaluation(job.kind);
  if (is_warm && has_images && has_kernels) return {};
  const Stopwatch watch(timings, "pipeline");
  const auto start = std::chrono::steady_clock::now();
  make_images(job);
  const std::vector<Tile> corner{{{0, 0}, glm::min(warm_up_px, job.setup.size_px)}};
  const auto done = run(job, plan_job(job, corner, strategies_), [](std::size_t) {});
  if (!done) return tl::unexpected(done.error());
  if (!has_kernels) strategies_.note_compilation(milliseconds_since(start));
  return {};
}

void Renderer::run_tile(const Job& job, const FramePlan& plan, std::size_t i, Done& done) {
  const TilePlan& planned = plan.tiles[i];
  TileImages& held = images_->of_tile(i);
  const bool draws = draws_surface(planned);
  if (!planned.steps.empty()) {
    const ShadingKey shading{params_of(job, planned.tile), scene_.time_values()};
    gpu::PixelsParams params = shading.params;
    params.has_leaders = plan.strategy.leads;
    params.lists_all = job.passes.pixel_list ? 0 : 1;
    params.keeps_still = planned.keeps_still;
    if (plan.strategy.classifies) verdicts_->fill(params);
    if (draws) held.drawn.reset();  // a failure below must leave no name on what is half done
    held.shaded.reset();
    TileWork work{planned,      job.setup, job.passes, job.kind,
                  params,       kernels_,  scene_,     plan.strategy.classifies ? &*verdicts_ : nullptr,
                  *rasteriser_, *images_,  held};
    done.device_ms += gpu_.run([&](const vk::raii::CommandBuffer& commands) { record_tile(commands, work); });
    held.drawn = surface_key(job, planned.tile);
    held.shaded = shading;
    done.worked = true;
    done.drew |= draws;
    done.evaluated += evaluated_pixels(pixels_of(held, planned.tile, job.outputs).counted, plan.strategy.leads);
  }
  done.unfinished += pixels_of(held, planned.tile, job.outputs).counted.unfinished;
  done.is_complete &= job.setup.slice.has_value() || rasteriser_->is_complete();
}

Result<Renderer::Done> Renderer::run(const Job& job, const FramePlan& plan,
                                     const std::function<void(std::size_t)>& take) {
  if (auto made = kernels_.prepare(plan, job.kind); !made) return tl::unexpected(std::move(made.error()));
  if (plan.strategy.classifies) {
    if (!verdicts_) verdicts_.emplace(gpu_, judge_, kernels_.verdict_layout());
    verdicts_->begin_frame(scene_.now_ms());
  }
  Done done;
  for (std::size_t i = 0; i < plan.tiles.size(); ++i) {
    run_tile(job, plan, i, done);
    take(i);
  }
  if (!done.worked) return done;
  const double splitting_ms =
      plan.strategy.classifies ? verdicts_->end_frame(done.evaluated, done.device_ms, done.drew) : 0.0;
  strategies_.end(plan.strategy, job.passes, done.device_ms, splitting_ms);
  return done;
}

Result<FramePlan> Renderer::plan(const View& view) {
  const auto job = set_up(view);
  if (!job) return tl::unexpected(job.error());
  make_images(*job);
  StrategyChoice unchanged = strategies_;  // asking changes nothing
  return plan_job(*job, job->tiles, unchanged);
}

Result<Picture> Renderer::render(const View& view, Timings* timings) {
  const auto job = set_up(view);
  if (!job) return tl::unexpected(job.error());
  if (const auto ready = warm_up(*job, timings); !ready) return tl::unexpected(ready.error());

  const Stopwatch watch(timings, "frame");
  Picture picture = empty_picture(view);
  const auto done = run(*job, plan_job(*job, job->tiles, strategies_), [&](std::size_t i) {
    const Tile& tile = job->tiles[i];
    resolve_tile(pixels_of(images_->of_tile(i), tile, job->outputs), tile, job->setup, view.samples, picture);
  });
  if (!done) return tl::unexpected(done.error());
  strategies_.note_picture();
  if (!done->is_complete) {
    return fail(Fault::input, "large triangles of the support mesh lie over each other too often to be drawn",
                {"render a smaller picture, or move the eye out of the mesh"});
  }
  if (done->unfinished != 0) {
    return fail(Fault::input,
                fmt::format("{} pixels needed more loop rounds than this device grants (65,535)", done->unfinished),
                {"split the scene's longest lists of seeds or embedded objects, or use another device"});
  }
  if (timings != nullptr && gpu_.timer_bits != 0) timings->push_back({gpu_step, done->device_ms});
  if (!view.slice && !view.cuts.empty()) picture.edges = rasteriser_->edges();
  return picture;
}

}  // namespace dmvv::runtime
