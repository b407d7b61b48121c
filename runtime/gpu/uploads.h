// Inside the runtime only: bytes to the device.
#pragma once

#include <span>
#include <vector>

#include "runtime/gpu/gpu.h"

namespace dmvv::runtime {

/// Buffers and textures whose contents go to the device together: in one submission, unless they are large. What waits
/// on the host for its copy takes 16 MiB and one buffer or texture at most: fresh memory costs more than a submission.
class Uploads {
 public:
  explicit Uploads(const Device::Impl& gpu) : gpu_(gpu) {}

  /// A buffer of device memory that will hold these bytes. They are copied at once and need not stay.
  GpuBuffer add_buffer(std::span<const std::byte> bytes, vk::BufferUsageFlags usage);
  /// A 3D texture of device memory, likewise; ready to be read by compute shaders once it is there.
  GpuImage add_texture(std::span<const std::byte> texels, vk::Format format, vk::Extent3D extent);

  /// Submits the copies that are left and waits for them.
  void finish();

 private:
  struct BufferCopy {
    GpuBuffer staging;
    vk::Buffer target;
  };
  struct TextureCopy {
    GpuBuffer staging;
    vk::Image target;
    vk::Extent3D extent;
  };
  GpuBuffer stage(std::span<const std::byte> bytes);
  void finish_if_large();

  const Device::Impl& gpu_;
  std::vector<BufferCopy> buffers_;
  std::vector<TextureCopy> textures_;
  std::size_t staged_bytes_ = 0;
};

}  // namespace dmvv::runtime
