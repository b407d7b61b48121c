#include "runtime/frame/execute.h"

namespace dmvv::runtime {
namespace {

using Access = vk::AccessFlagBits;
using Layout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits;

constexpr vk::ImageSubresourceRange color_range{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};

vk::BufferImageCopy tile_copy(vk::DeviceSize offset, glm::uvec2 size_px) {
  return {.bufferOffset = offset,
          .imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
          .imageExtent = {size_px.x, size_px.y, 1}};
}

class Recorder {
 public:
  Recorder(const vk::raii::CommandBuffer& commands, TileWork& work) : commands_(commands), work_(work) {}

  void run() {
    wait();  // for what was submitted before
    commands_.updateBuffer<gpu::FrameParams>(*work_.tile.block.buffer, 0, work_.params);
    const std::vector<bool> waiting = waits(work_.plan.steps);
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (waiting[i] || i == 0) wait();
      record(work_.plan.steps[i]);
    }
  }

 private:
  /// All that was written is there for all that follows.
  void wait() {
    constexpr auto written = Access::eShaderWrite | Access::eTransferWrite;
    constexpr auto used = Access::eShaderRead | Access::eShaderWrite | Access::eTransferRead | Access::eTransferWrite |
                          Access::eIndirectCommandRead | Access::eUniformRead;
    commands_.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer,
                              Stage::eComputeShader | Stage::eTransfer | Stage::eDrawIndirect, {},
                              vk::MemoryBarrier{.srcAccessMask = written, .dstAccessMask = used}, nullptr, nullptr);
  }

  void record(const PlannedStep& planned) {
    switch (planned.step) {
      case Step::raster:
        return work_.rasteriser.draw(commands_, work_.setup, work_.plan.tile, work_.passes.clusters,
                                     work_.tile.surface);
      case Step::slice:
        return upload_slice();
      case Step::set_out:
        return set_out();
      case Step::cones:
        return dispatch(planned, (ray_tiles() + DMVV_PIXELS_GROUP_SIZE - 1) / DMVV_PIXELS_GROUP_SIZE);
      case Step::trace:
      case Step::media:
      case Step::normals:
        return dispatch_live(planned);
      case Step::clear:
        return clear();
      case Step::report:
        return report();
      case Step::bring_home:
        return bring_home();
      case Step::compose:
        return dispatch(
            planned, (work_.params.width * work_.params.height + DMVV_PIXELS_GROUP_SIZE - 1) / DMVV_PIXELS_GROUP_SIZE);
      case Step::list:
      case Step::classify:
        return dispatch(planned, (blocks() * DMVV_PIXELS_BLOCK + DMVV_PIXELS_GROUP_SIZE - 1) / DMVV_PIXELS_GROUP_SIZE);
      case Step::count_lists:
      case Step::count_stages:
        return dispatch(planned, 1);
      case Step::stage:
        return dispatch_queued(planned, offsetof(gpu::QueueHeader, groups));
      case Step::distribute:
        return dispatch_queued(planned, offsetof(gpu::QueueHeader, runs));
      case Step::evaluate:
        if (planned.list == no_list) return dispatch(planned, blocks());
        [[fallthrough]];
      case Step::paint:
      case Step::lead:
      case Step::follow:
      case Step::count_hits:
        return dispatch_listed(planned);
    }
  }

  std::uint32_t blocks() const {
    const auto along = [](std::uint32_t px) { return (px + DMVV_PIXELS_BLOCK - 1) / DMVV_PIXELS_BLOCK; };
    return along(work_.params.width) * along(work_.params.height);
  }

  void dispatch(const PlannedStep& planned, std::uint32_t groups) {
    bind(planned);
    commands_.dispatch(groups, 1, 1);
  }
  void dispatch_listed(const PlannedStep& planned) {
    bind(planned);
    commands_.dispatchIndirect(*work_.images.scratch().list.buffer, planned.list * sizeof(gpu::DispatchGroups));
  }
  void dispatch_live(const PlannedStep& planned) {
    bind(planned);
    commands_.dispatchIndirect(*work_.tile.tiles.buffer, offsetof(gpu::RayTilesHeader, live));
  }
  void dispatch_queued(const PlannedStep& planned, vk::DeviceSize groups) {
    bind(planned);
    commands_.dispatchIndirect(*work_.images.scratch().queues.buffer,
                               groups + planned.stage * sizeof(gpu::DispatchGroups));
  }

  void bind(const PlannedStep& planned) {
    constexpr auto compute = vk::PipelineBindPoint::eCompute;
    const FrameKernels::Bound kernel = work_.kernels.at(planned.step, planned.stage, work_.kind);
    const gpu::StepParams step{planned.list == no_list ? DMVV_TO_EVALUATE : planned.list, planned.stage,
                               planned.step == Step::cones ? 1u : 0u};
    commands_.bindPipeline(compute, kernel.pipeline);
    commands_.bindDescriptorSets(compute, kernel.layout, 0, {work_.scene.set(), *work_.tile.set}, nullptr);
    if (kernel.asks_verdicts) commands_.bindDescriptorSets(compute, kernel.layout, 2, work_.verdicts->set(), nullptr);
    commands_.pushConstants<gpu::StepParams>(kernel.layout, vk::ShaderStageFlagBits::eCompute, 0, step);
  }

  /// Uploads a slice's surface in place of a drawn one.
  void upload_slice() {
    const Tile& tile = work_.plan.tile;
    const GpuBuffer& points = work_.images.slice_surface();
    fill_slice_surface(*work_.setup.slice, tile.corner_px, tile.size_px, static_cast<glm::uvec4*>(points.mapped));
    for_transfer(work_.tile.surface, Layout::eTransferDstOptimal, [&] {
      commands_.copyBufferToImage(*points.buffer, *work_.tile.surface.image, Layout::eTransferDstOptimal,
                                  tile_copy(0, tile.size_px));
    });
  }

