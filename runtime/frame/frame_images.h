// Inside the runtime only: the images and buffers of a frame, and what they hold.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "runtime/gpu/descriptors.h"
#include "runtime/surface/clusters.h"
#include "runtime/view/frame_setup.h"

namespace dmvv::runtime {

/// What a frame brings back: kernels are specialised to it.
struct Outputs {
  Colors colors = Colors::floats;
  bool regions = false;
  bool positions = false;
  bool doubt = false;
  friend bool operator==(const Outputs&, const Outputs&) = default;
};

/// All that a tile's surface depends on; equal bytes are equal surfaces.
struct SurfaceKey {
  gpu::RasterParams raster{};
  std::optional<SliceFrame> slice;
  bool is_of_rays = false;
  std::vector<float> time_values;  ///< that rays depend on
  std::uint32_t mesh_serial = 0;
  bool has_caps = false;
  Tile tile;
};
bool operator==(const SurfaceKey& a, const SurfaceKey& b);

/// All that a tile's colours depend on beside its surface.
struct ShadingKey {
  gpu::FrameParams params{};
  std::vector<float> time_values;
};
bool operator==(const ShadingKey& a, const ShadingKey& b);
/// Is a tile of the same surface the same but for the time?
bool only_time_differs(const ShadingKey& a, const ShadingKey& b);

/// Descriptor set 1 of the kernels over pixels: DMVV_BIND_SURFACE and those that follow it.
inline constexpr std::array<SetBinding, 16> pixel_bindings{{
    {DMVV_BIND_SURFACE, vk::DescriptorType::eStorageImage},
    {DMVV_BIND_COLOR, vk::DescriptorType::eStorageImage},
    {DMVV_BIND_BYTES, vk::DescriptorType::eStorageImage},
    {DMVV_BIND_REGION, vk::DescriptorType::eStorageImage},
    {DMVV_BIND_LIST, vk::DescriptorType::eStorageBuffer},
    {DMVV_BIND_LEADER_PLACE, vk::DescriptorType::eStorageImage},
    {DMVV_BIND_LEADER_COLOR, vk::DescriptorType::eStorageImage},
    {DMVV_BIND_LEADER_REGION, vk::DescriptorType::eStorageImage},
    {DMVV_BIND_QUEUES, vk::DescriptorType::eStorageBuffer},
    {DMVV_BIND_NEXT, vk::DescriptorType::eStorageBuffer},
    {DMVV_BIND_KNOWN, vk::DescriptorType::eStorageBuffer},
    {DMVV_BIND_FRAME, vk::DescriptorType::eUniformBuffer},
    {DMVV_BIND_RAYS, vk::DescriptorType::eUniformBuffer},
    {DMVV_BIND_RAY_TILES, vk::DescriptorType::eStorageBuffer},
    {DMVV_BIND_RAY_NOTES, vk::DescriptorType::eStorageImage},
    {DMVV_BIND_MEDIA, vk::DescriptorType::eStorageBuffer},
}};

/// Where the parts of a tile stand in the buffer that is read back: each at a multiple of its texels, the largest
/// first.
struct ReadbackLayout {
  vk::DeviceSize positions = 0, colors, regions, notes, bytes;
  ReadbackLayout(std::size_t pixels, const Outputs& outputs);
};

/// What the device counts.
struct TileReport {
  gpu::PixelListHeader pixels;
  gpu::RayTilesHeader rays;
};

/// What stays of a tile between frames. All images are in the layout GENERAL. Those that are not asked for have one
/// pixel.
struct TileImages {
  GpuImage surface;
  GpuImage color, bytes, region;
  GpuImage notes;      ///< of pictures by rays
  GpuBuffer block;     ///< gpu::FrameParams
  GpuBuffer rays;      ///< gpu::RayParams
  GpuBuffer media;     ///< what rays see of media: 16 bytes a pixel, if there are some
  GpuBuffer tiles;     ///< gpu::RayTilesHeader, then two words a tile of rays
  GpuBuffer report;    ///< TileReport, for the host
  GpuBuffer readback;  ///< ReadbackLayout; made when something is first brought home
  DescriptorSet set;
  std::optional<SurfaceKey> drawn;   ///< what `surface` shows
  std::optional<ShadingKey> shaded;  ///< what the images show of it
  bool is_home = false;              ///< and `readback` as well
};

/// What tiles use one after the other.
struct TileScratch {
  GpuImage leader_place, leader_color, leader_region;  ///< of each 4 x 4 pixels
  GpuBuffer list;                                      ///< PixelListHeader, then a word an entry
  GpuBuffer known;                                     ///< a word an entry, if there are verdicts
  GpuBuffer queues, next_stages;                       ///< of programs in stages (shaders/queues.glsl); else nothing
  GpuBuffer slice_surface;                             ///< made for the first slice
};

/// What a program needs of a frame's images.
struct FrameNeeds {
  bool leaders = false;
  bool verdicts = false;
  bool rays = false;
  bool media = false;
  std::uint32_t stages = 0;
};

/// The images of a frame in tiles of up to a size. A frame of up to `most_kept_px` keeps what each of its tiles shows
/// for the next one; the tiles of larger frames share one set of images.
class FrameImages {
 public:
  /// 2560x1440 and 1920x1080 with 2 x 2 samples are less. Some 24 bytes a pixel, 52 of them in float with positions.
  static constexpr std::size_t most_kept_px = std::size_t{10} << 20;

  /// `spare` is the surface of the first tile, if it has the extent.
  FrameImages(const Device::Impl& gpu, const vk::raii::DescriptorSetLayout& layout, vk::Extent2D extent,
              std::size_t tile_count, const Outputs& outputs, const FrameNeeds& needs, std::optional<GpuImage> spare);

  vk::Extent2D extent() const { return extent_; }
  const Outputs& outputs() const { return outputs_; }
  /// Whether a frame in so many tiles finds its images here.
  bool serves(vk::Extent2D extent, std::size_t tile_count, const Outputs& outputs) const;
  /// Whether each of so many tiles has images of its own, which keep what it shows.
  bool keeps(std::size_t tile_count) const { return tiles_.size() >= tile_count; }
  TileImages& of_tile(std::size_t i) { return tiles_[i % tiles_.size()]; }
  TileScratch& scratch() { return scratch_; }
  /// The buffer from which a slice's points are copied, of 16 bytes a pixel.
  GpuBuffer& slice_surface();
  /// The buffer into which what is asked for of a tile is copied for the host.
  GpuBuffer& readback_of(TileImages& tile) const;

 private:
  GpuImage make_image(vk::Format format, vk::Extent3D size) const;
  TileImages make_tile(const vk::raii::DescriptorSetLayout& layout, const FrameNeeds& needs,
                       std::optional<GpuImage> spare) const;
  void make_scratch(const FrameNeeds& needs);
  void make_ready() const;
  static std::size_t kept_tiles(vk::Extent2D extent, std::size_t tile_count);

  const Device::Impl& gpu_;
  vk::Extent2D extent_;
  Outputs outputs_;
  TileScratch scratch_;
  std::vector<TileImages> tiles_;
};

/// What the device counted of a tile.
const TileReport& counted(const TileImages& images);

/// What came back of a tile; null what was not asked for.
struct TilePixels {
  const glm::vec4* colors;
  const std::uint32_t* bytes;
  const glm::uvec4* surface;
  const std::uint32_t* regions;
  const std::uint32_t* notes;
};
TilePixels pixels_of(const TileImages& images, const Tile& tile, const Outputs& outputs);

}  // namespace dmvv::runtime
