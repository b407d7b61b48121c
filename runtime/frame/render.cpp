// One picture: tile by tile the surface is drawn (or a slice's points are uploaded), evaluated and read back.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <limits>

#include "compiler/snippet/time_range.h"
#include "runtime/frame/evaluator.h"
#include "spirv/classify_comp.h"
#include "spirv/count_groups_comp.h"
#include "spirv/count_hits_comp.h"
#include "spirv/count_stages_comp.h"
#include "spirv/distribute_comp.h"
#include "spirv/follow_comp.h"
#include "spirv/list_comp.h"
#include "spirv/paint_bitmaps_comp.h"
#include "spirv/paint_comp.h"

namespace dmvv::runtime {
namespace {

using Access = vk::AccessFlagBits;
using Layout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits;

constexpr auto storage_image = vk::DescriptorType::eStorageImage;
constexpr std::array pixel_io{storage_image, storage_image, storage_image, storage_image, vk::DescriptorType::eStorageBuffer,
                              storage_image, storage_image, storage_image, vk::DescriptorType::eStorageBuffer,
                              vk::DescriptorType::eStorageBuffer, vk::DescriptorType::eStorageBuffer};

constexpr vk::ImageSubresourceLayers color_layer{vk::ImageAspectFlagBits::eColor, 0, 0, 1};
constexpr vk::ImageSubresourceRange color_range{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};

vk::BufferImageCopy tile_copy(vk::DeviceSize offset, glm::uvec2 size_px) {
  return {.bufferOffset = offset, .imageSubresource = color_layer, .imageExtent = {size_px.x, size_px.y, 1}};
}

/// Where the parts of a tile stand in the buffer that is read back: each at a multiple of its texels, the largest first.
struct ReadbackLayout {
  vk::DeviceSize positions = 0, colors, regions, header, bytes;

