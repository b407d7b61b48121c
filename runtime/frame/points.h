// Inside the runtime only: the scene at points.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "runtime/frame/scene_on_device.h"
#include "runtime/gpu/device.h"

namespace dmvv::runtime {

/// The kernel `points`, made when it is first asked.
class PointProbe {
 public:
  PointProbe(const Device::Impl& gpu, const SceneOnDevice& scene, const compiler::Program& program);

  /// As Evaluator::probe, at the scene's time.
  Result<std::vector<compiler::PointAnswer>> probe(std::span<const glm::dvec3> positions, Timings* timings);

 private:
  struct Batch;  ///< buffers for so many points
  Result<void> make_kernel();
  double dispatch(const Batch& batch, std::uint32_t count) const;

  const Device::Impl& gpu_;
  const SceneOnDevice& scene_;
  std::vector<std::uint32_t> code_;
  std::uint32_t depth_;
  vk::raii::DescriptorSetLayout io_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  std::optional<vk::raii::Pipeline> pipeline_;
};

}  // namespace dmvv::runtime
