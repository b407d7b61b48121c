// One picture: tile by tile the surface is drawn (or a slice's points are uploaded), evaluated and read back.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <limits>

#include "runtime/evaluator.h"

namespace dmvv::runtime {
namespace {

using Access = vk::AccessFlagBits;
using Layout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits;

constexpr std::uint32_t longest_picture_px = 16384;
constexpr std::uint32_t widest_tile_px = 2048;
constexpr std::uint32_t tile_budget_px = 1u << 21;  // some 220 MiB of images and buffers
constexpr glm::uvec2 warm_up_px{DMVV_PIXELS_GROUP_SIZE, DMVV_PIXELS_GROUP_SIZE};
constexpr std::array pixel_io{vk::DescriptorType::eStorageImage, vk::DescriptorType::eStorageImage,
                              vk::DescriptorType::eStorageImage, vk::DescriptorType::eStorageImage};

constexpr vk::ImageSubresourceLayers color_layer{vk::ImageAspectFlagBits::eColor, 0, 0, 1};
constexpr vk::ImageSubresourceRange color_range{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};

/// Tiles hold whole pixels: samples^2 rendered pixels each.
vk::Extent2D tile_extent(glm::uvec2 rendered_px, std::uint32_t samples) {
  const auto whole = [&](std::uint32_t px) { return std::max(samples, px / samples * samples); };
  const std::uint32_t width = std::min(rendered_px.x, whole(widest_tile_px));
  return {width, std::min(rendered_px.y, whole(tile_budget_px / width))};
}

vk::BufferImageCopy tile_copy(vk::DeviceSize offset, glm::uvec2 size_px) {
  return {.bufferOffset = offset, .imageSubresource = color_layer, .imageExtent = {size_px.x, size_px.y, 1}};
}

/// Where the parts of a tile stand in the buffer that is read back.
struct ReadbackLayout {
  vk::DeviceSize positions, regions, bytes;