  ReadbackLayout(std::size_t pixels, const Outputs& outputs)
      : colors(outputs.positions ? 16 * pixels : 0),
        regions(colors + (outputs.colors == Colors::bytes ? 4 : 16) * pixels),
        header(regions + (outputs.regions ? 4 * pixels : 0)),
        bytes(header + sizeof(gpu::PixelListHeader)) {}
};

std::uint32_t evaluated_pixels(const gpu::PixelListHeader& counted, bool with_leaders) {
  const auto& counts = counted.counts;
  return with_leaders ? counts[DMVV_LEADERS_OF_TILES] + counts[DMVV_LEFT] : counts[DMVV_TO_EVALUATE];
}

std::size_t pixels_of(const Tile& tile) { return std::size_t{tile.size_px.x} * tile.size_px.y; }

/// What came back of a tile; null what is not wanted.
struct TilePixels {
  const glm::vec4* colors;
  const std::uint32_t* bytes;
  const glm::uvec4* surface;
  const std::uint32_t* regions;
  gpu::PixelListHeader counted;
};

TilePixels tile_pixels(const FrameImages& frame, const Tile& tile) {
  const ReadbackLayout layout(pixels_of(tile), frame.outputs);
  const auto* mapped = static_cast<const std::byte*>(frame.readback.mapped);
  const bool as_bytes = frame.outputs.colors == Colors::bytes;
  return {as_bytes ? nullptr : reinterpret_cast<const glm::vec4*>(mapped + layout.colors),
          as_bytes ? reinterpret_cast<const std::uint32_t*>(mapped + layout.colors) : nullptr,
          frame.outputs.positions ? reinterpret_cast<const glm::uvec4*>(mapped + layout.positions) : nullptr,
          frame.outputs.regions ? reinterpret_cast<const std::uint32_t*>(mapped + layout.regions) : nullptr,
          *reinterpret_cast<const gpu::PixelListHeader*>(mapped + layout.header)};
}

/// Straight colour of the mean of samples^2 premultiplied colours. `first` is sample (0, 0), rows are `pitch` apart.
glm::vec4 mean_color(const glm::vec4* first, std::size_t pitch, std::uint32_t samples) {
  if (samples == 1) return *first;
  glm::vec3 premultiplied(0.0f);
  float alpha = 0.0f;
  for (std::uint32_t y = 0; y < samples; ++y) {
    for (std::uint32_t x = 0; x < samples; ++x) {
      const glm::vec4& color = first[y * pitch + x];
      premultiplied += glm::vec3(color) * color.a;
      alpha += color.a;
    }
  }
  const float count = static_cast<float>(samples * samples);
  return alpha > 0.0f ? glm::vec4(premultiplied / alpha, alpha / count) : glm::vec4(0.0f);
}

bool is_surface(const glm::uvec4& texel) { return texel.w != 0; }

float depth_of(const FrameSetup& setup, std::uint32_t region, const glm::uvec4& texel) {
  if (region == 0) return std::numeric_limits<float>::infinity();
  if (setup.slice) return 0.0f;
  return static_cast<float>(glm::dot(setup.forward, glm::dvec3(glm::uintBitsToFloat(glm::uvec3(texel))) - setup.eye));
}

/// The point that the kernel evaluates (shaders/pixels.comp).
glm::vec3 position_of(const FrameSetup& setup, const glm::uvec4& texel) {
  if (!is_surface(texel)) return glm::vec3(std::numeric_limits<float>::quiet_NaN());
  return glm::clamp(glm::uintBitsToFloat(glm::uvec3(texel)), glm::vec3(setup.pixels.bounds_lo),
                    glm::vec3(setup.pixels.bounds_hi));
}

Picture empty_picture(const View& view) {
  Picture picture;
  picture.size_px = view.size_px;
  const std::size_t pixels = std::size_t{view.size_px.x} * view.size_px.y;
  (view.colors == Colors::bytes ? picture.rgba8.resize(4 * pixels) : picture.rgba.resize(4 * pixels));
  if (view.want_regions) picture.regions.resize(pixels);
  if (view.want_depth) picture.depth.resize(pixels, std::numeric_limits<float>::infinity());
  if (view.want_positions) picture.positions.resize(pixels, glm::vec3(std::numeric_limits<float>::quiet_NaN()));
  return picture;
}

void put_color(const glm::vec4& color, std::size_t pixel, Picture& picture) {
  for (int channel = 0; channel < 4; ++channel) {
    if (picture.rgba.empty()) {
      picture.rgba8[4 * pixel + static_cast<std::size_t>(channel)] = to_byte(color[channel]);
    } else {
      picture.rgba[4 * pixel + static_cast<std::size_t>(channel)] = color[channel];
    }
  }
}

/// Puts a tile into the picture.
void resolve_tile(const TilePixels& from, const Tile& tile, const FrameSetup& setup, std::uint32_t samples, Picture& picture) {
  const std::size_t pitch = tile.size_px.x;
  const glm::uvec2 corner = tile.corner_px / samples, size = tile.size_px / samples;
  for (std::uint32_t y = 0; y < size.y; ++y) {
    const std::size_t row = std::size_t{corner.y + y} * picture.size_px.x + corner.x;
    if (from.bytes != nullptr) {  // one sample a pixel, channels in the order of the bytes
      std::memcpy(&picture.rgba8[4 * row], from.bytes + y * pitch, 4 * std::size_t{size.x});
    }
    if (from.bytes != nullptr && from.regions == nullptr && from.surface == nullptr) continue;
    for (std::uint32_t x = 0; x < size.x; ++x) {
      const std::size_t source = y * samples * pitch + x * samples;
      const std::size_t pixel = row + x;
      if (from.colors != nullptr) put_color(mean_color(from.colors + source, pitch, samples), pixel, picture);
      if (!picture.regions.empty()) picture.regions[pixel] = from.regions[source];
      if (!picture.depth.empty()) picture.depth[pixel] = depth_of(setup, from.regions[source], from.surface[source]);
      if (!picture.positions.empty()) picture.positions[pixel] = position_of(setup, from.surface[source]);
    }
  }
}

/// Where `kept`, what was read back last stays in it.
vk::ImageMemoryBarrier begin_writing(const GpuImage& image, bool kept) {
  return color_barrier(image, kept ? Layout::eTransferSrcOptimal : Layout::eUndefined, Layout::eGeneral,
                       kept ? Access::eTransferRead : vk::AccessFlags{}, Access::eShaderWrite | Access::eTransferWrite);
}

/// Uploads a slice's surface in place of a drawn one.
void draw_slice(const vk::raii::CommandBuffer& commands, const FrameImages& frame, const GpuImage& surface, const FrameSetup& setup,
                const Tile& tile) {
  fill_slice_surface(*setup.slice, tile.corner_px, tile.size_px, static_cast<glm::uvec4*>(frame.slice_surface.mapped));
  commands.pipelineBarrier(
      Stage::eTopOfPipe, Stage::eTransfer, {}, nullptr, nullptr,
      color_barrier(surface, Layout::eUndefined, Layout::eTransferDstOptimal, {}, Access::eTransferWrite));
  commands.copyBufferToImage(*frame.slice_surface.buffer, *surface.image, Layout::eTransferDstOptimal,
                             tile_copy(0, tile.size_px));
  commands.pipelineBarrier(
      Stage::eTransfer, Stage::eComputeShader, {}, nullptr, nullptr,
      color_barrier(surface, Layout::eTransferDstOptimal, Layout::eGeneral, Access::eTransferWrite, Access::eShaderRead));
}

/// Records the copies of everything that is wanted into the buffer the host reads.
void read_back(const vk::raii::CommandBuffer& commands, const FrameImages& frame, const GpuImage& surface, const Tile& tile) {
  const ReadbackLayout layout(pixels_of(tile), frame.outputs);
  const auto copy = [&](const GpuImage& image, vk::DeviceSize offset) {
    commands.pipelineBarrier(Stage::eComputeShader, Stage::eTransfer, {}, nullptr, nullptr,
                             color_barrier(image, Layout::eGeneral, Layout::eTransferSrcOptimal, Access::eShaderWrite,
                                           Access::eTransferRead));
    commands.copyImageToBuffer(*image.image, Layout::eTransferSrcOptimal, *frame.readback.buffer,
                               tile_copy(offset, tile.size_px));
  };
  copy(frame.outputs.colors == Colors::bytes ? frame.bytes : frame.color, layout.colors);
  if (frame.outputs.regions) copy(frame.region, layout.regions);
  if (frame.outputs.positions) {
    copy(surface, layout.positions);
    commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader, {}, nullptr, nullptr,
                             color_barrier(surface, Layout::eTransferSrcOptimal, Layout::eGeneral, {}, Access::eShaderRead));
  }
  const vk::MemoryBarrier counted{.srcAccessMask = Access::eShaderWrite, .dstAccessMask = Access::eTransferRead};
  commands.pipelineBarrier(Stage::eComputeShader, Stage::eTransfer, {}, counted, nullptr, nullptr);
  commands.copyBuffer(*frame.list.buffer, *frame.readback.buffer,
                      vk::BufferCopy{0, layout.header, sizeof(gpu::PixelListHeader)});
  const vk::MemoryBarrier copied{.srcAccessMask = Access::eTransferWrite, .dstAccessMask = Access::eHostRead};
  commands.pipelineBarrier(Stage::eTransfer, Stage::eHost, {}, copied, nullptr, nullptr);
}

/// Is a tile of the same surface the same but for the time?
bool only_time_differs(const ShadingKey& a, const ShadingKey& b) {
  return std::memcmp(&a.params, &b.params, sizeof a.params) == 0;
}

std::array<vk::Bool32, 3> kernel_constants(const Outputs& outputs, const FramePasses& passes) {
  return {passes.pixel_list, outputs.colors == Colors::bytes, outputs.regions};
}

bool enabled(const View& view, std::string_view pass) {
  return std::ranges::find(view.disabled_passes, pass) == view.disabled_passes.end();
}

}  // namespace

