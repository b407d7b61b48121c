#include "runtime/gpu/uploads.h"

#include <cstring>

namespace dmvv::runtime {
namespace {

using Access = vk::AccessFlagBits;
using Layout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits;

}  // namespace

GpuBuffer Uploads::stage(std::span<const std::byte> bytes) {
  GpuBuffer staging = gpu_.make_buffer(bytes.size(), vk::BufferUsageFlagBits::eTransferSrc, MemoryUse::upload);
  std::memcpy(staging.mapped, bytes.data(), bytes.size());
  staged_bytes_ += bytes.size();
  return staging;
}

void Uploads::finish_if_large() {
  constexpr std::size_t most_staged = std::size_t{16} << 20;
  if (staged_bytes_ > most_staged) finish();
}

GpuBuffer Uploads::add_buffer(std::span<const std::byte> bytes, vk::BufferUsageFlags usage) {
  GpuBuffer made = gpu_.make_buffer(bytes.size(), usage | vk::BufferUsageFlagBits::eTransferDst, MemoryUse::device);
  buffers_.push_back({stage(bytes), *made.buffer});
  finish_if_large();
  return made;
}

GpuImage Uploads::add_texture(std::span<const std::byte> texels, vk::Format format, vk::Extent3D extent) {
  GpuImage made = gpu_.make_image(vk::ImageType::e3D, format, extent,
                                  vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst);
  textures_.push_back({stage(texels), *made.image, extent});
  finish_if_large();
  return made;
}

void Uploads::finish() {
  if (buffers_.empty() && textures_.empty()) return;
  gpu_.run([&](const vk::raii::CommandBuffer& commands) {
    for (const BufferCopy& copy : buffers_) {
      commands.copyBuffer(*copy.staging.buffer, copy.target, vk::BufferCopy{0, 0, copy.staging.bytes});
    }
    for (const TextureCopy& copy : textures_) {
      commands.pipelineBarrier(
          Stage::eTopOfPipe, Stage::eTransfer, {}, nullptr, nullptr,
          color_barrier(copy.target, Layout::eUndefined, Layout::eTransferDstOptimal, {}, Access::eTransferWrite));
      commands.copyBufferToImage(
          *copy.staging.buffer, copy.target, Layout::eTransferDstOptimal,
          vk::BufferImageCopy{.imageSubresource = {.aspectMask = vk::ImageAspectFlagBits::eColor, .layerCount = 1},
                              .imageExtent = copy.extent});
      commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader, {}, nullptr, nullptr,
                               color_barrier(copy.target, Layout::eTransferDstOptimal, Layout::eShaderReadOnlyOptimal,
                                             Access::eTransferWrite, Access::eShaderRead));
    }
    const vk::MemoryBarrier visible{.srcAccessMask = Access::eTransferWrite, .dstAccessMask = Access::eShaderRead};
    commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader, {}, visible, nullptr, nullptr);
  });
  buffers_.clear();
  textures_.clear();
  staged_bytes_ = 0;
}

}  // namespace dmvv::runtime