  std::uint32_t ray_tiles() const {
    const auto along = [](std::uint32_t px) { return (px + DMVV_RAY_TILE - 1) / DMVV_RAY_TILE; };
    return along(work_.params.width) * along(work_.params.height);
  }

  /// Tells rays what they need. No tile is listed yet; where none is, nothing is seen.
  void set_out() {
    const Tile& tile = work_.plan.tile;
    const gpu::RayParams params = ray_params(work_.setup, tile.corner_px, tile.size_px);
    commands_.updateBuffer<gpu::RayParams>(*work_.tile.rays.buffer, 0, params);
    gpu::RayTilesHeader none{};
    none.live = {0, 1, 1};
    commands_.updateBuffer<gpu::RayTilesHeader>(*work_.tile.tiles.buffer, 0, none);
    commands_.fillBuffer(*work_.tile.media.buffer, 0, VK_WHOLE_SIZE, 0);
    for (const GpuImage* image : {&work_.tile.surface, &work_.tile.notes})
      commands_.clearColorImage(*image->image, Layout::eGeneral, vk::ClearColorValue{}, color_range);
  }

  /// Images stay in the layout GENERAL, but for a copy.
  template <class Copy>
  void for_transfer(const GpuImage& image, Layout layout, const Copy& copy) {
    constexpr auto shader = Access::eShaderRead | Access::eShaderWrite;
    constexpr auto transfer = Access::eTransferRead | Access::eTransferWrite;
    commands_.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer, Stage::eTransfer, {}, nullptr, nullptr,
                              color_barrier(image, Layout::eGeneral, layout, shader | transfer, transfer));
    copy();
    commands_.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader | Stage::eTransfer, {}, nullptr, nullptr,
                              color_barrier(image, layout, Layout::eGeneral, transfer, shader | transfer));
  }

  /// Clears what the frame does not keep. What is not evaluated is empty.
  void clear() {
    TileScratch& scratch = work_.images.scratch();
    const Outputs& outputs = work_.images.outputs();
    const gpu::PixelListHeader nothing{.groups = {{0, 1, 1}, {0, 1, 1}, {0, 1, 1}, {0, 1, 1}},
                                       .counts = {},
                                       .unfinished = 0,
                                       .pad0 = 0,
                                       .pad1 = 0,
                                       .pad2 = 0};
    commands_.updateBuffer<gpu::PixelListHeader>(*scratch.list.buffer, 0, nothing);
    if (!work_.kernels.stages_go_on().empty())
      commands_.fillBuffer(*scratch.queues.buffer, 0, sizeof(gpu::QueueHeader), 0);
    const vk::ClearColorValue empty{}, unknown{std::array{0.0f, 0.0f, 0.0f, -1.0f}};
    if (work_.passes.pixel_list && !work_.plan.keeps_still) {
      const GpuImage& color = outputs.colors == Colors::bytes ? work_.tile.bytes : work_.tile.color;
      commands_.clearColorImage(*color.image, Layout::eGeneral, empty, color_range);
      if (outputs.regions) commands_.clearColorImage(*work_.tile.region.image, Layout::eGeneral, empty, color_range);
    }
    if (work_.params.has_leaders != 0) {
      commands_.clearColorImage(*scratch.leader_place.image, Layout::eGeneral, unknown, color_range);
    }
  }

  void report() {
    commands_.copyBuffer(*work_.images.scratch().list.buffer, *work_.tile.report.buffer,
                         vk::BufferCopy{0, offsetof(TileReport, pixels), sizeof(gpu::PixelListHeader)});
    commands_.copyBuffer(*work_.tile.tiles.buffer, *work_.tile.report.buffer,
                         vk::BufferCopy{0, offsetof(TileReport, rays), sizeof(gpu::RayTilesHeader)});
    for_host();
  }

  /// Copies everything that is asked for into the buffer that the host reads.
  void bring_home() {
    const Outputs& outputs = work_.images.outputs();
    const Tile& tile = work_.plan.tile;
    const GpuBuffer& target = work_.images.readback_of(work_.tile);
    const ReadbackLayout layout(std::size_t{tile.size_px.x} * tile.size_px.y, outputs);
    const auto copy = [&](const GpuImage& image, vk::DeviceSize offset) {
      for_transfer(image, Layout::eTransferSrcOptimal, [&] {
        commands_.copyImageToBuffer(*image.image, Layout::eTransferSrcOptimal, *target.buffer,
                                    tile_copy(offset, tile.size_px));
      });
    };
    copy(outputs.colors == Colors::bytes ? work_.tile.bytes : work_.tile.color, layout.colors);
    if (outputs.regions) copy(work_.tile.region, layout.regions);
    if (outputs.positions) copy(work_.tile.surface, layout.positions);
    if (outputs.doubt) copy(work_.tile.notes, layout.notes);
    for_host();
  }

  /// What was copied can be read by the host once the commands are done.
  void for_host() {
    const vk::MemoryBarrier copied{.srcAccessMask = Access::eTransferWrite, .dstAccessMask = Access::eHostRead};
    commands_.pipelineBarrier(Stage::eTransfer, Stage::eHost, {}, copied, nullptr, nullptr);
  }

  const vk::raii::CommandBuffer& commands_;
  TileWork& work_;
};

}  // namespace

void record_tile(const vk::raii::CommandBuffer& commands, TileWork& work) { Recorder(commands, work).run(); }

}  // namespace dmvv::runtime