bool operator==(const SurfaceKey& a, const SurfaceKey& b) {
  const auto same_slice = [](const SliceFrame& s, const SliceFrame& t) {
    return s.origin == t.origin && s.step_x == t.step_x && s.step_y == t.step_y;
  };
  if (a.tile != b.tile || a.slice.has_value() != b.slice.has_value()) return false;
  if (a.slice) return same_slice(*a.slice, *b.slice);
  return a.mesh_serial == b.mesh_serial && a.has_caps == b.has_caps && std::memcmp(&a.raster, &b.raster, sizeof a.raster) == 0;
}

bool operator==(const ShadingKey& a, const ShadingKey& b) {
  return std::memcmp(&a.params, &b.params, sizeof a.params) == 0 && a.time_values == b.time_values;
}

FrameImages Evaluator::Impl::make_frame(vk::Extent2D extent, const Outputs& outputs) const {
  using Usage = vk::ImageUsageFlagBits;
  const auto image = [&](vk::Format format, const vk::Extent3D& size) {
    return gpu.make_image(vk::ImageType::e2D, format, size, Usage::eStorage | Usage::eTransferSrc | Usage::eTransferDst);
  };
  const auto storage = [&](vk::Format format, bool is_wanted) {
    return image(format, {is_wanted ? extent.width : 1, is_wanted ? extent.height : 1, 1});
  };
  const auto tiles = [&](std::uint32_t px) { return has_leaders() ? px / DMVV_LEADER_TILE + 1 : 1; };
  const vk::Extent3D tile_extent{tiles(extent.width), tiles(extent.height), 1};
  const bool as_bytes = outputs.colors == Colors::bytes;
  const std::size_t count = std::size_t{extent.width} * extent.height;
  FrameImages made;
  made.outputs = outputs;
  made.extent = extent;
  made.color = storage(vk::Format::eR32G32B32A32Sfloat, !as_bytes);
  made.bytes = storage(vk::Format::eR32Uint, as_bytes);
  made.region = storage(vk::Format::eR32Uint, outputs.regions);
  made.leader_place = image(vk::Format::eR32G32B32A32Sfloat, tile_extent);
  made.leader_color = image(vk::Format::eR32G32B32A32Sfloat, tile_extent);
  made.leader_region = image(vk::Format::eR32Uint, tile_extent);
  using BufferUse = vk::BufferUsageFlagBits;
  const std::size_t entries = has_leaders() ? 2 * count + std::size_t{tile_extent.width} * tile_extent.height : count;
  made.list = gpu.make_buffer(sizeof(gpu::PixelListHeader) + 4 * entries,
                              BufferUse::eStorageBuffer | BufferUse::eIndirectBuffer | BufferUse::eTransferSrc |
                                  BufferUse::eTransferDst,
                              MemoryUse::device);
  made.known = gpu.make_buffer(judge ? 4 * entries : 4, BufferUse::eStorageBuffer, MemoryUse::device);
  const std::size_t queued = stages.empty() ? 0 : stages.size() - 1;
  made.queues = gpu.make_buffer(sizeof(gpu::QueueHeader) + 4 * queued * count,
                                BufferUse::eStorageBuffer | BufferUse::eIndirectBuffer | BufferUse::eTransferDst, MemoryUse::device);
  made.next_stages = gpu.make_buffer(stages.empty() ? 4 : 4 * count, BufferUse::eStorageBuffer, MemoryUse::device);
  made.readback = gpu.make_buffer(ReadbackLayout(count, outputs).bytes, BufferUse::eTransferDst, MemoryUse::readback);
  made.pool = make_pool(pixel_io);
  made.io_set = make_set(made.pool, list->io_layout);
  const auto write_image = [&](std::uint32_t binding, const GpuImage& written) {
    const vk::DescriptorImageInfo info{{}, *written.view, Layout::eGeneral};
    gpu.device.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *made.io_set,
                                                           .dstBinding = binding,
                                                           .descriptorCount = 1,
                                                           .descriptorType = storage_image,
                                                           .pImageInfo = &info},
                                    nullptr);
  };
  write_image(DMVV_BIND_SURFACE, rasteriser->surface());
  write_image(DMVV_BIND_COLOR, made.color);
  write_image(DMVV_BIND_BYTES, made.bytes);
  write_image(DMVV_BIND_REGION, made.region);
  write_image(DMVV_BIND_LEADER_PLACE, made.leader_place);
  write_image(DMVV_BIND_LEADER_COLOR, made.leader_color);
  write_image(DMVV_BIND_LEADER_REGION, made.leader_region);
  const auto write_buffer = [&](std::uint32_t binding, const GpuBuffer& written) {
    const vk::DescriptorBufferInfo info{*written.buffer, 0, VK_WHOLE_SIZE};
    gpu.device.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *made.io_set,
                                                           .dstBinding = binding,
                                                           .descriptorCount = 1,
                                                           .descriptorType = vk::DescriptorType::eStorageBuffer,
                                                           .pBufferInfo = &info},
                                    nullptr);
  };
  write_buffer(DMVV_BIND_LIST, made.list);
  write_buffer(DMVV_BIND_QUEUES, made.queues);
  write_buffer(DMVV_BIND_NEXT, made.next_stages);
  write_buffer(DMVV_BIND_KNOWN, made.known);
  return made;
}

