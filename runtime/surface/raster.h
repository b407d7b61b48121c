// Inside the runtime only: draws the cut and capped support mesh into an image of positions and normals.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "runtime/gpu/descriptors.h"
#include "runtime/surface/clusters.h"
#include "runtime/surface/surface.h"
#include "runtime/view/frame_setup.h"

namespace dmvv::runtime {

/// The tile that is drawn while kernels are compiled.
inline constexpr glm::uvec2 warm_up_px{DMVV_PIXELS_BLOCK, DMVV_PIXELS_BLOCK};

/// A surface image for tiles of this extent.
GpuImage make_surface_image(const Device::Impl& gpu, vk::Extent2D extent);

class Rasteriser {
 public:
  explicit Rasteriser(const Device::Impl& gpu);

  /// Makes what drawing tiles up to this size takes, beside their surfaces.
  void set_extent(vk::Extent2D extent);
  vk::Extent2D extent() const { return extent_; }
  /// A surface that was made and drawn into before, if there is one of this extent; the caller's from then on.
  std::optional<GpuImage> take_surface(vk::Extent2D extent);
  /// Makes a surface and draws a few pixels of a view into it, so that the driver compiles the kernels now; it is kept
  /// for `take_surface`.
  void rehearse(const FrameSetup& setup);

  /// Makes `mesh` the one that is drawn, not null. The same object again costs nothing.
  Result<void> set_mesh(std::shared_ptr<const voml::Mesh> mesh);
  /// The same for one that has been arranged.
  Result<void> set_mesh(std::shared_ptr<const voml::Mesh> mesh, ArrangedMesh arranged);
  const voml::Bounds& bounds() const { return bounds_; }
  /// Another number for each mesh that was set.
  std::uint32_t mesh_serial() const { return mesh_serial_; }
  const voml::EdgeFaults& edges() const { return edges_; }

  /// Whether the kernels for such a view have been made.
  bool is_ready(const FrameSetup& setup) const { return pipelines_.contains(kernel_kind(setup)); }
  /// Records the drawing of one tile into `surface` (shaders/surface.glsl; layout GENERAL, for compute shaders and
  /// copies), in clusters or as a whole. Writes what the shaders read: the commands must be done before the next call.
  void draw(const vk::raii::CommandBuffer& commands, const FrameSetup& setup, const Tile& tile, bool in_clusters,
            const GpuImage& surface);
  /// Once the commands are done: whether all of the mesh has been drawn. It has not if large triangles lie over each
  /// other more often than there is room for.
  bool is_complete() const;

 private:
  /// What the kernels are specialised to (shaders/raster.h).
  struct KernelKind {
    std::uint32_t cuts;
    vk::Bool32 counts;
    friend auto operator<=>(const KernelKind&, const KernelKind&) = default;
  };
  static KernelKind kernel_kind(const FrameSetup& setup);
  struct Pipelines {
    vk::raii::Pipeline triangles, parts, surface;
  };
  /// The code of the kernels that draw, for what the device has.
  struct Code {
    std::span<const std::uint32_t> triangles, parts, surface;
  };
  static Code code_for(const DeviceExtras& extras);
  vk::raii::Pipeline make_pipeline(std::span<const std::uint32_t> words, const KernelKind& kind) const;
  const Pipelines& pipelines_for(const FrameSetup& setup);
  void write_runs(std::span<const DrawCall> calls);
  void bind(const GpuImage& surface);
  vk::DescriptorType descriptor_type(std::uint32_t binding) const;

  const Device::Impl& gpu_;
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  DescriptorSet set_;
  std::map<KernelKind, Pipelines> pipelines_;
  GpuBuffer params_, runs_, parts_, part_count_;
  vk::Extent2D extent_;
  std::optional<GpuImage> spare_;  ///< of this extent
  GpuBuffer nearest_, shells_;     ///< of each pixel (shaders/raster.h)

  std::shared_ptr<const voml::Mesh> mesh_;  ///< the one that is drawn; null before the first
  voml::EdgeFaults edges_;
  std::vector<Cluster> clusters_;
  voml::Bounds bounds_{};
  GpuBuffer vertices_, indices_;
  vk::raii::BufferView vertex_texels_{nullptr}, index_texels_{nullptr};  ///< if the device reads the mesh from texels
  std::uint32_t mesh_serial_ = 0;
};

}  // namespace dmvv::runtime
