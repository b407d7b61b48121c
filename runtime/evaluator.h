// Inside the runtime only: a program's buffers, textures and kernels on a device.
#pragma once

#include <array>

#include "runtime/gpu.h"
#include "runtime/raster.h"

namespace dmvv::runtime {

/// A compute kernel: descriptor set 0 is the scene, set 1 its own input and output.
struct KernelPipeline {
  vk::raii::DescriptorSetLayout io_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

/// The images and buffers of tiles up to a size.
struct Frame {
  Targets targets;
  GpuImage color, region;
  GpuBuffer readback;  ///< colours, then positions (if needed), then region numbers, of a whole tile
  bool has_positions = false;
  GpuBuffer slice_positions;  ///< made for the first slice
  vk::raii::DescriptorPool pool{nullptr};
  vk::raii::DescriptorSet io_set{nullptr};
};

struct Evaluator::Impl {
  const Device::Impl& gpu;
  std::array<std::vector<std::uint32_t>, compiler::kernel_count> code;
  std::uint32_t depth;

  std::vector<compiler::TimeFunction> time_functions;
  std::optional<std::size_t> time_buffer;  ///< index into buffers: mapped, written before each evaluation

  std::vector<GpuBuffer> buffers;
  std::vector<GpuImage> textures;
  vk::raii::Sampler sampler{nullptr};
  vk::raii::DescriptorSetLayout scene_layout{nullptr};
  vk::raii::DescriptorPool scene_pool{nullptr};
  vk::raii::DescriptorSet scene_set{nullptr};

  // Made when first needed.
  std::optional<KernelPipeline> points, pixels;
  std::optional<Rasteriser> rasteriser;
  std::optional<Frame> frame;
  std::array<bool, 3> warm{};  ///< slices, surfaces, cut surfaces: pipelines made and compiled by the driver

  Impl(const Device::Impl& device, const compiler::Program& program);
  Result<KernelPipeline> make_kernel(compiler::Kernel kernel, std::span<const vk::DescriptorType> io,
                                     std::uint32_t params_bytes) const;
  vk::raii::DescriptorPool make_pool(std::span<const vk::DescriptorType> types) const;
  vk::raii::DescriptorSet make_set(const vk::raii::DescriptorPool& pool,
                                   const vk::raii::DescriptorSetLayout& layout) const;

  Result<std::vector<compiler::PointAnswer>> probe(std::span<const glm::dvec3> positions, double time_ms, Timings* timings);
  Result<Picture> render(const View& view, Timings* timings);

 private:
  void set_time(double time_ms);
  void upload(const compiler::Program& program);
  void bind_scene(const compiler::Program& program);
  Result<void> warm_up(const Shot& shot, vk::Extent2D extent, bool with_positions, Timings* timings);
  Frame make_frame(vk::Extent2D extent, bool with_positions) const;
  /// Returns the milliseconds on the device (Device::Impl::run).
  double render_tile(Frame& target, const Shot& shot, const Tile& tile);
};

}  // namespace dmvv::runtime