/// Made before the second frame: one picture alone does without.
void Evaluator::Impl::make_verdicts(const Outputs& outputs) {
  const auto make = [&](std::span<const std::uint32_t> words, std::span<const vk::Bool32> constants) {
    return make_pipeline(words, pixel_io, sizeof(gpu::PixelsParams), constants, &verdicts->layout());
  };
  if (!verdicts) {
    verdicts.emplace(gpu, judge);
    classify = make(classify_comp, {});
    count_hits = make(count_hits_comp, {});
  }
  const auto constants = kernel_constants(outputs, {});
  if (paint.contains(constants)) return;
  paint.emplace(constants, has_bitmaps ? make(paint_bitmaps_comp, constants) : make(paint_comp, constants));
}

Result<void> Evaluator::Impl::make_pixels(const std::array<vk::Bool32, 3>& constants) {
  std::vector<std::span<const std::uint32_t>> codes;
  for (const compiler::Stage& stage : stages) codes.emplace_back(stage.spirv);
  if (codes.empty()) codes.emplace_back(code[static_cast<std::size_t>(compiler::Kernel::pixels)]);
  std::vector<KernelPipeline> made;
  for (const auto words : codes) {
    auto kernel = make_kernel(words, "pixels", pixel_io, sizeof(gpu::PixelsParams), constants);
    if (!kernel) return tl::unexpected(std::move(kernel.error()));
    made.push_back(std::move(*kernel));
  }
  if (!stages.empty() && !distribute) {
    distribute = make_pipeline(distribute_comp, pixel_io, sizeof(gpu::PixelsParams), {});
    count_stages = make_pipeline(count_stages_comp, pixel_io, sizeof(gpu::PixelsParams), {});
  }
  pixels.emplace(constants, std::move(made));
  return {};
}

