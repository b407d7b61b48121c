// The raster passes: the surface that the cuts leave, then the caps.
//
// A cap is drawn where the solid is inside at the point where a pixel's ray comes into the part that all cuts leave.
// Counting tells: of the mesh's fragments beyond that point, those that leave the solid minus those that enter it are
// the shells around the point, whatever the mesh's shape (Crow 1977, shadow volumes; stencil counting as in Heidmann
// 1991). One counting pass serves all cuts, since the kept part is convex and every ray enters it once.
//
// Where the eye is removed, all that stays lies behind the caps; where it is left, all that stays lies before them. So a
// cap needs no depth of its own.
#include "runtime/raster.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

#include "spirv/cap_frag.h"
#include "spirv/screen_vert.h"
#include "spirv/surface_frag.h"
#include "spirv/surface_vert.h"

namespace dmvv::runtime {
namespace {

constexpr std::uint32_t most_compiled_cuts = 4;  // from here on, shaders are made for any number
constexpr float smallest_depth = 1.0f / (1 << 24);  // that every format tells from 0

using Access = vk::AccessFlagBits;
using Stage = vk::PipelineStageFlagBits;

/// One of the two is offered by every device.
vk::Format choose_depth_format(const vk::raii::PhysicalDevice& physical) {
  for (const vk::Format format : {vk::Format::eD32SfloatS8Uint, vk::Format::eD24UnormS8Uint}) {
    const auto features = physical.getFormatProperties(format).optimalTilingFeatures;
    if (features & vk::FormatFeatureFlagBits::eDepthStencilAttachment) return format;
  }
  throw vk::FormatNotSupportedError("no format for depth and stencil");
}

vk::raii::RenderPass make_pass(const vk::raii::Device& device, vk::Format depth_format) {
  const auto color = [](vk::Format format) {
    return vk::AttachmentDescription{.format = format,
                                     .samples = vk::SampleCountFlagBits::e1,
                                     .loadOp = vk::AttachmentLoadOp::eClear,
                                     .storeOp = vk::AttachmentStoreOp::eStore,
                                     .initialLayout = vk::ImageLayout::eUndefined,
                                     .finalLayout = vk::ImageLayout::eGeneral};
  };
  const vk::AttachmentDescription depth{.format = depth_format,
                                        .samples = vk::SampleCountFlagBits::e1,
                                        .loadOp = vk::AttachmentLoadOp::eClear,
                                        .storeOp = vk::AttachmentStoreOp::eDontCare,
                                        .stencilLoadOp = vk::AttachmentLoadOp::eClear,
                                        .stencilStoreOp = vk::AttachmentStoreOp::eDontCare,
                                        .initialLayout = vk::ImageLayout::eUndefined,
                                        .finalLayout = vk::ImageLayout::eDepthStencilAttachmentOptimal};
  const std::array attachments{color(surface_format), depth};
  const vk::AttachmentReference color_reference{0, vk::ImageLayout::eColorAttachmentOptimal};
  const vk::AttachmentReference depth_reference{1, vk::ImageLayout::eDepthStencilAttachmentOptimal};
  const vk::SubpassDescription subpass{.pipelineBindPoint = vk::PipelineBindPoint::eGraphics,
                                       .colorAttachmentCount = 1,
                                       .pColorAttachments = &color_reference,
                                       .pDepthStencilAttachment = &depth_reference};
  constexpr auto depth_tests = Stage::eEarlyFragmentTests | Stage::eLateFragmentTests;
  const std::array dependencies{
      vk::SubpassDependency{
          .srcSubpass = VK_SUBPASS_EXTERNAL,
          .dstSubpass = 0,
          .srcStageMask = Stage::eComputeShader | Stage::eTransfer | Stage::eColorAttachmentOutput | depth_tests,
          .dstStageMask = Stage::eColorAttachmentOutput | depth_tests,
          .srcAccessMask = Access::eColorAttachmentWrite | Access::eDepthStencilAttachmentWrite,
          .dstAccessMask = Access::eColorAttachmentWrite | Access::eDepthStencilAttachmentRead |
                           Access::eDepthStencilAttachmentWrite},
      vk::SubpassDependency{.srcSubpass = 0,
                            .dstSubpass = VK_SUBPASS_EXTERNAL,
                            .srcStageMask = Stage::eColorAttachmentOutput,
                            .dstStageMask = Stage::eComputeShader | Stage::eTransfer,
                            .srcAccessMask = Access::eColorAttachmentWrite,
                            .dstAccessMask = Access::eShaderRead | Access::eTransferRead}};
  return device.createRenderPass({.attachmentCount = attachments.size(),
                                  .pAttachments = attachments.data(),
                                  .subpassCount = 1,
                                  .pSubpasses = &subpass,
                                  .dependencyCount = dependencies.size(),
                                  .pDependencies = dependencies.data()});
}

vk::StencilOpState stencil(vk::CompareOp compare, vk::StencilOp pass) {
  return {.failOp = vk::StencilOp::eKeep,
          .passOp = pass,
          .depthFailOp = vk::StencilOp::eKeep,
          .compareOp = compare,
          .compareMask = 0xff,
          .writeMask = 0xff,
          .reference = 0};
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

bool same_mesh(const voml::Mesh& a, const voml::Mesh& b) {
  return same_bits(a.positions, b.positions) && same_bits(a.triangles, b.triangles);
}

}  // namespace

/// In what the pipelines differ.
struct Rasteriser::PipelineState {
  const vk::raii::ShaderModule& vertex;
  const vk::raii::ShaderModule& fragment;
  DrawKind kind;           ///< what counts writes into the stencil, nothing else
  std::uint32_t cuts = 0;  ///< as they are compiled in (shaders/cuts.glsl)
  bool is_cap = false;     ///< where the stencil has counted something
};

vk::raii::Pipeline Rasteriser::make_pipeline(const PipelineState& state) const {
  const bool counts = state.kind.counts;
  const std::array<std::uint32_t, 3> values{state.cuts, state.kind.is_cut, counts};
  std::array<vk::SpecializationMapEntry, values.size()> entries;
  for (std::uint32_t i = 0; i < entries.size(); ++i) entries[i] = vk::SpecializationMapEntry{i, 4 * i, 4};
  const vk::SpecializationInfo constants{entries.size(), entries.data(), sizeof values, values.data()};
  const std::array stages{
      vk::PipelineShaderStageCreateInfo{
          .stage = vk::ShaderStageFlagBits::eVertex, .module = *state.vertex, .pName = "main"},
      vk::PipelineShaderStageCreateInfo{.stage = vk::ShaderStageFlagBits::eFragment,
                                        .module = *state.fragment,
                                        .pName = "main",
                                        .pSpecializationInfo = &constants}};

  const vk::VertexInputBindingDescription binding{0, sizeof(SurfaceVertex), vk::VertexInputRate::eVertex};
  const std::array attributes{
      vk::VertexInputAttributeDescription{0, 0, vk::Format::eR32G32B32Sfloat, offsetof(SurfaceVertex, position)},
      vk::VertexInputAttributeDescription{1, 0, vk::Format::eR32G32B32Sfloat, offsetof(SurfaceVertex, normal)}};
  vk::PipelineVertexInputStateCreateInfo input;
  if (!state.is_cap) input.setVertexBindingDescriptions(binding).setVertexAttributeDescriptions(attributes);
  const vk::PipelineInputAssemblyStateCreateInfo assembly{.topology = vk::PrimitiveTopology::eTriangleList};
  const vk::PipelineViewportStateCreateInfo viewport{.viewportCount = 1, .scissorCount = 1};
  const vk::PipelineRasterizationStateCreateInfo rasterization{
      .cullMode = state.kind.shows_backs ? vk::CullModeFlagBits::eNone : vk::CullModeFlagBits::eBack,
      .frontFace = vk::FrontFace::eCounterClockwise,
      .lineWidth = 1.0f};
  const vk::PipelineMultisampleStateCreateInfo multisample{.rasterizationSamples = vk::SampleCountFlagBits::e1};

  using Compare = vk::CompareOp;
  using Op = vk::StencilOp;
  const vk::PipelineDepthStencilStateCreateInfo depth_stencil{
      .depthTestEnable = !counts,
      .depthWriteEnable = !counts,
      .depthCompareOp = Compare::eGreater,
      .stencilTestEnable = counts || state.is_cap,
      .front = counts ? stencil(Compare::eAlways, Op::eDecrementAndWrap) : stencil(Compare::eNotEqual, Op::eKeep),
      .back = counts ? stencil(Compare::eAlways, Op::eIncrementAndWrap) : stencil(Compare::eNotEqual, Op::eKeep)};

  using Component = vk::ColorComponentFlagBits;
  const auto written = Component::eR | Component::eG | Component::eB | Component::eA;
  const vk::PipelineColorBlendAttachmentState color{.colorWriteMask =
                                                        counts ? vk::ColorComponentFlags{} : written};
  const vk::PipelineColorBlendStateCreateInfo blend{.attachmentCount = 1, .pAttachments = &color};
  const std::array dynamic_states{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
  const vk::PipelineDynamicStateCreateInfo dynamic{.dynamicStateCount = dynamic_states.size(),
                                                   .pDynamicStates = dynamic_states.data()};
  return gpu_.device.createGraphicsPipeline(nullptr, {.stageCount = stages.size(),
                                                      .pStages = stages.data(),
                                                      .pVertexInputState = &input,
                                                      .pInputAssemblyState = &assembly,
                                                      .pViewportState = &viewport,
                                                      .pRasterizationState = &rasterization,
                                                      .pMultisampleState = &multisample,
                                                      .pDepthStencilState = &depth_stencil,
                                                      .pColorBlendState = &blend,
                                                      .pDynamicState = &dynamic,
                                                      .layout = *layout_,
                                                      .renderPass = *pass_});
}

Rasteriser::Rasteriser(const Device::Impl& gpu)
    : gpu_(gpu),
      depth_format_(choose_depth_format(gpu.physical)),
      pass_(make_pass(gpu.device, depth_format_)),
      surface_vertex_(gpu.make_shader(surface_vert, std::size(surface_vert))),
      surface_fragment_(gpu.make_shader(surface_frag, std::size(surface_frag))),
      cap_vertex_(gpu.make_shader(screen_vert, std::size(screen_vert))),
      cap_fragment_(gpu.make_shader(cap_frag, std::size(cap_frag))) {
  const vk::raii::Device& device = gpu_.device;
  const vk::DescriptorSetLayoutBinding binding{
      .binding = 0,
      .descriptorType = vk::DescriptorType::eUniformBuffer,
      .descriptorCount = 1,
      .stageFlags = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment};
  set_layout_ = device.createDescriptorSetLayout({.bindingCount = 1, .pBindings = &binding});
  const vk::DescriptorSetLayout set_layout = *set_layout_;
  layout_ = device.createPipelineLayout({.setLayoutCount = 1, .pSetLayouts = &set_layout});

  params_ = gpu_.make_buffer(sizeof(gpu::RasterParams), vk::BufferUsageFlagBits::eUniformBuffer, MemoryUse::upload);
  const vk::DescriptorPoolSize pool_size{vk::DescriptorType::eUniformBuffer, 1};
  descriptor_pool_ = device.createDescriptorPool({.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                  .maxSets = 1,
                                                  .poolSizeCount = 1,
                                                  .pPoolSizes = &pool_size});
  set_ = std::move(device.allocateDescriptorSets(
      {.descriptorPool = *descriptor_pool_, .descriptorSetCount = 1, .pSetLayouts = &set_layout})[0]);
  const vk::DescriptorBufferInfo info{*params_.buffer, 0, VK_WHOLE_SIZE};
  device.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *set_,
                                                     .dstBinding = 0,
                                                     .descriptorCount = 1,
                                                     .descriptorType = vk::DescriptorType::eUniformBuffer,
                                                     .pBufferInfo = &info},
                              nullptr);
}

Targets Rasteriser::make_targets(vk::Extent2D extent) const {
  using Usage = vk::ImageUsageFlagBits;
  using Aspect = vk::ImageAspectFlagBits;
  constexpr auto type = vk::ImageType::e2D;
  const vk::Extent3D size{extent.width, extent.height, 1};
  Targets targets;
  targets.extent = extent;
  targets.surface =
      gpu_.make_image(type, surface_format, size,
                      Usage::eColorAttachment | Usage::eStorage | Usage::eTransferSrc | Usage::eTransferDst);
  targets.depth_stencil =
      gpu_.make_image(type, depth_format_, size, Usage::eDepthStencilAttachment, Aspect::eDepth | Aspect::eStencil);
  const std::array views{*targets.surface.view, *targets.depth_stencil.view};
  targets.framebuffer = gpu_.device.createFramebuffer({.renderPass = *pass_,
                                                       .attachmentCount = views.size(),
                                                       .pAttachments = views.data(),
                                                       .width = extent.width,
                                                       .height = extent.height,
                                                       .layers = 1});
  return targets;
}

Result<void> Rasteriser::set_mesh(const voml::Mesh& mesh) {
  if (mesh_ && same_mesh(*mesh_, mesh)) return {};
  auto surface = make_surface(mesh);
  if (!surface) return tl::unexpected(std::move(surface.error()));
  open_edges_ = voml::count_open_edges(mesh);
  clusters_ = make_clusters(*surface, open_edges_ == 0 ? voml::outward_triangles(mesh)
                                                       : std::vector<bool>(mesh.triangles.size(), false));
  whole_ = joined(clusters_);
  mesh_.reset();  // a failure below must not leave the old mesh's name on the new one's buffers
  vertices_ = upload_buffer(gpu_, surface->vertices.data(), surface->vertices.size() * sizeof(SurfaceVertex),
                            vk::BufferUsageFlagBits::eVertexBuffer);
  indices_ = upload_buffer(gpu_, surface->indices.data(), surface->indices.size() * sizeof(std::uint32_t),
                           vk::BufferUsageFlagBits::eIndexBuffer);
  bounds_ = surface->bounds;
  mesh_ = mesh;
  ++mesh_serial_;
  return {};
}

Rasteriser::Pipelines Rasteriser::make_pipelines(std::uint32_t cut_count) const {
  const std::uint32_t cuts = cut_count < most_compiled_cuts ? cut_count : 0;
  Pipelines made;
  const auto make = [&](DrawKind kind) {
    made.surfaces.emplace(kind, make_pipeline({surface_vertex_, surface_fragment_, kind, cuts, false}));
  };
  for (const bool is_cut : {false, true}) {
    if (is_cut && cut_count == 0) break;
    for (const bool shows_backs : {false, true}) make({.counts = false, .is_cut = is_cut, .shows_backs = shows_backs});
    if (cut_count != 0) make({.counts = true, .is_cut = is_cut, .shows_backs = true});
  }
  if (cut_count != 0) {
    made.cap = make_pipeline({cap_vertex_, cap_fragment_, {.counts = false, .is_cut = true, .shows_backs = true}, cuts, true});
  }
  return made;
}

bool Rasteriser::is_ready(std::uint32_t cut_count) const {
  return pipelines_.contains(std::min(cut_count, most_compiled_cuts));
}

const Rasteriser::Pipelines& Rasteriser::ready_pipelines(const vk::raii::CommandBuffer& commands, std::uint32_t cut_count) {
  const auto [found, is_new] = pipelines_.try_emplace(std::min(cut_count, most_compiled_cuts));
  Pipelines& pipelines = found->second;
  if (!is_new) return pipelines;
  pipelines = make_pipelines(cut_count);
  commands.setScissor(0, vk::Rect2D{});
  for (const auto& [kind, pipeline] : pipelines.surfaces) pipelines.draw(commands, {kind, {0, 3}});
  if (cut_count != 0) pipelines.draw_caps(commands);
  return pipelines;
}

void Rasteriser::Pipelines::draw(const vk::raii::CommandBuffer& commands, const DrawCall& call) const {
  commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *surfaces.at(call.kind));
  commands.drawIndexed(call.indices.count, 1, call.indices.first, 0, 0);
}

