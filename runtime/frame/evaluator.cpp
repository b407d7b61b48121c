// A program on a device: limits, upload, kernels; the scene at points.
#include "runtime/frame/evaluator.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include "compiler/passes/content.h"
#include "compiler/snippet/time_range.h"
#include "runtime/gpu/pipeline_cache.h"
#include "runtime/gpu/uploads.h"
#include "shaders/records.h"

namespace dmvv::runtime {
namespace {

using compiler::Kernel;
using compiler::PointAnswer;

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
  const auto fault = [&](std::uint32_t outputs, std::uint32_t most, std::string_view what, std::string_view limit) -> std::optional<Error> {
    if (outputs <= most) return std::nullopt;
    return Error{Fault::input, fmt::format("the scene needs {} {} a stage; '{}' allows {} ({})", outputs, what, gpu.info.name, most, limit), {}};
  };
  const vk::PhysicalDeviceLimits& limits = gpu.limits;
  if (auto found = fault(buffers_of_pixels + in_buffers, limits.maxPerStageDescriptorStorageBuffers, "storage buffers",
                         "maxPerStageDescriptorStorageBuffers"))
    return found;
  return fault(images_of_pixels + in_texels, limits.maxPerStageDescriptorStorageImages, "storage images",
               "maxPerStageDescriptorStorageImages");
}

std::optional<Error> program_fault(const Device::Impl& gpu, const compiler::Program& program) {
  if (auto fault = descriptors_fault(gpu, program)) return fault;
  for (const compiler::Buffer& buffer : program.buffers) {
    if (auto fault = buffer_fault(gpu, buffer)) return fault;
  }
  for (const compiler::Texture& texture : program.textures) {
    if (auto fault = texture_fault(gpu, texture)) return fault;
  }
  return std::nullopt;
}

GpuImage upload_texture(const Device::Impl& gpu, const compiler::Texture& texture) {
  using Access = vk::AccessFlagBits;
  using Layout = vk::ImageLayout;
  using Stage = vk::PipelineStageFlagBits;
  GpuImage image = gpu.make_image(vk::ImageType::e3D, vulkan_format(texture.format), vulkan_extent(texture.extent),
                                  vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst);
  const GpuBuffer staging = staging_buffer(gpu, texture.texels.data(), texture.texels.size());
  gpu.run([&](const vk::raii::CommandBuffer& commands) {
    commands.pipelineBarrier(
        Stage::eTopOfPipe, Stage::eTransfer, {}, nullptr, nullptr,
        color_barrier(image, Layout::eUndefined, Layout::eTransferDstOptimal, {}, Access::eTransferWrite));
    commands.copyBufferToImage(
        *staging.buffer, *image.image, Layout::eTransferDstOptimal,
        vk::BufferImageCopy{.imageSubresource = {.aspectMask = vk::ImageAspectFlagBits::eColor, .layerCount = 1},
                            .imageExtent = vulkan_extent(texture.extent)});
    commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader, {}, nullptr, nullptr,
                             color_barrier(image, Layout::eTransferDstOptimal, Layout::eShaderReadOnlyOptimal,
                                           Access::eTransferWrite, Access::eShaderRead));
  });
  return image;
}

/// Reads the answer that starts at `words`; empty if the device's path is longer than the program can have.
std::optional<PointAnswer> decode_answer(const std::uint32_t* words, std::uint32_t depth) {
  PointAnswer answer;
  answer.number = words[0];
  answer.finished = words[0] != DMVV_UNFINISHED;
  if (words[1] > depth) return std::nullopt;
  for (int i = 0; i < 4; ++i) answer.rgba[i] = std::bit_cast<float>(words[2 + i]);
  for (std::uint32_t level = 0; level < words[1]; ++level) {
    const std::uint32_t* step = words + DMVV_ANSWER_HEADER + 2 * level;
    answer.path.push_back({step[0], step[1]});
  }
  return answer;
}

constexpr std::array point_io{vk::DescriptorType::eStorageBuffer, vk::DescriptorType::eStorageBuffer};

}  // namespace

Evaluator::Impl::Impl(const Device::Impl& device, const compiler::Program& program, PreparedSurface prepared)
    : gpu(device), depth(program.depth), time_functions(program.time_functions), judge(program.judge),
      has_bitmaps(std::ranges::find(program.textures, std::uint32_t{DMVV_BIND_BITMAP_ATLAS}, &compiler::Texture::binding) !=
                  program.textures.end()),
      rasteriser(std::move(prepared.rasteriser_)) {
  for (std::size_t i = 0; i < code.size(); ++i) code[i] = program.spirv[i];
  stages = program.stages;
  for (compiler::Stage& stage : stages) stage.glsl.clear();
  upload(program);
  bind_scene(program);
}

