// Inside the runtime only: a program's buffers, textures and kernels on a device.
#pragma once

#include <array>
#include <map>

#include "runtime/frame/autotuner.h"
#include "runtime/frame/verdicts.h"
#include "runtime/gpu/gpu.h"
#include "runtime/surface/raster.h"

namespace dmvv::runtime {

/// A compute kernel: descriptor set 0 is the scene, set 1 its own input and output, set 2, if it has one, the verdicts.
struct KernelPipeline {
  vk::raii::DescriptorSetLayout io_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

/// What a frame brings back: the kernel is specialised to it.
struct Outputs {
  Colors colors = Colors::floats;
  bool regions = false;
  bool positions = false;
  friend bool operator==(const Outputs&, const Outputs&) = default;
};

/// All that a tile's surface depends on; equal bytes are equal surfaces.
struct SurfaceKey {
  gpu::RasterParams raster{};
  std::optional<SliceFrame> slice;
  std::uint32_t mesh_serial = 0;
  bool has_caps = false;
  Tile tile;
};
bool operator==(const SurfaceKey& a, const SurfaceKey& b);

/// All that a tile's colours depend on beside its surface.
struct ShadingKey {
  gpu::PixelsParams params{};
  std::vector<float> time_values;
};
bool operator==(const ShadingKey& a, const ShadingKey& b);

/// The images and buffers of tiles up to a size, and what they hold now.
struct FrameImages {
  vk::Extent2D extent;
  Outputs outputs;
  GpuImage color, bytes, region;  ///< those that are not wanted have one pixel
  GpuImage leader_place, leader_color, leader_region;  ///< of each tile of DMVV_LEADER_TILE; likewise
  GpuBuffer list;                 ///< PixelListHeader, then a word an entry
  GpuBuffer known;                ///< a word an entry, if there are verdicts
  GpuBuffer queues, next_stages;  ///< of programs in stages (shaders/queues.glsl); else nothing
  GpuBuffer readback;             ///< positions if wanted, colours, region numbers if wanted, a PixelListHeader
  GpuBuffer slice_surface;        ///< made for the first slice
  vk::raii::DescriptorPool pool{nullptr};
  vk::raii::DescriptorSet io_set{nullptr};
  std::optional<SurfaceKey> surface;  ///< of the tile that was drawn last
  std::optional<ShadingKey> shaded;   ///< of the tile in readback and in the images; then `surface` is its surface
};

/// The passes of a frame (frame_pass_names) that are on.
struct FramePasses {
  bool pixel_list = true;
  bool keep_surface = true;
  bool keep_picture = true;
  bool verdicts = true;
  bool keep_still = true;
  bool clusters = true;
  bool reach = true;
  bool trials = true;
};

/// How a tile's pixels are evaluated.
struct Strategy {
  static constexpr std::size_t count = 4;
  bool classifies = false;  ///< by verdicts
  bool leads = false;       ///< leaders first
  std::size_t number() const { return (classifies ? 1u : 0u) + (leads ? 2u : 0u); }
  /// Of each number: trees of verdicts grow where they are asked.
  static std::vector<bool> learns() { return {false, true, false, true}; }
  static constexpr Strategy of_number(std::size_t number) { return {(number & 1u) != 0, (number & 2u) != 0}; }
};

/// Programs may rely on times within compiler::any_time_ms.
std::optional<Error> time_fault(double time_ms);

struct Evaluator::Impl {
  const Device::Impl& gpu;
  std::array<std::vector<std::uint32_t>, compiler::kernel_count> code;
  std::vector<compiler::Stage> stages;  ///< if there are any, in place of the kernel `pixels`
  std::uint32_t depth;

  std::vector<compiler::TimeFunction> time_functions;
  std::shared_ptr<const compiler::Judge> judge;  ///< may be null
  bool has_bitmaps;                              ///< the scene set has DMVV_BIND_BITMAP_ATLAS
  double now_ms = 0.0;             ///< the time of the frame
  std::vector<float> time_values;  ///< likewise
  std::optional<std::size_t> time_buffer;  ///< index into buffers: mapped, written before each evaluation

