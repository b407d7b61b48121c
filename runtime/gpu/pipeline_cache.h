// Inside the runtime only: pipelines of one shader, kept between runs.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/gpu/gpu.h"

namespace dmvv::runtime {

/// A VkPipelineCache that starts with what the disk cache has for this device, driver and shader, and gives it back
/// what is new. Lavapipe's holds nothing (Mesa keeps its code itself, under the user's cache folder).
class PipelineCache {
 public:
  PipelineCache(const Device::Impl& gpu, std::span<const std::uint32_t> spirv);
  /// For vkCreate*Pipelines.
  const vk::raii::PipelineCache& handle() const { return cache_; }
  /// To be called when the pipelines are made.
  void save() const;

 private:
  const Device::Impl& gpu_;
  std::string key_;
  std::string known_;
  vk::raii::PipelineCache cache_{nullptr};
};

}  // namespace dmvv::runtime