void Evaluator::Impl::upload(const compiler::Program& program) {
  for (const compiler::Buffer& buffer : program.buffers) {
    if (buffer.binding == DMVV_BIND_TIME) {
      time_buffer = buffers.size();
      buffers.push_back(gpu.make_buffer(buffer.bytes.size(), vk::BufferUsageFlagBits::eStorageBuffer, MemoryUse::upload));
      continue;
    }
    using Usage = vk::BufferUsageFlagBits;
    const bool is_texels = buffer.form != compiler::BufferForm::records;
    buffers.push_back(upload_buffer(gpu, buffer.bytes.data(), buffer.bytes.size(),
                                    is_texels ? Usage::eStorageTexelBuffer : Usage::eStorageBuffer));
  }
  make_views(program);
  for (const compiler::Texture& texture : program.textures) textures.push_back(upload_texture(gpu, texture));
  using Mode = vk::SamplerAddressMode;
  sampler = gpu.device.createSampler({.magFilter = vk::Filter::eLinear,
                                      .minFilter = vk::Filter::eLinear,
                                      .addressModeU = Mode::eClampToEdge,
                                      .addressModeV = Mode::eClampToEdge,
                                      .addressModeW = Mode::eClampToEdge});
}

void Evaluator::Impl::make_views(const compiler::Program& program) {
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    views.emplace_back(nullptr);
    const vk::Format format = vulkan_format(program.buffers[i].form);
    if (format == vk::Format::eUndefined) continue;
    views.back() = gpu.device.createBufferView({.buffer = *buffers[i].buffer, .format = format, .range = VK_WHOLE_SIZE});
  }
}

std::optional<Error> time_fault(double time_ms) {
  if (std::abs(time_ms) <= compiler::any_time_ms) return std::nullopt;
  return Error{Fault::input,
               fmt::format("the time {} ms is out of range", time_ms),
               {fmt::format("use one between -{0} and {0} ms", compiler::any_time_ms)}};
}

/// Every submission is waited for, so nothing reads the values while they change.
void Evaluator::Impl::set_time(double time_ms) {
  now_ms = time_ms;
  if (!time_buffer) return;
  time_values = compiler::time_values(time_functions, time_ms);
  std::memcpy(buffers[*time_buffer].mapped, time_values.data(), time_values.size() * sizeof(float));
}

void Evaluator::Impl::bind_scene(const compiler::Program& program) {
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  std::vector<vk::DescriptorType> types;
  const auto add = [&](std::uint32_t binding, vk::DescriptorType type) {
    bindings.push_back({.binding = binding,
                        .descriptorType = type,
                        .descriptorCount = 1,
                        .stageFlags = vk::ShaderStageFlagBits::eCompute});
    types.push_back(type);
  };
  for (const compiler::Buffer& buffer : program.buffers) add(buffer.binding, descriptor_type(buffer.form));
  for (const compiler::Texture& texture : program.textures)
    add(texture.binding, vk::DescriptorType::eCombinedImageSampler);
  scene_layout = gpu.device.createDescriptorSetLayout(vk::DescriptorSetLayoutCreateInfo{}.setBindings(bindings));
  if (types.empty()) types.push_back(vk::DescriptorType::eStorageBuffer);  // a pool must hold something
  scene_pool = make_pool(types);
  scene_set = make_set(scene_pool, scene_layout);
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const vk::DescriptorBufferInfo info{*buffers[i].buffer, 0, VK_WHOLE_SIZE};
    const vk::BufferView view = *views[i];  // the one of the two that the type asks for is read
    gpu.device.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *scene_set,
                                                           .dstBinding = program.buffers[i].binding,
                                                           .descriptorCount = 1,
                                                           .descriptorType = descriptor_type(program.buffers[i].form),
                                                           .pBufferInfo = &info,
                                                           .pTexelBufferView = &view},
                                    nullptr);
  }
  for (std::size_t i = 0; i < textures.size(); ++i) {
    const vk::DescriptorImageInfo info{*sampler, *textures[i].view, vk::ImageLayout::eShaderReadOnlyOptimal};
    gpu.device.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *scene_set,
                                                           .dstBinding = program.textures[i].binding,
                                                           .descriptorCount = 1,
                                                           .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                                                           .pImageInfo = &info},
                                    nullptr);
  }
}