/// Made when it is known to pay.
void Evaluator::Impl::make_leaders(const Outputs& outputs) {
  const auto constants = kernel_constants(outputs, {});
  if (leaders.contains(constants)) return;
  leaders.emplace(constants, std::move(*make_kernel(compiler::Kernel::leaders, pixel_io, sizeof(gpu::PixelsParams), constants)));
  follow.emplace(constants, make_pipeline(follow_comp, pixel_io, sizeof(gpu::PixelsParams), constants));
}

/// Clears what the frame does not keep, and makes its images ready to be written.
void Evaluator::Impl::prepare_images(const vk::raii::CommandBuffer& commands, bool kept, bool clears, const Strategy& strategy) {
  const bool as_bytes = frame->outputs.colors == Colors::bytes;
  const gpu::PixelListHeader nothing{{{0, 1, 1}, {0, 1, 1}, {0, 1, 1}, {0, 1, 1}}, {0, 0, 0, 0}, 0, 0, 0, 0};
  commands.updateBuffer<gpu::PixelListHeader>(*frame->list.buffer, 0, nothing);
  commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader | Stage::eTransfer, {}, nullptr, nullptr,
                           {begin_writing(frame->color, kept && !as_bytes), begin_writing(frame->bytes, kept && as_bytes),
                            begin_writing(frame->region, kept && frame->outputs.regions),
                            begin_writing(frame->leader_place, false), begin_writing(frame->leader_color, false),
                            begin_writing(frame->leader_region, false)});
  if (!stages.empty()) commands.fillBuffer(*frame->queues.buffer, 0, sizeof(gpu::QueueHeader), 0);
  const vk::ClearColorValue empty{}, unknown{std::array{0.0f, 0.0f, 0.0f, -1.0f}};
  if (clears) {  // what is not evaluated is empty
    commands.clearColorImage(as_bytes ? *frame->bytes.image : *frame->color.image, Layout::eGeneral, empty, color_range);
    if (frame->outputs.regions) commands.clearColorImage(*frame->region.image, Layout::eGeneral, empty, color_range);
  }
  if (strategy.leads) commands.clearColorImage(*frame->leader_place.image, Layout::eGeneral, unknown, color_range);
  const vk::MemoryBarrier cleared{.srcAccessMask = Access::eTransferWrite,
                                  .dstAccessMask = Access::eShaderRead | Access::eShaderWrite};
  commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader, {}, cleared, nullptr, nullptr);
}

namespace {

/// Kernels over a tile's pixels, or over lists of them.
class TileKernels {
 public:
  TileKernels(const vk::raii::CommandBuffer& commands, const FrameImages& frame, const vk::raii::DescriptorSet& scene_set,
              const gpu::PixelsParams& params)
      : commands_(commands), frame_(frame), scene_set_(scene_set), params_(params) {}

