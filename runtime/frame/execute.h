// Inside the runtime only: records the steps of a tile's plan.
#pragma once

#include "runtime/frame/frame_images.h"
#include "runtime/frame/frame_kernels.h"
#include "runtime/frame/frame_plan.h"
#include "runtime/frame/verdicts.h"
#include "runtime/surface/raster.h"

namespace dmvv::runtime {

/// What the steps of a tile work on. All of it stays until the commands are done.
struct TileWork {
  const TilePlan& plan;
  const FrameSetup& setup;
  FramePasses passes;
  KernelKind kind;
  gpu::FrameParams params;
  const FrameKernels& kernels;
  const SceneOnDevice& scene;
  const Verdicts* verdicts;  ///< null: no step asks them
  Rasteriser& rasteriser;
  FrameImages& images;
  TileImages& tile;
};

/// Records all steps; barriers stand where their declared uses want them (frame_plan.h: waits).
void record_tile(const vk::raii::CommandBuffer& commands, TileWork& work);

}  // namespace dmvv::runtime