vk::raii::DescriptorPool Evaluator::Impl::make_pool(std::span<const vk::DescriptorType> types) const {
  std::vector<vk::DescriptorPoolSize> sizes;
  for (const vk::DescriptorType type : types) sizes.push_back({type, 1});
  return gpu.device.createDescriptorPool(
      vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, .maxSets = 1}
          .setPoolSizes(sizes));
}

vk::raii::DescriptorSet Evaluator::Impl::make_set(const vk::raii::DescriptorPool& pool,
                                                  const vk::raii::DescriptorSetLayout& layout) const {
  const vk::DescriptorSetLayout handle = *layout;
  return std::move(
      gpu.device.allocateDescriptorSets({.descriptorPool = *pool, .descriptorSetCount = 1, .pSetLayouts = &handle})[0]);
}

Result<KernelPipeline> Evaluator::Impl::make_kernel(Kernel kernel, std::span<const vk::DescriptorType> io,
                                                    std::uint32_t params_bytes,
                                                    std::span<const vk::Bool32> constants) const {
  return make_kernel(code[static_cast<std::size_t>(kernel)], kernel == Kernel::points ? "points" : "pixels", io, params_bytes, constants);
}

Result<KernelPipeline> Evaluator::Impl::make_kernel(std::span<const std::uint32_t> words, std::string_view name,
                                                    std::span<const vk::DescriptorType> io, std::uint32_t params_bytes,
                                                    std::span<const vk::Bool32> constants) const {
  if (words.empty()) return fail(Fault::environment, fmt::format("the program was compiled without its kernel '{}'", name));
  return make_pipeline(words, io, params_bytes, constants);
}

KernelPipeline Evaluator::Impl::make_pipeline(std::span<const std::uint32_t> words,
                                              std::span<const vk::DescriptorType> io, std::uint32_t params_bytes,
                                              std::span<const vk::Bool32> constants,
                                              const vk::raii::DescriptorSetLayout* verdict_layout) const {
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (std::uint32_t i = 0; i < io.size(); ++i) {
    bindings.push_back(
        {.binding = i, .descriptorType = io[i], .descriptorCount = 1, .stageFlags = vk::ShaderStageFlagBits::eCompute});
  }
  KernelPipeline made;
  made.io_layout = gpu.device.createDescriptorSetLayout(vk::DescriptorSetLayoutCreateInfo{}.setBindings(bindings));
  std::vector<vk::DescriptorSetLayout> layouts{*scene_layout, *made.io_layout};
  if (verdict_layout != nullptr) layouts.push_back(**verdict_layout);
  const vk::PushConstantRange params{vk::ShaderStageFlagBits::eCompute, 0, params_bytes};
  made.layout = gpu.device.createPipelineLayout(
      vk::PipelineLayoutCreateInfo{}.setSetLayouts(layouts).setPushConstantRanges(params));
  const vk::raii::ShaderModule module = gpu.make_shader(words.data(), words.size());
  std::vector<vk::SpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, 4 * i, sizeof(vk::Bool32)});
  const auto specialization = vk::SpecializationInfo{}.setMapEntries(entries).setData<vk::Bool32>(constants);
  const PipelineCache cache(gpu, words);
  made.pipeline = gpu.device.createComputePipeline(
      cache.handle(), {.stage = {.stage = vk::ShaderStageFlagBits::eCompute,
                                 .module = *module,
                                 .pName = "main",
                                 .pSpecializationInfo = &specialization},
                       .layout = *made.layout});
  cache.save();
  return made;
}