  std::uint32_t blocks() const {
    const auto along = [](std::uint32_t px) { return (px + DMVV_PIXELS_BLOCK - 1) / DMVV_PIXELS_BLOCK; };
    return along(params_.width) * along(params_.height);
  }

  void run(const KernelPipeline& kernel, std::uint32_t groups, const Verdicts* verdicts = nullptr) {
    bind(kernel, verdicts);
    commands_.dispatch(groups, 1, 1);
  }
  /// Over the pixels of a list, once `count` has said how many groups they take.
  void run_over(std::uint32_t listed, const KernelPipeline& kernel, const Verdicts* verdicts = nullptr) {
    params_.listed_kind = listed;
    run_indirect(kernel, frame_.list, listed * sizeof(gpu::DispatchGroups), verdicts);
  }
  void count(const KernelPipeline& count_groups) {
    wait();
    run(count_groups, 1);
    wait(vk::AccessFlagBits::eIndirectCommandRead, Stage::eDrawIndirect);
  }
  /// Stage after stage, the first over the pixels of a list.
  void run_stages(std::uint32_t listed, const std::vector<KernelPipeline>& kernels, const std::vector<compiler::Stage>& stages,
                  const KernelPipeline& distribute, const KernelPipeline& count_stages) {
    params_.listed_kind = listed;
    count(count_stages);
    for (std::uint32_t stage = 0; stage < stages.size(); ++stage) {
      params_.stage = stage;
      run_indirect(kernels[stage], frame_.queues, offsetof(gpu::QueueHeader, groups) + stage * sizeof(gpu::DispatchGroups));
      if (!stages[stage].has_next) continue;
      wait();
      run_indirect(distribute, frame_.queues, offsetof(gpu::QueueHeader, runs) + stage * sizeof(gpu::DispatchGroups));
      count(count_stages);
    }
  }
  void wait(vk::AccessFlags more = {}, vk::PipelineStageFlags stages = {}) {
    const vk::MemoryBarrier written{.srcAccessMask = Access::eShaderWrite,
                                    .dstAccessMask = Access::eShaderRead | Access::eShaderWrite | more};
    commands_.pipelineBarrier(Stage::eComputeShader, Stage::eComputeShader | stages, {}, written, nullptr, nullptr);
  }

 private:
  void run_indirect(const KernelPipeline& kernel, const GpuBuffer& groups, vk::DeviceSize offset, const Verdicts* verdicts = nullptr) {
    bind(kernel, verdicts);
    commands_.dispatchIndirect(*groups.buffer, offset);
  }
  void bind(const KernelPipeline& kernel, const Verdicts* verdicts) {
    constexpr auto compute = vk::PipelineBindPoint::eCompute;
    commands_.bindPipeline(compute, *kernel.pipeline);
    commands_.bindDescriptorSets(compute, *kernel.layout, 0, {*scene_set_, *frame_.io_set}, nullptr);
    if (verdicts != nullptr) commands_.bindDescriptorSets(compute, *kernel.layout, 2, *verdicts->set(), nullptr);
    commands_.pushConstants<gpu::PixelsParams>(*kernel.layout, vk::ShaderStageFlagBits::eCompute, 0, params_);
  }

  const vk::raii::CommandBuffer& commands_;
  const FrameImages& frame_;
  const vk::raii::DescriptorSet& scene_set_;
  gpu::PixelsParams params_;
};

}  // namespace

/// Lists the pixels that show a surface and that no verdict answers, and evaluates those; or all. With leaders, those first,
/// and of the others whom they do not answer for.
void Evaluator::Impl::evaluate_tile(const vk::raii::CommandBuffer& commands, const gpu::PixelsParams& params,
                                    const FramePasses& passes, const Strategy& strategy) {
  const bool kept = params.keeps_still != 0;
  prepare_images(commands, kept, passes.pixel_list && !kept, strategy);
  TileKernels kernels(commands, *frame, scene_set, params);
  const auto constants = kernel_constants(frame->outputs, passes);
  const std::vector<KernelPipeline>& evaluation = pixels.at(constants);
  if (!passes.pixel_list && stages.empty()) return kernels.run(evaluation.front(), kernels.blocks());

  const Verdicts* proven = strategy.classifies ? &*verdicts : nullptr;
  const std::uint32_t runs = kernels.blocks() * DMVV_PIXELS_BLOCK;
  kernels.run(proven != nullptr ? *classify : *list, (runs + DMVV_PIXELS_GROUP_SIZE - 1) / DMVV_PIXELS_GROUP_SIZE, proven);
  kernels.count(*count_groups);
  if (proven != nullptr) kernels.run_over(DMVV_TO_PAINT, paint.at(constants), proven);
  if (strategy.leads) {
    kernels.run_over(DMVV_LEADERS_OF_TILES, leaders.at(constants));
    kernels.wait();
    kernels.run_over(DMVV_TO_EVALUATE, follow.at(constants));
    kernels.count(*count_groups);
  }
  const std::uint32_t evaluated = strategy.leads ? DMVV_LEFT : DMVV_TO_EVALUATE;
  if (stages.empty()) kernels.run_over(evaluated, evaluation.front());
  else kernels.run_stages(evaluated, evaluation, stages, *distribute, *count_stages);
  if (proven == nullptr) return;
  kernels.run_over(evaluated, *count_hits, proven);
  if (strategy.leads) kernels.run_over(DMVV_LEADERS_OF_TILES, *count_hits, proven);
}

