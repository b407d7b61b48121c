#include "runtime/frame/frame_images.h"

#include <algorithm>
#include <cstring>

#include "runtime/surface/raster.h"

namespace dmvv::runtime {
namespace {

using BufferUse = vk::BufferUsageFlagBits;
using Layout = vk::ImageLayout;

constexpr auto image_use =
    vk::ImageUsageFlagBits::eStorage | vk::ImageUsageFlagBits::eTransferSrc | vk::ImageUsageFlagBits::eTransferDst;

std::size_t area_of(vk::Extent2D extent) { return std::size_t{extent.width} * extent.height; }

}  // namespace

bool operator==(const SurfaceKey& a, const SurfaceKey& b) {
  const auto same_slice = [](const SliceFrame& s, const SliceFrame& t) {
    return s.origin == t.origin && s.step_x == t.step_x && s.step_y == t.step_y;
  };
  if (a.tile != b.tile || a.slice.has_value() != b.slice.has_value()) return false;
  if (a.slice) return same_slice(*a.slice, *b.slice);
  if (a.is_of_rays != b.is_of_rays || a.time_values != b.time_values) return false;
  return a.mesh_serial == b.mesh_serial && a.has_caps == b.has_caps &&
         std::memcmp(&a.raster, &b.raster, sizeof a.raster) == 0;
}

bool operator==(const ShadingKey& a, const ShadingKey& b) {
  return only_time_differs(a, b) && a.time_values == b.time_values;
}

bool only_time_differs(const ShadingKey& a, const ShadingKey& b) {
  return std::memcmp(&a.params, &b.params, sizeof a.params) == 0;
}

ReadbackLayout::ReadbackLayout(std::size_t pixels, const Outputs& outputs)
    : colors(outputs.positions ? 16 * pixels : 0),
      regions(colors + (outputs.colors == Colors::bytes ? 4 : 16) * pixels),
      notes(regions + (outputs.regions ? 4 * pixels : 0)),
      bytes(notes + (outputs.doubt ? 4 * pixels : 0)) {}

FrameImages::FrameImages(const Device::Impl& gpu, const vk::raii::DescriptorSetLayout& layout, vk::Extent2D extent,
                         std::size_t tile_count, const Outputs& outputs, const FrameNeeds& needs,
                         std::optional<GpuImage> spare)
    : gpu_(gpu), extent_(extent), outputs_(outputs) {
  make_scratch(needs);
  tiles_.push_back(make_tile(layout, needs, std::move(spare)));
  while (tiles_.size() < kept_tiles(extent, tile_count)) tiles_.push_back(make_tile(layout, needs, std::nullopt));
  make_ready();
}

std::size_t FrameImages::kept_tiles(vk::Extent2D extent, std::size_t tile_count) {
  return tile_count * area_of(extent) <= most_kept_px ? std::max<std::size_t>(tile_count, 1) : 1;
}

bool FrameImages::serves(vk::Extent2D extent, std::size_t tile_count, const Outputs& outputs) const {
  return extent == extent_ && outputs == outputs_ && tiles_.size() == kept_tiles(extent, tile_count);
}

GpuImage FrameImages::make_image(vk::Format format, vk::Extent3D size) const {
  return gpu_.make_image(vk::ImageType::e2D, format, size, image_use);
}

void FrameImages::make_scratch(const FrameNeeds& needs) {
  const auto leaders = [&](std::uint32_t px) { return needs.leaders ? px / DMVV_LEADER_TILE + 1 : 1; };
  const vk::Extent3D leader_extent{leaders(extent_.width), leaders(extent_.height), 1};
  scratch_.leader_place = make_image(vk::Format::eR32G32B32A32Sfloat, leader_extent);
  scratch_.leader_color = make_image(vk::Format::eR32G32B32A32Sfloat, leader_extent);
  scratch_.leader_region = make_image(vk::Format::eR32Uint, leader_extent);

  const std::size_t count = area_of(extent_);
  const std::size_t entries =
      needs.leaders ? 2 * count + std::size_t{leader_extent.width} * leader_extent.height : count;
  const auto storage = [&](std::size_t bytes, vk::BufferUsageFlags more = {}) {
    return gpu_.make_buffer(bytes, BufferUse::eStorageBuffer | more, MemoryUse::device);
  };
  scratch_.list = storage(sizeof(gpu::PixelListHeader) + 4 * entries,
                          BufferUse::eIndirectBuffer | BufferUse::eTransferSrc | BufferUse::eTransferDst);
  scratch_.known = storage(needs.verdicts ? 4 * entries : 4);
  const std::size_t queued = needs.stages == 0 ? 0 : needs.stages - 1;
  scratch_.queues =
      storage(sizeof(gpu::QueueHeader) + 4 * queued * count, BufferUse::eIndirectBuffer | BufferUse::eTransferDst);
  scratch_.next_stages = storage(needs.stages == 0 ? 4 : 4 * count);
}

TileImages FrameImages::make_tile(const vk::raii::DescriptorSetLayout& layout, const FrameNeeds& needs,
                                  std::optional<GpuImage> spare) const {
  const auto image = [&](vk::Format format, bool is_asked_for) {
    return make_image(format, {is_asked_for ? extent_.width : 1, is_asked_for ? extent_.height : 1, 1});
  };
  const bool as_bytes = outputs_.colors == Colors::bytes;
  TileImages made;
  made.surface = spare ? std::move(*spare) : make_surface_image(gpu_, extent_);
  made.color = image(vk::Format::eR32G32B32A32Sfloat, !as_bytes);
  made.bytes = image(vk::Format::eR32Uint, as_bytes);
  made.region = image(vk::Format::eR32Uint, outputs_.regions);
  made.block = gpu_.make_buffer(sizeof(gpu::FrameParams), BufferUse::eUniformBuffer | BufferUse::eTransferDst,
                                MemoryUse::device);
  made.notes = image(vk::Format::eR32Uint, needs.rays);
  made.rays = gpu_.make_buffer(needs.rays ? sizeof(gpu::RayParams) : 16,
                               BufferUse::eUniformBuffer | BufferUse::eTransferDst, MemoryUse::device);
  const auto along = [&](std::uint32_t px) { return std::size_t{(px + DMVV_RAY_TILE - 1) / DMVV_RAY_TILE}; };
  const std::size_t ray_tiles = needs.rays ? along(extent_.width) * along(extent_.height) : 0;
  made.tiles = gpu_.make_buffer(
      sizeof(gpu::RayTilesHeader) + 8 * ray_tiles,
      BufferUse::eStorageBuffer | BufferUse::eIndirectBuffer | BufferUse::eTransferSrc | BufferUse::eTransferDst,
      MemoryUse::device);
  made.media = gpu_.make_buffer(needs.media ? 16 * area_of(extent_) : 16,
                                BufferUse::eStorageBuffer | BufferUse::eTransferDst, MemoryUse::device);
  made.report = gpu_.make_buffer(sizeof(TileReport), BufferUse::eTransferDst, MemoryUse::readback);
  made.set = DescriptorSet(gpu_, layout, pixel_bindings);
  made.set.write(DMVV_BIND_SURFACE, made.surface);
  made.set.write(DMVV_BIND_COLOR, made.color);
  made.set.write(DMVV_BIND_BYTES, made.bytes);
  made.set.write(DMVV_BIND_REGION, made.region);
  made.set.write(DMVV_BIND_LEADER_PLACE, scratch_.leader_place);
  made.set.write(DMVV_BIND_LEADER_COLOR, scratch_.leader_color);
  made.set.write(DMVV_BIND_LEADER_REGION, scratch_.leader_region);
  made.set.write(DMVV_BIND_LIST, scratch_.list);
  made.set.write(DMVV_BIND_QUEUES, scratch_.queues);
  made.set.write(DMVV_BIND_NEXT, scratch_.next_stages);
  made.set.write(DMVV_BIND_KNOWN, scratch_.known);
  made.set.write(DMVV_BIND_FRAME, made.block);
  made.set.write(DMVV_BIND_RAYS, made.rays);
  made.set.write(DMVV_BIND_RAY_TILES, made.tiles);
  made.set.write(DMVV_BIND_RAY_NOTES, made.notes);
  made.set.write(DMVV_BIND_MEDIA, made.media);
  return made;
}

/// All images go into the layout in which they stay.
void FrameImages::make_ready() const {
  std::vector<vk::ImageMemoryBarrier> barriers;
  const auto add = [&](const GpuImage& image) {
    barriers.push_back(
        color_barrier(image, Layout::eUndefined, Layout::eGeneral, {}, vk::AccessFlagBits::eShaderWrite));
  };
  for (const TileImages& tile : tiles_) {
    for (const GpuImage* image : {&tile.surface, &tile.color, &tile.bytes, &tile.region, &tile.notes}) add(*image);
  }
  for (const GpuImage* image : {&scratch_.leader_place, &scratch_.leader_color, &scratch_.leader_region}) add(*image);
  gpu_.run([&](const vk::raii::CommandBuffer& commands) {
    commands.pipelineBarrier(vk::PipelineStageFlagBits::eTopOfPipe, vk::PipelineStageFlagBits::eComputeShader, {},
                             nullptr, nullptr, barriers);
  });
}

GpuBuffer& FrameImages::slice_surface() {
  if (scratch_.slice_surface.bytes == 0) {
    scratch_.slice_surface = gpu_.make_buffer(16 * area_of(extent_), BufferUse::eTransferSrc, MemoryUse::upload);
  }
  return scratch_.slice_surface;
}

GpuBuffer& FrameImages::readback_of(TileImages& tile) const {
  const vk::DeviceSize bytes = ReadbackLayout(area_of(extent_), outputs_).bytes;
  if (tile.readback.bytes == 0) tile.readback = gpu_.make_buffer(bytes, BufferUse::eTransferDst, MemoryUse::readback);
  return tile.readback;
}

const TileReport& counted(const TileImages& images) { return *static_cast<const TileReport*>(images.report.mapped); }

TilePixels pixels_of(const TileImages& images, const Tile& tile, const Outputs& outputs) {
  const ReadbackLayout layout(std::size_t{tile.size_px.x} * tile.size_px.y, outputs);
  const auto* mapped = static_cast<const std::byte*>(images.readback.mapped);
  const bool as_bytes = outputs.colors == Colors::bytes;
  return {as_bytes ? nullptr : reinterpret_cast<const glm::vec4*>(mapped + layout.colors),
          as_bytes ? reinterpret_cast<const std::uint32_t*>(mapped + layout.colors) : nullptr,
          outputs.positions ? reinterpret_cast<const glm::uvec4*>(mapped + layout.positions) : nullptr,
          outputs.regions ? reinterpret_cast<const std::uint32_t*>(mapped + layout.regions) : nullptr,
          outputs.doubt ? reinterpret_cast<const std::uint32_t*>(mapped + layout.notes) : nullptr};
}

}  // namespace dmvv::runtime