Result<std::vector<PointAnswer>> Evaluator::Impl::probe(std::span<const glm::dvec3> positions, double time_ms,
                                                                Timings* timings) {
  if (auto refused = time_fault(time_ms)) return tl::unexpected(std::move(*refused));
  set_time(time_ms);
  // ---- buffers for one batch; both are read and written in place ----
  constexpr std::size_t answer_budget = std::size_t{32} << 20;
  constexpr std::size_t largest_batch = std::size_t{1} << 18;
  const std::size_t stride = DMVV_ANSWER_HEADER + 2 * std::size_t{depth};
  const std::size_t batch = std::min({largest_batch, std::max<std::size_t>(1, answer_budget / (4 * stride)),
                                      std::max<std::size_t>(1, positions.size())});
  const auto storage = vk::BufferUsageFlagBits::eStorageBuffer;
  const GpuBuffer inputs = gpu.make_buffer(batch * sizeof(glm::vec4), storage, MemoryUse::upload);
  const GpuBuffer outputs = gpu.make_buffer(batch * stride * 4, storage, MemoryUse::readback);
  const auto pool = make_pool(point_io);

  std::optional<vk::raii::DescriptorSet> io_set;
  const auto dispatch = [&](std::uint32_t count) {
    return gpu.run([&](const vk::raii::CommandBuffer& commands) {
      const auto compute = vk::PipelineBindPoint::eCompute;
      const gpu::PointsParams params{.count = count, .pad0 = 0, .pad1 = 0, .pad2 = 0};
      commands.bindPipeline(compute, *points->pipeline);
      commands.bindDescriptorSets(compute, *points->layout, 0, {*scene_set, **io_set}, nullptr);
      commands.pushConstants<gpu::PointsParams>(*points->layout, vk::ShaderStageFlagBits::eCompute, 0, params);
      commands.dispatch(std::max(1u, (count + DMVV_POINTS_GROUP_SIZE - 1) / DMVV_POINTS_GROUP_SIZE), 1, 1);
      const vk::MemoryBarrier visible{.srcAccessMask = vk::AccessFlagBits::eShaderWrite,
                                      .dstAccessMask = vk::AccessFlagBits::eHostRead};
      commands.pipelineBarrier(vk::PipelineStageFlagBits::eComputeShader, vk::PipelineStageFlagBits::eHost, {}, visible,
                               nullptr, nullptr);
    });
  };

  // ---- the kernel, compiled by the driver in an empty dispatch ----
  const bool first_use = !points;
  {
    const Stopwatch watch(first_use ? timings : nullptr, "pipeline");
    if (first_use) {
      auto made = make_kernel(Kernel::points, point_io, sizeof(gpu::PointsParams));
      if (!made) return tl::unexpected(std::move(made.error()));
      points = std::move(*made);
    }
    io_set = make_set(pool, points->io_layout);
    const std::array infos{vk::DescriptorBufferInfo{*inputs.buffer, 0, VK_WHOLE_SIZE},
                           vk::DescriptorBufferInfo{*outputs.buffer, 0, VK_WHOLE_SIZE}};
    gpu.device.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = **io_set,
                                                           .dstBinding = 0,
                                                           .descriptorCount = infos.size(),
                                                           .descriptorType = point_io[0],
                                                           .pBufferInfo = infos.data()},
                                    nullptr);
    if (first_use) dispatch(0);
  }

  // ---- batch after batch ----
  const Stopwatch watch(timings, "probe");
  std::vector<PointAnswer> answers;
  answers.reserve(positions.size());
  std::vector<std::size_t> unfinished;
  double gpu_ms = 0.0;
  for (std::size_t begin = 0; begin < positions.size(); begin += batch) {
    const std::size_t count = std::min(batch, positions.size() - begin);
    auto* texels = static_cast<glm::vec4*>(inputs.mapped);
    for (std::size_t i = 0; i < count; ++i) texels[i] = glm::vec4(glm::vec3(positions[begin + i]), 1.0f);
    gpu_ms += dispatch(static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
      auto answer = decode_answer(static_cast<const std::uint32_t*>(outputs.mapped) + i * stride, depth);
      if (!answer)
        return fail(Fault::environment, fmt::format("the device's answer for point {} makes no sense", begin + i));
      if (!answer->finished) unfinished.push_back(begin + i);
      answers.push_back(std::move(*answer));
    }
  }
  if (timings != nullptr && gpu.timer_bits != 0) timings->push_back({gpu_step, gpu_ms});
  if (!unfinished.empty()) {
    return fail(
        Fault::input,
        fmt::format("{} of {} points needed more loop rounds than this device grants (65,535); the first is point {}",
                    unfinished.size(), positions.size(), unfinished.front()),
        {"use the reference backend, or split the scene's longest lists of seeds"});
  }
  return answers;
}

Evaluator::Evaluator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Evaluator::Evaluator(Evaluator&&) noexcept = default;
Evaluator& Evaluator::operator=(Evaluator&&) noexcept = default;
Evaluator::~Evaluator() = default;

Result<Evaluator> Evaluator::create(Device& device, const compiler::Program& program, Timings* timings, PreparedSurface prepared) {
  return guarded("uploading the scene", [&]() -> Result<Evaluator> {
    if (auto fault = program_fault(device.impl(), program)) return tl::unexpected(std::move(*fault));
    const Stopwatch watch(timings, "upload");
    return Evaluator(std::make_unique<Impl>(device.impl(), program, std::move(prepared)));
  });
}

Result<std::vector<PointAnswer>> Evaluator::probe(std::span<const glm::dvec3> points, double time_ms, Timings* timings) {
  return guarded("evaluating points", [&] { return impl_->probe(points, time_ms, timings); });
}

Result<Picture> Evaluator::render(const View& view, Timings* timings) {
  return guarded("rendering", [&] { return impl_->render(view, timings); });
}

}  // namespace dmvv::runtime
