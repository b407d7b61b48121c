// Inside the runtime only: draws the cut and capped support mesh into an image of positions and normals.
#pragma once

#include <map>
#include <vector>

#include "runtime/clusters.h"
#include "runtime/gpu.h"
#include "runtime/shot.h"
#include "runtime/surface.h"

namespace dmvv::runtime {

/// What is drawn into. The surface is left in the layout GENERAL, for compute shaders and copies.
struct Targets {
  vk::Extent2D extent;
  GpuImage surface;           ///< shaders/surface.glsl
  GpuBuffer nearest, shells;  ///< of each pixel (shaders/raster.h)
  vk::raii::DescriptorPool pool{nullptr};
  vk::raii::DescriptorSet set{nullptr};
};

class Rasteriser {
 public:
  explicit Rasteriser(const Device::Impl& gpu);

  Targets make_targets(vk::Extent2D extent) const;

  /// Makes `mesh` the one that is drawn. The same mesh again (compared bit by bit) costs a comparison.
  Result<void> set_mesh(const voml::Mesh& mesh);
  const voml::Bounds& bounds() const { return bounds_; }
  /// Another number for each mesh that was set.
  std::uint32_t mesh_serial() const { return mesh_serial_; }
  std::size_t open_edges() const { return open_edges_; }

  /// Whether the kernels for such a view have been made.
  bool is_ready(const Shot& shot) const { return pipelines_.contains(kernel_kind(shot)); }
  /// Records the drawing of one tile, in clusters or as a whole. Writes what the shaders read: the commands must be done
  /// before the next call.
  void draw(const vk::raii::CommandBuffer& commands, const Targets& targets, const Shot& shot, const Tile& tile,
            bool in_clusters);
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
  static KernelKind kernel_kind(const Shot& shot);
  struct Pipelines {
    vk::raii::Pipeline triangles, parts, surface;
  };
  vk::raii::Pipeline make_pipeline(std::span<const std::uint32_t> words, const KernelKind& kind) const;
  const Pipelines& pipelines_for(const Shot& shot);
  void write_runs(std::span<const DrawCall> calls);
  void bind(const Targets& targets) const;

  const Device::Impl& gpu_;
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  std::map<KernelKind, Pipelines> pipelines_;
  GpuBuffer params_, runs_, parts_, part_count_;

  std::optional<voml::Mesh> mesh_;
  std::size_t open_edges_ = 0;
  std::vector<Cluster> clusters_;
  voml::Bounds bounds_{};
  GpuBuffer vertices_, indices_;
  vk::raii::BufferView vertex_texels_{nullptr}, index_texels_{nullptr};
  std::uint32_t mesh_serial_ = 0;
};

/// Copies bytes into a buffer of device memory, by way of a staging buffer.
GpuBuffer upload_buffer(const Device::Impl& gpu, const void* bytes, std::size_t size, vk::BufferUsageFlags usage);

}  // namespace dmvv::runtime
