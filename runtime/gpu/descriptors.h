// Inside the runtime only: one way to make descriptor sets and compute pipelines.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/gpu/gpu.h"

namespace dmvv::runtime {

/// A binding of a descriptor set, as compute shaders see it.
struct SetBinding {
  std::uint32_t number;
  vk::DescriptorType type;
};

vk::raii::DescriptorSetLayout make_set_layout(const Device::Impl& gpu, std::span<const SetBinding> bindings);

/// A descriptor set with a pool of its own. What is written must stay until the last commands that use it are done.
class DescriptorSet {
 public:
  DescriptorSet() = default;
  DescriptorSet(const Device::Impl& gpu, const vk::raii::DescriptorSetLayout& layout,
                std::span<const SetBinding> bindings);

  vk::DescriptorSet operator*() const { return *set_; }

  void write(std::uint32_t binding, const GpuBuffer& buffer);
  void write(std::uint32_t binding, const vk::raii::BufferView& texels);
  /// A storage image, in the layout GENERAL.
  void write(std::uint32_t binding, const GpuImage& image);
  /// A texture, ready to be read.
  void write(std::uint32_t binding, const GpuImage& image, const vk::raii::Sampler& sampler);

 private:
  vk::DescriptorType type_of(std::uint32_t binding) const;
  void update(vk::WriteDescriptorSet write, std::uint32_t binding);

  const Device::Impl* gpu_ = nullptr;
  std::vector<SetBinding> bindings_;
  vk::raii::DescriptorPool pool_{nullptr};
  vk::raii::DescriptorSet set_{nullptr};
};

/// A layout of these sets with push constants of so many bytes; 0: without.
vk::raii::PipelineLayout make_pipeline_layout(const Device::Impl& gpu, std::span<const vk::DescriptorSetLayout> sets,
                                              std::uint32_t push_bytes);

/// A compute pipeline of a shader whose specialisation constants 0, 1, ... have these values. Drivers that give their
/// pipelines away find them in the device's cache.
vk::raii::Pipeline make_compute_pipeline(const Device::Impl& gpu, std::span<const std::uint32_t> spirv,
                                         const vk::raii::PipelineLayout& layout,
                                         std::span<const std::uint32_t> constants = {});

}  // namespace dmvv::runtime
