// The raster kernels: the nearest triangle of each pixel, then its surface or a cap.
//
// Support meshes are fine, of some two pixels a triangle, and made of as many triangles as a frame has pixels or more.
// For those compute shaders are faster than the fixed pipeline of a GPU (Karis, Stubbe and Wihlidal 2021, Nanite), and
// by far than lavapipe's, which shades vertices and sets triangles up in one thread.
//
// A cap is drawn where the solid is inside at the point where a pixel's ray comes into the part that all cuts leave.
// Counting tells: of the mesh's fragments beyond that point, those that leave the solid minus those that enter it are
// the shells around the point, whatever the mesh's shape (Crow 1977, shadow volumes). One counting serves all cuts,
// since the kept part is convex and every ray enters it once.
#include "runtime/surface/raster.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/packing.hpp>
#include <span>
#include <utility>

#include "runtime/gpu/uploads.h"
#include "spirv/raster_parts_comp.h"
#include "spirv/raster_parts_long_comp.h"
#include "spirv/raster_parts_long_texels_comp.h"
#include "spirv/raster_parts_texels_comp.h"
#include "spirv/raster_surface_comp.h"
#include "spirv/raster_surface_texels_comp.h"
#include "spirv/raster_triangles_comp.h"
#include "spirv/raster_triangles_long_comp.h"
#include "spirv/raster_triangles_long_texels_comp.h"
#include "spirv/raster_triangles_texels_comp.h"

