// Inside the runtime only: draws the cut and capped support mesh into an image of positions and normals.
#pragma once

#include <map>
#include <vector>

#include "runtime/gpu/gpu.h"
#include "runtime/surface/clusters.h"
#include "runtime/surface/surface.h"
#include "runtime/view/frame_setup.h"

namespace dmvv::runtime {

/// The tile that is drawn while kernels are compiled.
inline constexpr glm::uvec2 warm_up_px{DMVV_PIXELS_BLOCK, DMVV_PIXELS_BLOCK};

class Rasteriser {
 public:
  explicit Rasteriser(const Device::Impl& gpu);

  /// Makes what tiles up to this size are drawn into.
  void set_extent(vk::Extent2D extent);
  vk::Extent2D extent() const { return extent_; }
  /// Of the tile that was drawn last (shaders/surface.glsl). Drawing leaves it in the layout GENERAL, for compute shaders and
  /// copies.
  const GpuImage& surface() const { return surface_; }

  /// Makes `mesh` the one that is drawn. The same mesh again (compared bit by bit) costs a comparison.
  Result<void> set_mesh(const voml::Mesh& mesh);
  /// The same for one that has been arranged.
  Result<void> set_mesh(const voml::Mesh& mesh, ArrangedMesh arranged);
  const voml::Bounds& bounds() const { return bounds_; }
  /// Another number for each mesh that was set.
  std::uint32_t mesh_serial() const { return mesh_serial_; }
  const voml::EdgeFaults& edges() const { return edges_; }

  /// Whether the kernels for such a view have been made.
  bool is_ready(const FrameSetup& setup) const { return pipelines_.contains(kernel_kind(setup)); }
  /// Records the drawing of one tile, in clusters or as a whole. Writes what the shaders read: the commands must be done
  /// before the next call.
  void draw(const vk::raii::CommandBuffer& commands, const FrameSetup& setup, const Tile& tile, bool in_clusters);
  /// Once the commands are done: whether all of the mesh has been drawn. It has not if large triangles lie over each other
  /// more often than there is room for.
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
  void bind();
  vk::DescriptorType descriptor_type(std::uint32_t binding) const;

  const Device::Impl& gpu_;
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::raii::DescriptorSet set_{nullptr};
  bool is_bound_ = false;  ///< the set names the buffers and images below
  std::map<KernelKind, Pipelines> pipelines_;
  GpuBuffer params_, runs_, parts_, part_count_;
  vk::Extent2D extent_;
  GpuImage surface_;
  GpuBuffer nearest_, shells_;  ///< of each pixel (shaders/raster.h)

  std::optional<voml::Mesh> mesh_;
  voml::EdgeFaults edges_;
  std::vector<Cluster> clusters_;
  voml::Bounds bounds_{};
  GpuBuffer vertices_, indices_;
  vk::raii::BufferView vertex_texels_{nullptr}, index_texels_{nullptr};  ///< if the device reads the mesh from texels
  std::uint32_t mesh_serial_ = 0;
};

}  // namespace dmvv::runtime
