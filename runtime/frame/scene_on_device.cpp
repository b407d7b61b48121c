#include "runtime/frame/scene_on_device.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "compiler/layout/scene_buffers.h"
#include "compiler/snippet/time_range.h"
#include "runtime/gpu/uploads.h"
#include "shaders/records.h"

namespace dmvv::runtime {
namespace {

vk::Format vulkan_format(compiler::TexelFormat format) {
  switch (format) {
    case compiler::TexelFormat::r32f:
      return vk::Format::eR32Sfloat;
    case compiler::TexelFormat::r16f:
      return vk::Format::eR16Sfloat;
    case compiler::TexelFormat::snorm16:
      return vk::Format::eR16Snorm;
    case compiler::TexelFormat::snorm8:
      return vk::Format::eR8Snorm;
    case compiler::TexelFormat::unorm8:
      return vk::Format::eR8Unorm;
    case compiler::TexelFormat::rgba16f:
      return vk::Format::eR16G16B16A16Sfloat;
  }
  return vk::Format::eUndefined;
}

/// Undefined for a storage buffer.
vk::Format vulkan_format(compiler::BufferForm form) {
  switch (form) {
    case compiler::BufferForm::records:
      return vk::Format::eUndefined;
    case compiler::BufferForm::r32ui:
      return vk::Format::eR32Uint;
    case compiler::BufferForm::rg32ui:
      return vk::Format::eR32G32Uint;
    case compiler::BufferForm::rgba32ui:
      return vk::Format::eR32G32B32A32Uint;
  }
  return vk::Format::eUndefined;
}

vk::DescriptorType descriptor_type(compiler::BufferForm form) {
  return form == compiler::BufferForm::records ? vk::DescriptorType::eStorageBuffer
                                               : vk::DescriptorType::eStorageTexelBuffer;
}

vk::Extent3D vulkan_extent(const glm::uvec3& extent) { return {extent.x, extent.y, extent.z}; }

std::optional<Error> texels_fault(const Device::Impl& gpu, const compiler::Buffer& buffer) {
  const std::size_t texels = buffer.bytes.size() / compiler::bytes_per_texel(buffer.form);
  if (texels <= gpu.info.max_texel_buffer_elements) return std::nullopt;
  return Error{Fault::input,
               fmt::format("the scene's buffer '{}' needs {} texels; '{}' allows {} (maxTexelBufferElements)",
                           buffer.name, texels, gpu.info.name, gpu.info.max_texel_buffer_elements),
               {"compile it without the pass texel-records"}};
}

std::optional<Error> buffer_fault(const Device::Impl& gpu, const compiler::Buffer& buffer) {
  if (buffer.form != compiler::BufferForm::records) return texels_fault(gpu, buffer);
  if (buffer.bytes.size() <= gpu.limits.maxStorageBufferRange) return std::nullopt;
  return Error{Fault::input,
               fmt::format("the scene's buffer '{}' needs {} bytes; '{}' allows {} (maxStorageBufferRange)",
                           buffer.name, buffer.bytes.size(), gpu.info.name, gpu.limits.maxStorageBufferRange),
               {}};
}

std::optional<Error> texture_fault(const Device::Impl& gpu, const compiler::Texture& texture) {
  assert(texture.texels.size() == std::size_t{texture.extent.x} * texture.extent.y * texture.extent.z *
                                      compiler::bytes_per_texel(texture.format));
  const std::uint32_t longest = std::max({texture.extent.x, texture.extent.y, texture.extent.z});
  if (longest > gpu.limits.maxImageDimension3D) {
    return Error{Fault::input,
                 fmt::format("the scene's texture '{}' is {} texels long; '{}' allows {} (maxImageDimension3D)",
                             texture.name, longest, gpu.info.name, gpu.limits.maxImageDimension3D),
                 {}};
  }
  const vk::Format format = vulkan_format(texture.format);
  using Feature = vk::FormatFeatureFlagBits;
  const vk::FormatFeatureFlags there = gpu.physical.getFormatProperties(format).optimalTilingFeatures;
  const vk::FormatFeatureFlags read = Feature::eSampledImage | Feature::eTransferDst;
  const auto lacks = [&](const char* what, const char* way_out) {
    return Error{Fault::input,
                 fmt::format("the scene's texture '{}' has the format {}, which '{}' does not {}", texture.name,
                             vk::to_string(format), gpu.info.name, what),
                 {way_out}};
  };
  if ((there & read) != read) return lacks("read", "choose another format for the atlas");
  if (texture.filtered && !(there & Feature::eSampledImageFilterLinear)) {
    return lacks("filter", "choose another format for the atlas, or let the shader filter");
  }
  const auto image = gpu.physical.getImageFormatProperties(
      format, vk::ImageType::e3D, vk::ImageTiling::eOptimal,
      vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst, {});
  if (texture.texels.size() > image.maxResourceSize) {
    return Error{Fault::input,
                 fmt::format("the scene's texture '{}' needs {} bytes; '{}' allows {} (maxResourceSize)", texture.name,
                             texture.texels.size(), gpu.info.name, image.maxResourceSize),
                 {}};
  }
  return std::nullopt;
}

/// Of all kernels those over pixels have the most descriptors.
std::optional<Error> descriptors_fault(const Device::Impl& gpu, const compiler::Program& program) {
  const auto in_buffers = static_cast<std::uint32_t>(
      std::ranges::count(program.buffers, compiler::BufferForm::records, &compiler::Buffer::form));
  const std::uint32_t in_texels = static_cast<std::uint32_t>(program.buffers.size()) - in_buffers;
  const auto fault = [&](std::uint32_t outputs, std::uint32_t most, std::string_view what,
                         std::string_view limit) -> std::optional<Error> {
    if (outputs <= most) return std::nullopt;
    return Error{
        Fault::input,
        fmt::format("the scene needs {} {} a stage; '{}' allows {} ({})", outputs, what, gpu.info.name, most, limit),
        {}};
  };
  const vk::PhysicalDeviceLimits& limits = gpu.limits;
  if (auto found = fault(buffers_of_pixels + in_buffers, limits.maxPerStageDescriptorStorageBuffers, "storage buffers",
                         "maxPerStageDescriptorStorageBuffers"))
    return found;
  return fault(images_of_pixels + in_texels, limits.maxPerStageDescriptorStorageImages, "storage images",
               "maxPerStageDescriptorStorageImages");
}

}  // namespace

std::optional<Error> SceneOnDevice::fault(const Device::Impl& gpu, const compiler::Program& program) {
  if (auto fault = descriptors_fault(gpu, program)) return fault;
  for (const compiler::Buffer& buffer : program.buffers) {
    if (auto fault = buffer_fault(gpu, buffer)) return fault;
  }
  for (const compiler::Texture& texture : program.textures) {
    if (auto fault = texture_fault(gpu, texture)) return fault;
  }
  return std::nullopt;
}

SceneOnDevice::SceneOnDevice(const Device::Impl& gpu, const compiler::Program& program)
    : has_bitmaps_(std::ranges::find(program.textures, std::uint32_t{DMVV_BIND_BITMAP_ATLAS},
                                     &compiler::Texture::binding) != program.textures.end()),
      time_slots_(program.time_slots) {
  upload(gpu, program);
  bind(gpu, program);
}

void SceneOnDevice::upload(const Device::Impl& gpu, const compiler::Program& program) {
  using Usage = vk::BufferUsageFlagBits;
  Uploads uploads(gpu);
  for (const compiler::Buffer& buffer : program.buffers) {
    if (buffer.binding == compiler::scene_binding::time_values) {
      time_buffer_ = buffers_.size();
      buffers_.push_back(gpu.make_buffer(buffer.bytes.size(), Usage::eStorageBuffer, MemoryUse::upload));
      continue;
    }
    const bool is_texels = buffer.form != compiler::BufferForm::records;
    buffers_.push_back(
        uploads.add_buffer(buffer.bytes, is_texels ? Usage::eStorageTexelBuffer : Usage::eStorageBuffer));
  }
  for (const compiler::Texture& texture : program.textures) {
    textures_.push_back(
        uploads.add_texture(texture.texels, vulkan_format(texture.format), vulkan_extent(texture.extent)));
  }
  uploads.finish();
  for (std::size_t i = 0; i < buffers_.size(); ++i) {
    const vk::Format format = vulkan_format(program.buffers[i].form);
    views_.emplace_back(nullptr);
    if (format == vk::Format::eUndefined) continue;
    views_.back() =
        gpu.device.createBufferView({.buffer = *buffers_[i].buffer, .format = format, .range = VK_WHOLE_SIZE});
  }
  using Mode = vk::SamplerAddressMode;
  sampler_ = gpu.device.createSampler({.magFilter = vk::Filter::eLinear,
                                       .minFilter = vk::Filter::eLinear,
                                       .addressModeU = Mode::eClampToEdge,
                                       .addressModeV = Mode::eClampToEdge,
                                       .addressModeW = Mode::eClampToEdge});
}

void SceneOnDevice::bind(const Device::Impl& gpu, const compiler::Program& program) {
  std::vector<SetBinding> bindings;
  for (const compiler::Buffer& buffer : program.buffers)
    bindings.push_back({buffer.binding, descriptor_type(buffer.form)});
  for (const compiler::Texture& texture : program.textures) {
    bindings.push_back({texture.binding, vk::DescriptorType::eCombinedImageSampler});
  }
  layout_ = make_set_layout(gpu, bindings);
  set_ = DescriptorSet(gpu, layout_, bindings);
  for (std::size_t i = 0; i < buffers_.size(); ++i) {
    const compiler::Buffer& buffer = program.buffers[i];
    if (buffer.form == compiler::BufferForm::records)
      set_.write(buffer.binding, buffers_[i]);
    else
      set_.write(buffer.binding, views_[i]);
  }
  for (std::size_t i = 0; i < textures_.size(); ++i) set_.write(program.textures[i].binding, textures_[i], sampler_);
}

Result<void> SceneOnDevice::set_time(double time_ms) {
  if (!(std::abs(time_ms) <= compiler::any_time_ms)) {
    return fail(Fault::input, fmt::format("the time {} ms is out of range", time_ms),
                {fmt::format("use one between -{0} and {0} ms", compiler::any_time_ms)});
  }
  now_ms_ = time_ms;
  if (!time_buffer_) return {};
  time_values_ = compiler::snippet::time_values(time_slots_, time_ms);
  std::memcpy(buffers_[*time_buffer_].mapped, time_values_.data(), time_values_.size() * sizeof(float));
  return {};
}

}  // namespace dmvv::runtime
