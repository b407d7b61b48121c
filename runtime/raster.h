// Inside the runtime only: draws the cut and capped support mesh into an image of positions and normals.
#pragma once

#include <map>
#include <vector>

#include "runtime/clusters.h"
#include "runtime/gpu.h"
#include "runtime/shot.h"
#include "runtime/surface.h"

namespace dmvv::runtime {

inline constexpr vk::Format surface_format = vk::Format::eR32G32B32A32Uint;  // shaders/surface.glsl

/// What is drawn into. The surface is left in the layout GENERAL, for compute shaders and copies.
struct Targets {
  vk::Extent2D extent;
  GpuImage surface, depth_stencil;
  vk::raii::Framebuffer framebuffer{nullptr};
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

  /// Whether the driver has compiled what views with so many cuts need.
  bool is_ready(std::uint32_t cut_count) const;
  /// Records the drawing of one tile, in clusters or as a whole. Writes what the shaders read: the commands must be done
  /// before the next call.
  void draw(const vk::raii::CommandBuffer& commands, const Targets& targets, const Shot& shot, const Tile& tile,
            bool in_clusters);

 private:
  struct PipelineState;
  struct Pipelines {
    std::map<DrawKind, vk::raii::Pipeline> surfaces;
    vk::raii::Pipeline cap{nullptr};
    void draw(const vk::raii::CommandBuffer& commands, const DrawCall& call) const;
    void draw_caps(const vk::raii::CommandBuffer& commands) const;
  };
  vk::raii::Pipeline make_pipeline(const PipelineState& state) const;
  Pipelines make_pipelines(std::uint32_t cut_count) const;
  /// The pipelines for so many cuts. The first time, the driver is made to compile them, by drawing nothing.
  const Pipelines& ready_pipelines(const vk::raii::CommandBuffer& commands, std::uint32_t cut_count);

  const Device::Impl& gpu_;
  vk::Format depth_format_;
  vk::raii::RenderPass pass_{nullptr};
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::ShaderModule surface_vertex_, surface_fragment_, cap_vertex_, cap_fragment_;
  std::map<std::uint32_t, Pipelines> pipelines_;  // by the number of cuts; from most_compiled_cuts on, for any number
  GpuBuffer params_;
  vk::raii::DescriptorPool descriptor_pool_{nullptr};
  vk::raii::DescriptorSet set_{nullptr};

  std::optional<voml::Mesh> mesh_;
  std::size_t open_edges_ = 0;
  std::vector<Cluster> clusters_, whole_;  ///< whole_: as two, those whose backs are not seen and the others
  voml::Bounds bounds_{};
  GpuBuffer vertices_, indices_;
  std::uint32_t mesh_serial_ = 0;
};

/// Copies bytes into a buffer of device memory, by way of a staging buffer.
GpuBuffer upload_buffer(const Device::Impl& gpu, const void* bytes, std::size_t size, vk::BufferUsageFlags usage);

}  // namespace dmvv::runtime
