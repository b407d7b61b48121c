// Inside the runtime only: pictures of a program, frame after frame.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/frame/execute.h"
#include "runtime/frame/frame_images.h"
#include "runtime/frame/frame_kernels.h"
#include "runtime/frame/frame_plan.h"
#include "runtime/frame/scene_on_device.h"
#include "runtime/frame/strategy.h"
#include "runtime/frame/verdicts.h"
#include "runtime/gpu/device.h"
#include "runtime/surface/raster.h"
#include "runtime/view/picture.h"

namespace dmvv::runtime {

/// Draws views, and keeps of each frame what may serve the next one.
class Renderer {
 public:
  /// `prepared` may hold a rasteriser that was made while the program was compiled.
  /// The judge may be null: then nothing is proven.
  Renderer(const Device::Impl& gpu, SceneOnDevice& scene, const compiler::Program& program,
           std::shared_ptr<const compiler::Judge> judge, std::unique_ptr<Rasteriser> prepared);

  /// As Evaluator::render. The scene's time is set.
  Result<Picture> render(const View& view, Timings* timings);
  /// What `render` would do for the view now.
  Result<FramePlan> plan(const View& view);

 private:
  /// A view, ready to be planned.
  struct Job {
    FrameSetup setup;
    FramePasses passes;
    Outputs outputs;
    KernelKind kind;
    vk::Extent2D extent;  ///< of the largest tile
    std::vector<Tile> tiles;
  };
  /// What a frame did.
  struct Done {
    double device_ms = 0.0;
    std::uint32_t evaluated = 0, unfinished = 0;
    bool drew = false;        ///< a surface
    bool worked = false;      ///< anything at all
    bool is_complete = true;  ///< all of the mesh has been drawn
  };

  Result<Job> set_up(const View& view);
  Result<void> warm_up(const Job& job, Timings* timings);
  void make_images(const Job& job);
  FrameRequest request(const Job& job, const std::vector<Tile>& tiles);
  FramePlan plan_job(const Job& job, const std::vector<Tile>& tiles, StrategyChoice& strategies);
  /// Calls `take` with the number of each tile once its pixels are there: the next tile may overwrite them.
  Result<Done> run(const Job& job, const FramePlan& plan, const std::function<void(std::size_t)>& take);
  void run_tile(const Job& job, const FramePlan& plan, std::size_t i, Done& done);
  gpu::PixelsParams params_of(const Job& job, const Tile& tile) const;
  SurfaceKey surface_key(const Job& job, const Tile& tile) const;

  const Device::Impl& gpu_;
  SceneOnDevice& scene_;
  std::shared_ptr<const compiler::Judge> judge_;  ///< may be null
  FrameKernels kernels_;
  std::unique_ptr<Rasteriser> rasteriser_;  ///< made for the first view, if it was not prepared
  std::optional<FrameImages> images_;
  std::optional<Verdicts> verdicts_;  ///< made before the second frame: one picture alone does without
  StrategyChoice strategies_;
};

}  // namespace dmvv::runtime