void Rasteriser::Pipelines::draw_caps(const vk::raii::CommandBuffer& commands) const {
  commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *cap);
  commands.draw(3, 1, 0, 0);
}

void Rasteriser::draw(const vk::raii::CommandBuffer& commands, const Targets& targets, const Shot& shot,
                      const Tile& tile, bool in_clusters) {
  gpu::RasterParams params = shot.raster;
  params.tile_x = tile.corner_px.x;
  params.tile_y = tile.corner_px.y;
  std::memcpy(params_.mapped, &params, sizeof params);

  // The viewport is the whole picture, moved: a tile's pixels are those of the undivided picture.
  vk::Viewport viewport{-static_cast<float>(tile.corner_px.x),
                        -static_cast<float>(tile.corner_px.y),
                        static_cast<float>(shot.size_px.x),
                        static_cast<float>(shot.size_px.y),
                        0.0f,
                        1.0f};
  const vk::Rect2D area{{0, 0}, {tile.size_px.x, tile.size_px.y}};
  const std::array<vk::ClearValue, 2> nothing{};  // depth 0 is infinitely far
  const auto graphics = vk::PipelineBindPoint::eGraphics;
  commands.beginRenderPass({.renderPass = *pass_,
                            .framebuffer = *targets.framebuffer,
                            .renderArea = area,
                            .clearValueCount = nothing.size(),
                            .pClearValues = nothing.data()},
                           vk::SubpassContents::eInline);
  commands.setViewport(0, viewport);
  commands.bindDescriptorSets(graphics, *layout_, 0, *set_, nullptr);
  commands.bindVertexBuffers(0, *vertices_.buffer, vk::DeviceSize{0});
  commands.bindIndexBuffer(*indices_.buffer, 0, vk::IndexType::eUint32);
  const Pipelines& pipelines = ready_pipelines(commands, shot.raster.cut_count);
  commands.setScissor(0, area);
  for (const DrawCall& call : plan_draw(in_clusters ? clusters_ : whole_, shot, tile, shot.eye_within)) {
    pipelines.draw(commands, call);
  }
  if (shot.has_caps) {  // over all that is behind, or only where there is nothing
    viewport.minDepth = viewport.maxDepth = shot.eye_within ? smallest_depth : 1.0f;
    commands.setViewport(0, viewport);
    pipelines.draw_caps(commands);
  }
  commands.endRenderPass();
}

}  // namespace dmvv::runtime