/// The fastest of those that are possible. The leaders' kernel is made when frames without it have taken as long as it takes
/// to compile (rent or buy).
Strategy Evaluator::Impl::choose_strategy(const FramePasses& passes) {
  const bool may_skip = passes.pixel_list && has_drawn && std::abs(now_ms) <= compiler::longest_ms;
  const bool may_classify = may_skip && passes.verdicts && judge;
  const bool may_lead = may_skip && passes.reach && has_leaders() && (drawn_ms >= compile_ms || !passes.trials);
  if (!passes.trials) return {may_classify, may_lead};
  std::array<bool, Strategy::count> possible{};
  for (std::size_t i = 0; i < possible.size(); ++i) {
    const Strategy strategy = Strategy::of_number(i);
    possible[i] = (may_classify || !strategy.classifies) && (may_lead || !strategy.leads);
  }
  return may_skip ? Strategy::of_number(autotuner.begin(possible)) : Strategy{};
}

double Evaluator::Impl::render_tile(const FrameSetup& setup, const Tile& tile, const FramePasses& passes) {
  gpu::PixelsParams params = setup.pixels;
  params.width = tile.size_px.x;
  params.height = tile.size_px.y;
  SurfaceKey surface{setup.raster, setup.slice, rasteriser->mesh_serial(), setup.has_caps, tile};
  ShadingKey shading{params, time_values};
  const bool has_surface = frame->surface == surface;
  if (passes.keep_picture && has_surface && frame->shaded == shading) return 0.0;

  const bool draws = !(passes.keep_surface && has_surface);
  const Strategy strategy = choose_strategy(passes);
  if (strategy.leads) make_leaders(frame->outputs);
  params.has_leaders = strategy.leads;
  params.lists_all = passes.pixel_list ? 0 : 1;
  if (strategy.classifies) {
    make_verdicts(frame->outputs);
    verdicts->begin_frame(now_ms);
    verdicts->fill(params);
    params.keeps_still = passes.keep_still && !draws && frame->shaded && only_time_differs(*frame->shaded, shading);
  }
  if (setup.slice && frame->slice_surface.bytes == 0) {
    const vk::DeviceSize bytes = vk::DeviceSize{16} * frame->extent.width * frame->extent.height;
    frame->slice_surface = gpu.make_buffer(bytes, vk::BufferUsageFlagBits::eTransferSrc, MemoryUse::upload);
  }
  frame->surface.reset();  // a failure below must leave no name on what is half done
  frame->shaded.reset();
  const double ms = gpu.run([&](const vk::raii::CommandBuffer& commands) {
    if (draws && setup.slice) draw_slice(commands, *frame, rasteriser->surface(), setup, tile);
    if (draws && !setup.slice) rasteriser->draw(commands, setup, tile, passes.clusters);
    evaluate_tile(commands, params, passes, strategy);
    read_back(commands, *frame, rasteriser->surface(), tile);
  });
  frame->surface = std::move(surface);
  frame->shaded = std::move(shading);
  const gpu::PixelListHeader counted = tile_pixels(*frame, tile).counted;
  const double split_ms = strategy.classifies ? verdicts->end_frame(evaluated_pixels(counted, strategy.leads), ms, draws) : 0.0;
  if (has_drawn && passes.pixel_list) {
    autotuner.end(strategy.number(), ms + split_ms);
    drawn_ms += ms;
  }
  return ms;
}