namespace dmvv::runtime {
namespace {

constexpr std::uint32_t most_compiled_cuts = 3;  // beyond, kernels are made for any number
constexpr std::uint32_t any_cuts = 0xffffffffu;
constexpr std::uint32_t most_groups = 65535;                      // every device has so many along an axis
constexpr vk::DeviceSize part_header_bytes = 16, part_bytes = 8;  // shaders/parts.glsl

using Access = vk::AccessFlagBits;
using Layout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits;
using Usage = vk::BufferUsageFlagBits;

/// A vertex as the kernels read it: shaders/surface.glsl folds normals likewise.
glm::uvec4 vertex_texel(const SurfaceVertex& vertex) {
  const glm::vec3& n = vertex.normal;
  const float length = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  glm::vec2 folded = length > 0.0f ? glm::vec2(n) / length : glm::vec2(0.0f);
  if (n.z < 0.0f) {
    folded = (1.0f - glm::abs(glm::vec2(folded.y, folded.x))) *
             glm::vec2(folded.x >= 0.0f ? 1.0f : -1.0f, folded.y >= 0.0f ? 1.0f : -1.0f);
  }
  return {glm::floatBitsToUint(vertex.position), glm::packSnorm2x16(folded)};
}

std::optional<Error> size_fault(const Device::Impl& gpu, const Surface& surface) {
  const std::size_t words =
      gpu.extras.large_texel_buffers ? gpu.limits.maxTexelBufferElements : gpu.limits.maxStorageBufferRange / 4;
  const std::size_t most = std::min(words, 3 * std::size_t{DMVV_DRAWN_TRIANGLE});
  if (surface.indices.size() <= most) return std::nullopt;
  return Error{Fault::input,
               fmt::format("the support mesh has {} triangles; '{}' can draw {}", surface.indices.size() / 3,
                           gpu.info.name, most / 3),
               {"use a coarser mesh: boundaries within it stay as sharp"}};
}

void wait(const vk::raii::CommandBuffer& commands, vk::PipelineStageFlags before, vk::AccessFlags written,
          vk::PipelineStageFlags after, vk::AccessFlags used) {
  commands.pipelineBarrier(before, after, {}, vk::MemoryBarrier{.srcAccessMask = written, .dstAccessMask = used},
                           nullptr, nullptr);
}

}  // namespace

vk::DescriptorType Rasteriser::descriptor_type(std::uint32_t binding) const {
  switch (binding) {
    case DMVV_RASTER_PARAMS:
      return vk::DescriptorType::eUniformBuffer;
    case DMVV_RASTER_VERTICES:
    case DMVV_RASTER_INDICES:
      return gpu_.extras.large_texel_buffers ? vk::DescriptorType::eStorageTexelBuffer
                                             : vk::DescriptorType::eStorageBuffer;
    case DMVV_RASTER_SURFACE:
      return vk::DescriptorType::eStorageImage;
    default:
      return vk::DescriptorType::eStorageBuffer;
  }
}

Rasteriser::Rasteriser(const Device::Impl& gpu) : gpu_(gpu) {
  std::vector<SetBinding> bindings;
  for (std::uint32_t i = 0; i < DMVV_RASTER_BINDINGS; ++i) bindings.push_back({i, descriptor_type(i)});
  set_layout_ = make_set_layout(gpu_, bindings);
  layout_ = make_pipeline_layout(gpu_, std::array{*set_layout_}, sizeof(std::uint32_t));
  set_ = DescriptorSet(gpu_, set_layout_, bindings);
  params_ = gpu_.make_buffer(sizeof(gpu::RasterParams), Usage::eUniformBuffer, MemoryUse::upload);
  parts_ = gpu_.make_buffer(part_header_bytes + part_bytes * DMVV_MOST_PARTS,
                            Usage::eStorageBuffer | Usage::eTransferSrc | Usage::eTransferDst, MemoryUse::device);
  part_count_ = gpu_.make_buffer(sizeof(std::uint32_t), Usage::eTransferDst, MemoryUse::readback);
}

void Rasteriser::set_extent(vk::Extent2D extent) {
  if (extent == extent_) return;
  const vk::DeviceSize pixels = vk::DeviceSize{extent.width} * extent.height;
  extent_ = vk::Extent2D{};
  spare_.reset();
  nearest_ = gpu_.make_buffer(8 * pixels, Usage::eStorageBuffer | Usage::eTransferDst, MemoryUse::device);
  shells_ = gpu_.make_buffer(4 * pixels, Usage::eStorageBuffer | Usage::eTransferDst, MemoryUse::device);
  extent_ = extent;
}

GpuImage make_surface_image(const Device::Impl& gpu, vk::Extent2D extent) {
  using ImageUsage = vk::ImageUsageFlagBits;
  return gpu.make_image(vk::ImageType::e2D, vk::Format::eR32G32B32A32Uint, {extent.width, extent.height, 1},
                        ImageUsage::eStorage | ImageUsage::eTransferSrc | ImageUsage::eTransferDst);
}

std::optional<GpuImage> Rasteriser::take_surface(vk::Extent2D extent) {
  return extent == extent_ ? std::exchange(spare_, std::nullopt) : std::nullopt;
}

void Rasteriser::rehearse(const FrameSetup& setup) {
  spare_ = make_surface_image(gpu_, extent_);
  const Tile corner{{0, 0}, glm::min(warm_up_px, setup.size_px)};
  const bool in_clusters = true;
  gpu_.run([&](const vk::raii::CommandBuffer& commands) {
    commands.pipelineBarrier(Stage::eTopOfPipe, Stage::eComputeShader, {}, nullptr, nullptr,
                             color_barrier(*spare_, Layout::eUndefined, Layout::eGeneral, {}, Access::eShaderWrite));
    draw(commands, setup, corner, in_clusters, *spare_);
  });
}

Result<void> Rasteriser::set_mesh(std::shared_ptr<const voml::Mesh> mesh) {
  if (mesh_ == mesh) return {};
  auto arranged = arrange_mesh(*mesh);
  return arranged ? set_mesh(std::move(mesh), std::move(*arranged)) : tl::unexpected(std::move(arranged.error()));
}

Result<void> Rasteriser::set_mesh(std::shared_ptr<const voml::Mesh> mesh, ArrangedMesh arranged) {
  const Surface& surface = arranged.surface;
  if (auto fault = size_fault(gpu_, surface)) return tl::unexpected(std::move(*fault));
  std::vector<glm::uvec4> vertices(surface.vertices.size());
  std::ranges::transform(surface.vertices, vertices.begin(), vertex_texel);
  mesh_.reset();  // a failure below must not leave the old mesh's name on the new one's buffers
  edges_ = arranged.edges;
  clusters_ = std::move(arranged.clusters);
  const bool as_texels = gpu_.extras.large_texel_buffers;
  Uploads uploads(gpu_);
  const auto upload = [&](const auto& texels, GpuBuffer& buffer, vk::raii::BufferView& view, vk::Format format) {
    view = nullptr;
    buffer = uploads.add_buffer(std::as_bytes(std::span(texels)),
                                as_texels ? Usage::eStorageTexelBuffer : Usage::eStorageBuffer);
    if (as_texels)
      view = gpu_.device.createBufferView({.buffer = *buffer.buffer, .format = format, .range = VK_WHOLE_SIZE});
  };
  upload(vertices, vertices_, vertex_texels_, vk::Format::eR32G32B32A32Uint);
  upload(surface.indices, indices_, index_texels_, vk::Format::eR32Uint);
  uploads.finish();
  runs_ = gpu_.make_buffer(clusters_.size() * sizeof(gpu::TriangleRun), Usage::eStorageBuffer, MemoryUse::upload);
  bounds_ = surface.bounds;
  mesh_ = std::move(mesh);
  ++mesh_serial_;
  return {};
}

Rasteriser::KernelKind Rasteriser::kernel_kind(const FrameSetup& setup) {
  return {setup.raster.cut_count <= most_compiled_cuts ? setup.raster.cut_count : any_cuts, setup.has_caps};
}

vk::raii::Pipeline Rasteriser::make_pipeline(std::span<const std::uint32_t> words, const KernelKind& kind) const {
  static_assert(DMVV_RASTER_CUTS == 0 && DMVV_RASTER_COUNTS == 1);
  return make_compute_pipeline(gpu_, words, layout_, std::array{kind.cuts, kind.counts});
}

Rasteriser::Code Rasteriser::code_for(const DeviceExtras& extras) {
  if (extras.long_atomics && extras.large_texel_buffers)
    return {raster_triangles_long_texels_comp, raster_parts_long_texels_comp, raster_surface_texels_comp};
  if (extras.long_atomics) return {raster_triangles_long_comp, raster_parts_long_comp, raster_surface_comp};
  if (extras.large_texel_buffers)
    return {raster_triangles_texels_comp, raster_parts_texels_comp, raster_surface_texels_comp};
  return {raster_triangles_comp, raster_parts_comp, raster_surface_comp};
}

const Rasteriser::Pipelines& Rasteriser::pipelines_for(const FrameSetup& setup) {
  const KernelKind kind = kernel_kind(setup);
  const auto found = pipelines_.find(kind);
  if (found != pipelines_.end()) return found->second;
  const Code code = code_for(gpu_.extras);
  return pipelines_
      .emplace(kind, Pipelines{make_pipeline(code.triangles, kind), make_pipeline(code.parts, kind),
                               make_pipeline(code.surface, kind)})
      .first->second;
}

void Rasteriser::write_runs(std::span<const DrawCall> calls) {
  auto* run = static_cast<gpu::TriangleRun*>(runs_.mapped);
  for (const auto& [kind, indices] : calls) {
    const std::uint32_t drawn = (kind.is_seen ? DMVV_DRAWN_SEEN : 0) | (kind.counts ? DMVV_DRAWN_COUNTED : 0) |
                                (kind.is_cut ? DMVV_DRAWN_CUT : 0) | (kind.shows_backs ? DMVV_DRAWN_BACKS : 0);
    *run++ = {indices.first / 3 | drawn, indices.count / 3};
  }
}

void Rasteriser::bind(const GpuImage& surface) {
  const bool as_texels = gpu_.extras.large_texel_buffers;
  const auto write_mesh = [&](std::uint32_t binding, const GpuBuffer& buffer, const vk::raii::BufferView& texels) {
    if (as_texels)
      set_.write(binding, texels);
    else
      set_.write(binding, buffer);
  };
  set_.write(DMVV_RASTER_PARAMS, params_);
  write_mesh(DMVV_RASTER_VERTICES, vertices_, vertex_texels_);
  write_mesh(DMVV_RASTER_INDICES, indices_, index_texels_);
  set_.write(DMVV_RASTER_RUNS, runs_);
  set_.write(DMVV_RASTER_NEAREST, nearest_);
  set_.write(DMVV_RASTER_SHELLS, shells_);
  set_.write(DMVV_RASTER_PARTS, parts_);
  set_.write(DMVV_RASTER_SURFACE, surface);
}

void Rasteriser::draw(const vk::raii::CommandBuffer& commands, const FrameSetup& setup, const Tile& tile,
                      bool in_clusters, const GpuImage& surface) {
  const auto calls = in_clusters ? plan_draw(clusters_, setup, tile, setup.eye_within)
                                 : plan_whole(clusters_, setup, setup.eye_within);
  gpu::RasterParams params = setup.raster;
  params.tile = {tile.corner_px, tile.size_px};
  params.run_count = static_cast<std::uint32_t>(calls.size());
  std::memcpy(params_.mapped, &params, sizeof params);
  write_runs(calls);
  bind(surface);

  const Pipelines& kernels = pipelines_for(setup);
  const vk::DeviceSize pixels = vk::DeviceSize{tile.size_px.x} * tile.size_px.y;
  commands.fillBuffer(*nearest_.buffer, 0, 8 * pixels, 0);
  if (setup.has_caps) commands.fillBuffer(*shells_.buffer, 0, 4 * pixels, 0);
  commands.fillBuffer(*parts_.buffer, 0, part_header_bytes, 0);
  commands.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer, Stage::eComputeShader, {},
                           vk::MemoryBarrier{.srcAccessMask = Access::eTransferWrite,
                                             .dstAccessMask = Access::eShaderRead | Access::eShaderWrite},
                           nullptr, nullptr);
  constexpr auto compute = vk::PipelineBindPoint::eCompute;
  commands.bindDescriptorSets(compute, *layout_, 0, *set_, nullptr);
  const auto run = [&](const vk::raii::Pipeline& kernel, std::uint32_t across, std::uint32_t down) {
    commands.bindPipeline(compute, *kernel);
    commands.dispatch(across, down, 1);
    wait(commands, Stage::eComputeShader, Access::eShaderWrite, Stage::eComputeShader | Stage::eTransfer,
         Access::eShaderRead | Access::eShaderWrite | Access::eTransferRead);
  };
  for (const std::uint32_t step : {DMVV_STEP_DEPTHS, DMVV_STEP_NUMBERS}) {
    if (gpu_.extras.long_atomics && step != DMVV_STEP_DEPTHS) break;  // one step finds both
    commands.pushConstants<std::uint32_t>(*layout_, vk::ShaderStageFlagBits::eCompute, 0, step);
    run(kernels.triangles, std::clamp(params.run_count, 1u, most_groups), 1);
    run(kernels.parts, DMVV_GROUPS_OF_PARTS, 1);
  }
  run(kernels.surface, (tile.size_px.x + DMVV_RUN_TRIANGLES - 1) / DMVV_RUN_TRIANGLES,
      (tile.size_px.y + DMVV_COLUMN_PX - 1) / DMVV_COLUMN_PX);
  commands.copyBuffer(*parts_.buffer, *part_count_.buffer, vk::BufferCopy{0, 0, sizeof(std::uint32_t)});
  wait(commands, Stage::eTransfer, Access::eTransferWrite, Stage::eHost, Access::eHostRead);
}

bool Rasteriser::is_complete() const {
  return *static_cast<const std::uint32_t*>(part_count_.mapped) <= DMVV_MOST_PARTS;
}

}  // namespace dmvv::runtime
