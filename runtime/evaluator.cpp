#include "runtime/evaluator.h"

namespace dmvv::runtime {

Evaluator::Impl::Impl(const Device::Impl& gpu, const compiler::Program& program,
                      std::shared_ptr<const compiler::Judge> judge, std::unique_ptr<Rasteriser> prepared)
    : scene(gpu, program),
      points(gpu, scene, program),
      renderer(gpu, scene, program, std::move(judge), std::move(prepared)) {}

Evaluator::Evaluator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Evaluator::Evaluator(Evaluator&&) noexcept = default;
Evaluator& Evaluator::operator=(Evaluator&&) noexcept = default;
Evaluator::~Evaluator() = default;

Result<Evaluator> Evaluator::create(Device& device, const compiler::Program& program, Timings* timings,
                                    PreparedSurface prepared, std::shared_ptr<const compiler::Judge> judge) {
  return guarded("uploading the scene", [&]() -> Result<Evaluator> {
    const Device::Impl& gpu = device.impl();
    if (auto fault = SceneOnDevice::fault(gpu, program)) return tl::unexpected(std::move(*fault));
    const Stopwatch watch(timings, "upload");
    return Evaluator(std::make_unique<Impl>(gpu, program, std::move(judge), prepared.take()));
  });
}

Result<std::vector<compiler::PointAnswer>> Evaluator::probe(std::span<const glm::dvec3> points, double time_ms,
                                                            Timings* timings) {
  return guarded("evaluating points", [&]() -> Result<std::vector<compiler::PointAnswer>> {
    if (auto set = impl_->scene.set_time(time_ms); !set) return tl::unexpected(std::move(set.error()));
    return impl_->points.probe(points, timings);
  });
}

Result<Picture> Evaluator::render(const View& view, Timings* timings) {
  return guarded("rendering", [&]() -> Result<Picture> {
    if (auto set = impl_->scene.set_time(view.time_ms); !set) return tl::unexpected(std::move(set.error()));
    return impl_->renderer.render(view, timings);
  });
}

Result<std::string> Evaluator::plan(const View& view) {
  return guarded("planning", [&]() -> Result<std::string> {
    if (auto set = impl_->scene.set_time(view.time_ms); !set) return tl::unexpected(std::move(set.error()));
    auto plan = impl_->renderer.plan(view);
    if (!plan) return tl::unexpected(std::move(plan.error()));
    return to_text(*plan);
  });
}

}  // namespace dmvv::runtime