  ReadbackLayout(std::size_t pixels, bool with_positions)
      : positions(16 * pixels), regions(positions + (with_positions ? 16 * pixels : 0)), bytes(regions + 4 * pixels) {}
};

/// What came back of a tile.
struct TilePixels {
  const glm::vec4* colors;
  const glm::vec4* positions;  ///< null if not wanted
  const std::uint32_t* regions;
};

TilePixels tile_pixels(const Frame& frame, const Tile& tile) {
  const ReadbackLayout layout(std::size_t{tile.size_px.x} * tile.size_px.y, frame.has_positions);
  const auto* bytes = static_cast<const std::byte*>(frame.readback.mapped);
  return {reinterpret_cast<const glm::vec4*>(bytes),
          frame.has_positions ? reinterpret_cast<const glm::vec4*>(bytes + layout.positions) : nullptr,
          reinterpret_cast<const std::uint32_t*>(bytes + layout.regions)};
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

float depth_of(const Shot& shot, std::uint32_t region, const glm::vec4& position) {
  if (region == 0) return std::numeric_limits<float>::infinity();
  if (shot.slice) return 0.0f;
  return static_cast<float>(glm::dot(shot.forward, glm::dvec3(position) - shot.eye));
}

/// The point that the kernel evaluates (shaders/pixels.comp).
glm::vec3 position_of(const Shot& shot, const glm::vec4& surface) {
  if (surface.w <= 0.5f) return glm::vec3(std::numeric_limits<float>::quiet_NaN());
  return glm::clamp(glm::vec3(surface), glm::vec3(shot.pixels.bounds_lo), glm::vec3(shot.pixels.bounds_hi));
}

Picture empty_picture(const View& view) {
  Picture picture;
  picture.size_px = view.size_px;
  const std::size_t pixels = std::size_t{view.size_px.x} * view.size_px.y;
  picture.rgba.resize(4 * pixels);
  if (view.want_regions) picture.regions.resize(pixels);
  if (view.want_depth) picture.depth.resize(pixels);
  if (view.want_positions) picture.positions.resize(pixels);
  return picture;
}

/// Puts a tile into the picture.
void resolve_tile(const TilePixels& from, const Tile& tile, const Shot& shot, std::uint32_t samples, Picture& picture) {
  const std::size_t pitch = tile.size_px.x;
  const glm::uvec2 corner = tile.corner_px / samples, size = tile.size_px / samples;
  for (std::uint32_t y = 0; y < size.y; ++y) {
    for (std::uint32_t x = 0; x < size.x; ++x) {
      const std::size_t source = y * samples * pitch + x * samples;
      const std::size_t pixel = std::size_t{corner.y + y} * picture.size_px.x + corner.x + x;
      const glm::vec4 color = mean_color(from.colors + source, pitch, samples);
      std::memcpy(&picture.rgba[4 * pixel], &color, sizeof color);
      if (!picture.regions.empty()) picture.regions[pixel] = from.regions[source];
      if (!picture.depth.empty()) picture.depth[pixel] = depth_of(shot, from.regions[source], from.positions[source]);
      if (!picture.positions.empty()) picture.positions[pixel] = position_of(shot, from.positions[source]);
    }
  }
}

/// Uploads a slice's positions in place of a drawn surface.
void draw_slice(const vk::raii::CommandBuffer& commands, const Frame& frame, const Shot& shot, const Tile& tile) {
  fill_slice_positions(*shot.slice, tile.corner_px, tile.size_px,
                       static_cast<glm::vec4*>(frame.slice_positions.mapped));
  const GpuImage& position = frame.targets.position;
  const GpuImage& normal = frame.targets.normal;
  commands.pipelineBarrier(
      Stage::eTopOfPipe, Stage::eTransfer, {}, nullptr, nullptr,
      {color_barrier(position, Layout::eUndefined, Layout::eTransferDstOptimal, {}, Access::eTransferWrite),
       color_barrier(normal, Layout::eUndefined, Layout::eTransferDstOptimal, {}, Access::eTransferWrite)});
  commands.copyBufferToImage(*frame.slice_positions.buffer, *position.image, Layout::eTransferDstOptimal,
                             tile_copy(0, tile.size_px));
  commands.clearColorImage(*normal.image, Layout::eTransferDstOptimal, vk::ClearColorValue{}, color_range);
  commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader, {}, nullptr, nullptr,
                           {color_barrier(position, Layout::eTransferDstOptimal, Layout::eGeneral,
                                          Access::eTransferWrite, Access::eShaderRead),
                            color_barrier(normal, Layout::eTransferDstOptimal, Layout::eGeneral, Access::eTransferWrite,
                                          Access::eShaderRead)});
}

/// Records the copies of everything that is wanted into the buffer the host reads.
void read_back(const vk::raii::CommandBuffer& commands, const Frame& frame, const Tile& tile) {
  const ReadbackLayout layout(std::size_t{tile.size_px.x} * tile.size_px.y, frame.has_positions);
  const auto copy = [&](const GpuImage& image, vk::DeviceSize offset) {
    commands.pipelineBarrier(Stage::eComputeShader, Stage::eTransfer, {}, nullptr, nullptr,
                             color_barrier(image, Layout::eGeneral, Layout::eTransferSrcOptimal, Access::eShaderWrite,
                                           Access::eTransferRead));
    commands.copyImageToBuffer(*image.image, Layout::eTransferSrcOptimal, *frame.readback.buffer,
                               tile_copy(offset, tile.size_px));
  };
  copy(frame.color, 0);
  if (frame.has_positions) copy(frame.targets.position, layout.positions);
  copy(frame.region, layout.regions);
  const vk::MemoryBarrier copied{.srcAccessMask = Access::eTransferWrite, .dstAccessMask = Access::eHostRead};
  commands.pipelineBarrier(Stage::eTransfer, Stage::eHost, {}, copied, nullptr, nullptr);
}

}  // namespace

Frame Evaluator::Impl::make_frame(vk::Extent2D extent, bool with_positions) const {
  using Usage = vk::ImageUsageFlagBits;
  const vk::Extent3D size{extent.width, extent.height, 1};
  Frame made;
  made.targets = rasteriser->make_targets(extent);
  made.color =
      gpu.make_image(vk::ImageType::e2D, vk::Format::eR32G32B32A32Sfloat, size, Usage::eStorage | Usage::eTransferSrc);
  made.region = gpu.make_image(vk::ImageType::e2D, vk::Format::eR32Uint, size, Usage::eStorage | Usage::eTransferSrc);
  made.has_positions = with_positions;
  const ReadbackLayout layout(std::size_t{extent.width} * extent.height, with_positions);
  made.readback = gpu.make_buffer(layout.bytes, vk::BufferUsageFlagBits::eTransferDst, MemoryUse::readback);
  made.pool = make_pool(pixel_io);
  made.io_set = make_set(made.pool, pixels->io_layout);
  const std::array images{vk::DescriptorImageInfo{{}, *made.targets.position.view, Layout::eGeneral},
                          vk::DescriptorImageInfo{{}, *made.targets.normal.view, Layout::eGeneral},
                          vk::DescriptorImageInfo{{}, *made.color.view, Layout::eGeneral},
                          vk::DescriptorImageInfo{{}, *made.region.view, Layout::eGeneral}};
  gpu.device.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *made.io_set,
                                                         .dstBinding = DMVV_BIND_POSITION,
                                                         .descriptorCount = images.size(),
                                                         .descriptorType = pixel_io[0],
                                                         .pImageInfo = images.data()},
                                  nullptr);
  return made;
}

