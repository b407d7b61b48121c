#include "runtime/gpu/uploads.h"

#include <cstring>

namespace dmvv::runtime {

GpuBuffer staging_buffer(const Device::Impl& gpu, const void* bytes, std::size_t size) {
  GpuBuffer staging = gpu.make_buffer(size, vk::BufferUsageFlagBits::eTransferSrc, MemoryUse::upload);
  std::memcpy(staging.mapped, bytes, size);
  return staging;
}

GpuBuffer upload_buffer(const Device::Impl& gpu, const void* bytes, std::size_t size, vk::BufferUsageFlags usage) {
  using Access = vk::AccessFlagBits;
  using Stage = vk::PipelineStageFlagBits;
  GpuBuffer made = gpu.make_buffer(size, usage | vk::BufferUsageFlagBits::eTransferDst, MemoryUse::device);
  const GpuBuffer staging = staging_buffer(gpu, bytes, size);
  gpu.run([&](const vk::raii::CommandBuffer& commands) {
    commands.copyBuffer(*staging.buffer, *made.buffer, vk::BufferCopy{0, 0, size});
    const vk::MemoryBarrier visible{.srcAccessMask = Access::eTransferWrite, .dstAccessMask = Access::eShaderRead};
    commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader, {}, visible, nullptr, nullptr);
  });
  return made;
}

}  // namespace dmvv::runtime
