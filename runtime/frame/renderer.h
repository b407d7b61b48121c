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
///
/// A frame is begun and ended. In between the device works on it, and the host may do other things; whatever the host
/// writes for the device (the time's values, proofs, a mesh) waits for its end.
class Renderer {
 public:
  /// `prepared` may hold a rasteriser that was made while the program was compiled.
  /// The judge may be null: then nothing is proven. The program may go.
  Renderer(const Device::Impl& gpu, SceneOnDevice& scene, const compiler::Program& program,
           std::shared_ptr<const compiler::Judge> judge, std::unique_ptr<Rasteriser> prepared);

  /// As Evaluator::draw. The scene's time is set, and no frame is under way.
  Result<void> draw(const View& view, Timings* timings);
  /// As Evaluator::finish.
  Result<void> finish(Timings* timings);
  /// As Evaluator::render. The scene's time is set, and no frame is under way.
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
    bool wants_normals = true;  ///< of what rays meet
    vk::Extent2D extent;        ///< of the largest tile
    std::vector<Tile> tiles;
  };
  /// What a frame did.
  struct Done {
    double device_ms = 0.0;
    std::uint32_t evaluated = 0, unfinished = 0;
    std::uint64_t doubtful = 0, begun_within = 0;  ///< rays
    bool drew = false;                             ///< a surface
    bool worked = false;                           ///< evaluated anything
    bool is_complete = true;                       ///< all of the mesh has been drawn
  };
  /// Called with the number of each tile once its pixels are home: the next tile may overwrite them.
  using Take = std::function<void(std::size_t)>;
  /// A tile that the device works on.
  struct TileUnderWay {
    std::size_t number;
    SurfaceKey surface;
    ShadingKey shading;
    Submission work;  ///< empty if there was nothing to do
  };
  /// A frame that was begun.
  struct FrameUnderWay {
    Job job;
    FramePlan plan;
    Take take;
    Done done;
    std::vector<TileUnderWay> tiles;
  };

  Result<Job> set_up(const View& view);
  Result<void> warm_up(const Job& job, Timings* timings);
  void make_images(const Job& job);
  FrameRequest request(const Job& job, const std::vector<Tile>& tiles);
  FramePlan plan_job(const Job& job, const std::vector<Tile>& tiles, bool brings_home, StrategyChoice& strategies);
  Result<void> begin(const Job& job, FramePlan plan, Take take);
  void begin_tile(FrameUnderWay& frame, std::size_t i);
  Submission submit(const FrameUnderWay& frame, const TilePlan& planned, const ShadingKey& shading, TileImages& held);
  /// Waits for the tiles under way.
  void settle(FrameUnderWay& frame);
  /// Waits for the frame, and learns from it.
  Done end();
  gpu::FrameParams params_of(const Job& job, const Tile& tile) const;
  SurfaceKey surface_key(const Job& job, const Tile& tile) const;

  const Device::Impl& gpu_;
  SceneOnDevice& scene_;
  std::shared_ptr<const compiler::Judge> judge_;  ///< may be null
  voml::Bounds content_;
  FrameKernels kernels_;
  std::unique_ptr<Rasteriser> rasteriser_;  ///< made for the first view, if it was not prepared
  std::optional<FrameImages> images_;
  std::optional<Verdicts> verdicts_;  ///< made before the second frame: one picture alone does without
  StrategyChoice strategies_;
  bool has_traced_ = false;
  std::uint64_t doubtful_ = 0, begun_within_ = 0;  ///< rays of the picture that was drawn last
  std::optional<FrameUnderWay> under_way_;         ///< goes before what it works on
};

}  // namespace dmvv::runtime