double Evaluator::Impl::render_tile(Frame& target, const Shot& shot, const Tile& tile) {
  if (shot.slice && target.slice_positions.bytes == 0) {
    const vk::DeviceSize bytes = vk::DeviceSize{16} * target.targets.extent.width * target.targets.extent.height;
    target.slice_positions = gpu.make_buffer(bytes, vk::BufferUsageFlagBits::eTransferSrc, MemoryUse::upload);
  }
  gpu::PixelsParams params = shot.pixels;
  params.width = tile.size_px.x;
  params.height = tile.size_px.y;
  return gpu.run([&](const vk::raii::CommandBuffer& commands) {
    if (shot.slice) {
      draw_slice(commands, target, shot, tile);
    } else {
      rasteriser->draw(commands, target.targets, shot, tile);
    }
    commands.pipelineBarrier(
        Stage::eTopOfPipe, Stage::eComputeShader, {}, nullptr, nullptr,
        {color_barrier(target.color, Layout::eUndefined, Layout::eGeneral, {}, Access::eShaderWrite),
         color_barrier(target.region, Layout::eUndefined, Layout::eGeneral, {}, Access::eShaderWrite)});
    const auto compute = vk::PipelineBindPoint::eCompute;
    const auto groups = [](std::uint32_t px) { return (px + DMVV_PIXELS_GROUP_SIZE - 1) / DMVV_PIXELS_GROUP_SIZE; };
    commands.bindPipeline(compute, *pixels->pipeline);
    commands.bindDescriptorSets(compute, *pixels->layout, 0, {*scene_set, *target.io_set}, nullptr);
    commands.pushConstants<gpu::PixelsParams>(*pixels->layout, vk::ShaderStageFlagBits::eCompute, 0, params);
    commands.dispatch(groups(tile.size_px.x), groups(tile.size_px.y), 1);
    read_back(commands, target, tile);
  });
}

/// Makes what is missing for this kind of picture, and draws a few pixels, so that the driver compiles it now. They are
/// drawn into the frame's own images: lavapipe compiles a kernel anew for images whose sides are powers of two.
Result<void> Evaluator::Impl::warm_up(const Shot& shot, vk::Extent2D extent, bool with_positions, Timings* timings) {
  bool& is_warm = warm[shot.slice ? 0 : shot.has_caps ? 2 : 1];
  const bool has_frame = frame && frame->targets.extent == extent && frame->has_positions == with_positions;
  if (is_warm && has_frame) return {};
  const Stopwatch watch(timings, "pipeline");
  if (!pixels) {
    auto made = make_kernel(compiler::Kernel::pixels, pixel_io, sizeof(gpu::PixelsParams));
    if (!made) return tl::unexpected(std::move(made.error()));
    pixels = std::move(*made);
  }
  if (!has_frame) {
    frame.reset();
    frame = make_frame(extent, with_positions);
  }
  render_tile(*frame, shot, {{0, 0}, glm::min(warm_up_px, shot.size_px)});
  is_warm = true;
  return {};
}

Result<Picture> Evaluator::Impl::render(const View& view, Timings* timings) {
  set_time(view.time_ms);
  if (!rasteriser) rasteriser.emplace(gpu);
  if (!view.slice) {
    const auto drawn = rasteriser->set_mesh(view.mesh != nullptr ? *view.mesh : voml::standard_cube());
    if (!drawn) return tl::unexpected(drawn.error());
  }
  const std::uint32_t largest_px =
      std::min({longest_picture_px, gpu.limits.maxViewportDimensions[0], gpu.limits.maxViewportDimensions[1]});
  const auto shot = plan_shot(view, rasteriser->bounds(), largest_px);
  if (!shot) return tl::unexpected(shot.error());
  const vk::Extent2D extent = tile_extent(shot->size_px, view.samples);
  const bool need_positions = view.want_depth || view.want_positions;
  if (const auto ready = warm_up(*shot, extent, need_positions, timings); !ready) return tl::unexpected(ready.error());

  const Stopwatch watch(timings, "frame");
  Picture picture = empty_picture(view);
  std::size_t unfinished = 0;
  double gpu_ms = 0.0;
  for (std::uint32_t y = 0; y < shot->size_px.y; y += extent.height) {
    for (std::uint32_t x = 0; x < shot->size_px.x; x += extent.width) {
      const Tile tile{{x, y}, glm::min(glm::uvec2(extent.width, extent.height), shot->size_px - glm::uvec2(x, y))};
      gpu_ms += render_tile(*frame, *shot, tile);
      const TilePixels result = tile_pixels(*frame, tile);
      const std::size_t count = std::size_t{tile.size_px.x} * tile.size_px.y;
      unfinished += static_cast<std::size_t>(std::count(result.regions, result.regions + count, DMVV_UNFINISHED));
      resolve_tile(result, tile, *shot, view.samples, picture);
    }
  }
  if (unfinished != 0) {
    return fail(Fault::input,
                fmt::format("{} pixels needed more loop rounds than this device grants (65,535)", unfinished),
                {"split the scene's longest lists of seeds or embedded objects, or use another device"});
  }
  if (timings != nullptr && gpu.timer_bits != 0) timings->push_back({gpu_step, gpu_ms});
  if (!view.slice && !view.cuts.empty()) picture.open_edges = rasteriser->open_edges();
  return picture;
}

}  // namespace dmvv::runtime
