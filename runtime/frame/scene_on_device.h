// Inside the runtime only: a program's buffers and textures on a device, and what depends on time among them.
#pragma once

#include <optional>
#include <vector>

#include "compiler/program.h"
#include "runtime/gpu/descriptors.h"

namespace dmvv::runtime {

/// Descriptor set 0 of every kernel.
class SceneOnDevice {
 public:
  /// Why the program does not fit the device: it names the limit and both numbers. Nothing if it fits.
  static std::optional<Error> fault(const Device::Impl& gpu, const compiler::Program& program);

  /// Uploads in one submission. Cost: that of copying the program's bytes twice.
  SceneOnDevice(const Device::Impl& gpu, const compiler::Program& program);

  const vk::raii::DescriptorSetLayout& layout() const { return layout_; }
  vk::DescriptorSet set() const { return *set_; }
  bool has_bitmaps() const { return has_bitmaps_; }

  /// Writes what depends on time alone. Nothing that reads it may be under way.
  /// Errors (input): a time beyond compiler::any_time_ms.
  Result<void> set_time(double time_ms);
  double now_ms() const { return now_ms_; }
  const std::vector<float>& time_values() const { return time_values_; }

 private:
  void upload(const Device::Impl& gpu, const compiler::Program& program);
  void bind(const Device::Impl& gpu, const compiler::Program& program);

  std::vector<GpuBuffer> buffers_;
  std::vector<vk::raii::BufferView> views_;  ///< of each of them; null for those that are no texels
  std::vector<GpuImage> textures_;
  vk::raii::Sampler sampler_{nullptr};
  vk::raii::DescriptorSetLayout layout_{nullptr};
  DescriptorSet set_;
  bool has_bitmaps_ = false;

  std::vector<compiler::snippet::TimeSlot> time_slots_;
  std::optional<std::size_t> time_buffer_;  ///< index into buffers_: mapped
  double now_ms_ = 0.0;
  std::vector<float> time_values_;
};

}  // namespace dmvv::runtime