/// Makes what is missing for this kind of picture, and draws a few pixels, so that the driver compiles it now. They are
/// drawn into the frame's own images: lavapipe compiles a kernel anew for images whose sides are powers of two.
Result<void> Evaluator::Impl::warm_up(const FrameSetup& setup, vk::Extent2D extent, const Outputs& outputs,
                                      const FramePasses& passes, Timings* timings) {
  const bool is_warm = setup.slice || rasteriser->is_ready(setup);
  const bool has_frame = frame && frame->extent == extent && frame->outputs == outputs;
  const auto constants = kernel_constants(outputs, passes);
  const bool has_kernel = pixels.contains(constants);
  if (is_warm && has_frame && has_kernel) return {};
  const Stopwatch watch(timings, "pipeline");
  const auto start = std::chrono::steady_clock::now();
  if (!list) {
    list = make_pipeline(list_comp, pixel_io, sizeof(gpu::PixelsParams), {});
    count_groups = make_pipeline(count_groups_comp, pixel_io, sizeof(gpu::PixelsParams), {});
  }
  if (!has_kernel) {
    if (auto made = make_pixels(constants); !made) return tl::unexpected(std::move(made.error()));
  }
  if (!has_frame) {
    frame.reset();
    rasteriser->set_extent(extent);
    frame = make_frame(extent, outputs);
  }
  render_tile(setup, {{0, 0}, glm::min(warm_up_px, setup.size_px)}, passes);
  if (!has_kernel) compile_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return {};
}

Result<Picture> Evaluator::Impl::render(const View& view, Timings* timings) {
  if (auto refused = time_fault(view.time_ms)) return tl::unexpected(std::move(*refused));
  set_time(view.time_ms);
  if (!rasteriser) rasteriser = std::make_unique<Rasteriser>(gpu);
  if (!view.slice) {
    const auto drawn = rasteriser->set_mesh(support_mesh(view));
    if (!drawn) return tl::unexpected(drawn.error());
  }
  const auto setup = plan_frame_setup(view, rasteriser->bounds(), longest_picture_px);
  if (!setup) return tl::unexpected(setup.error());
  const glm::uvec2 tile_px = largest_tile(setup->size_px, view.samples);
  const vk::Extent2D extent{tile_px.x, tile_px.y};
  const Outputs outputs{view.samples == 1 ? view.colors : Colors::floats,  // the mean of samples is taken in float
                      view.want_regions || view.want_depth, view.want_depth || view.want_positions};
  const FramePasses passes{enabled(view, "pixel-list"), enabled(view, "keep-surface"), enabled(view, "keep-picture"),
                           enabled(view, "verdicts"), enabled(view, "keep-still"), enabled(view, "clusters"),
                           enabled(view, "reach"), enabled(view, "trials")};
  if (const auto ready = warm_up(*setup, extent, outputs, passes, timings); !ready) return tl::unexpected(ready.error());

  const Stopwatch watch(timings, "frame");
  Picture picture = empty_picture(view);
  std::size_t unfinished = 0;
  double gpu_ms = 0.0;
  bool is_complete = true;
  const auto [lo, hi] = setup->seen;
  for (std::uint32_t y = lo.y; y < hi.y; y += extent.height) {
    for (std::uint32_t x = lo.x; x < hi.x; x += extent.width) {
      const Tile tile{{x, y}, glm::min(glm::uvec2(extent.width, extent.height), hi - glm::uvec2(x, y))};
      gpu_ms += render_tile(*setup, tile, passes);
      is_complete = is_complete && (setup->slice || rasteriser->is_complete());
      const TilePixels result = tile_pixels(*frame, tile);
      unfinished += result.counted.unfinished;
      resolve_tile(result, tile, *setup, view.samples, picture);
    }
  }
  has_drawn = true;
  if (!is_complete) {
    return fail(Fault::input, "large triangles of the support mesh lie over each other too often to be drawn",
                {"render a smaller picture, or move the eye out of the mesh"});
  }
  if (unfinished != 0) {
    return fail(Fault::input,
                fmt::format("{} pixels needed more loop rounds than this device grants (65,535)", unfinished),
                {"split the scene's longest lists of seeds or embedded objects, or use another device"});
  }
  if (timings != nullptr && gpu.timer_bits != 0) timings->push_back({gpu_step, gpu_ms});
  if (!view.slice && !view.cuts.empty()) picture.edges = rasteriser->edges();
  return picture;
}

}  // namespace dmvv::runtime