  std::vector<GpuBuffer> buffers;
  std::vector<vk::raii::BufferView> views;  ///< of each of them; null for those that are no texels
  std::vector<GpuImage> textures;
  vk::raii::Sampler sampler{nullptr};
  vk::raii::DescriptorSetLayout scene_layout{nullptr};
  vk::raii::DescriptorPool scene_pool{nullptr};
  vk::raii::DescriptorSet scene_set{nullptr};

  // Made when first needed.
  std::optional<KernelPipeline> points, list, count_groups, classify, count_hits, distribute, count_stages;
  std::map<std::array<vk::Bool32, 3>, std::vector<KernelPipeline>> pixels;  ///< by the specialisation constants: each stage, or all
  std::map<std::array<vk::Bool32, 3>, KernelPipeline> leaders, follow, paint;  ///< likewise
  std::optional<Verdicts> verdicts;
  Autotuner autotuner{Strategy::count, Strategy{.classifies = true, .leads = false}.number(), Strategy::learns()};
  double compile_ms = 0.0, drawn_ms = 0.0;  ///< what the pixels' kernel took to compile; what frames have taken since
  bool has_drawn = false;  ///< a frame beyond the warm-up: another one may follow, and verdicts pay
  std::unique_ptr<Rasteriser> rasteriser;
  std::optional<FrameImages> frame;

  Impl(const Device::Impl& device, const compiler::Program& program, PreparedSurface prepared);
  /// `constants` are the specialisation constants 0, 1, ...
  Result<KernelPipeline> make_kernel(compiler::Kernel kernel, std::span<const vk::DescriptorType> io,
                                     std::uint32_t params_bytes, std::span<const vk::Bool32> constants = {}) const;
  Result<KernelPipeline> make_kernel(std::span<const std::uint32_t> words, std::string_view name,
                                     std::span<const vk::DescriptorType> io, std::uint32_t params_bytes,
                                     std::span<const vk::Bool32> constants) const;
  KernelPipeline make_pipeline(std::span<const std::uint32_t> words, std::span<const vk::DescriptorType> io,
                               std::uint32_t params_bytes, std::span<const vk::Bool32> constants,
                               const vk::raii::DescriptorSetLayout* verdict_layout = nullptr) const;
  vk::raii::DescriptorPool make_pool(std::span<const vk::DescriptorType> types) const;
  vk::raii::DescriptorSet make_set(const vk::raii::DescriptorPool& pool,
                                   const vk::raii::DescriptorSetLayout& layout) const;

  Result<std::vector<compiler::PointAnswer>> probe(std::span<const glm::dvec3> positions, double time_ms, Timings* timings);
  Result<Picture> render(const View& view, Timings* timings);

 private:
  void set_time(double time_ms);
  void upload(const compiler::Program& program);
  void make_views(const compiler::Program& program);
  void bind_scene(const compiler::Program& program);
  Result<void> warm_up(const FrameSetup& setup, vk::Extent2D extent, const Outputs& outputs, const FramePasses& passes,
                       Timings* timings);
  FrameImages make_frame(vk::Extent2D extent, const Outputs& outputs) const;
  bool has_leaders() const { return !code[static_cast<std::size_t>(compiler::Kernel::leaders)].empty(); }
  Result<void> make_pixels(const std::array<vk::Bool32, 3>& constants);
  Strategy choose_strategy(const FramePasses& passes);
  void make_verdicts(const Outputs& outputs);
  void make_leaders(const Outputs& outputs);
  void prepare_images(const vk::raii::CommandBuffer& commands, bool kept, bool clears, const Strategy& strategy);
  void evaluate_tile(const vk::raii::CommandBuffer& commands, const gpu::PixelsParams& params, const FramePasses& passes,
                     const Strategy& strategy);
  /// Returns the milliseconds on the device (Device::Impl::run); 0 where the frame held the tile already.
  double render_tile(const FrameSetup& setup, const Tile& tile, const FramePasses& passes);
};

}  // namespace dmvv::runtime
