#include "runtime/surface/prepared_surface.h"

#include "runtime/surface/raster.h"

namespace dmvv::runtime {
namespace {

Result<std::unique_ptr<Rasteriser>> prepare(const std::shared_future<Result<Device>>& opening, const View& view) {
  auto arranged = arrange_mesh(*support_mesh(view));
  if (!arranged) return tl::unexpected(std::move(arranged.error()));
  const Result<Device>& device = opening.get();
  if (!device) return tl::unexpected(device.error());
  const Device::Impl& gpu = device->impl();
  auto rasteriser = std::make_unique<Rasteriser>(gpu);
  if (const auto drawn = rasteriser->set_mesh(support_mesh(view), std::move(*arranged)); !drawn)
    return tl::unexpected(drawn.error());
  const auto setup = plan_frame_setup(view, rasteriser->bounds(), longest_picture_px);
  if (!setup) return tl::unexpected(setup.error());
  const glm::uvec2 tile_px = largest_tile(setup->size_px, view.samples);
  rasteriser->set_extent({tile_px.x, tile_px.y});
  rasteriser->rehearse(*setup);
  return rasteriser;
}

}  // namespace

PreparedSurface::PreparedSurface() = default;
PreparedSurface::PreparedSurface(PreparedSurface&&) noexcept = default;
PreparedSurface& PreparedSurface::operator=(PreparedSurface&&) noexcept = default;
PreparedSurface::~PreparedSurface() = default;

std::unique_ptr<Rasteriser> PreparedSurface::take() { return std::move(rasteriser_); }

std::future<Result<PreparedSurface>> PreparedSurface::prepare_async(std::shared_future<Result<Device>> opening,
                                                                    const View& view) {
  return std::async(std::launch::async, [opening = std::move(opening), view] {
    return guarded("preparing the surface", [&]() -> Result<PreparedSurface> {
      PreparedSurface prepared;
      if (view.slice) return prepared;
      auto rasteriser = prepare(opening, view);
      if (!rasteriser) return tl::unexpected(std::move(rasteriser.error()));
      prepared.rasteriser_ = std::move(*rasteriser);
      return prepared;
    });
  });
}

}  // namespace dmvv::runtime
