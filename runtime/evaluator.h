// Inside the runtime only: a program on a device, for points and for pictures.
#pragma once

#include "runtime/frame/points.h"
#include "runtime/frame/renderer.h"
#include "runtime/frame/scene_on_device.h"
#include "runtime/runtime.h"

namespace dmvv::runtime {

struct Evaluator::Impl {
  SceneOnDevice scene;
  PointProbe points;
  Renderer renderer;

  Impl(const Device::Impl& gpu, const compiler::Program& program, std::shared_ptr<const compiler::Judge> judge,
       std::unique_ptr<Rasteriser> prepared);
  Result<void> go_to(double time_ms);
};

}  // namespace dmvv::runtime
