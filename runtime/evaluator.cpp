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

/// What is under way ends, and the scene's time is set.
Result<void> Evaluator::Impl::go_to(double time_ms) {
  if (auto done = renderer.finish(nullptr); !done) return done;
  return scene.set_time(time_ms);
}

Result<std::vector<compiler::PointAnswer>> Evaluator::probe(std::span<const glm::dvec3> points, double time_ms,
                                                            Timings* timings) {
  return guarded("evaluating points", [&]() -> Result<std::vector<compiler::PointAnswer>> {
    if (auto ready = impl_->go_to(time_ms); !ready) return tl::unexpected(std::move(ready.error()));
    return impl_->points.probe(points, timings);
  });
}

Result<void> Evaluator::draw(const View& view, Timings* timings) {
  return guarded("drawing", [&]() -> Result<void> {
    if (auto ready = impl_->go_to(view.time_ms); !ready) return ready;
    return impl_->renderer.draw(view, timings);
  });
}

Result<void> Evaluator::finish(Timings* timings) {
  return guarded("drawing", [&] { return impl_->renderer.finish(timings); });
}

Result<Picture> Evaluator::render(const View& view, Timings* timings) {
  return guarded("rendering", [&]() -> Result<Picture> {
    if (auto ready = impl_->go_to(view.time_ms); !ready) return tl::unexpected(std::move(ready.error()));
    return impl_->renderer.render(view, timings);
  });
}

Result<std::string> Evaluator::plan(const View& view) {
  return guarded("planning", [&]() -> Result<std::string> {
    if (auto ready = impl_->go_to(view.time_ms); !ready) return tl::unexpected(std::move(ready.error()));
    auto plan = impl_->renderer.plan(view);
    if (!plan) return tl::unexpected(std::move(plan.error()));
    return to_text(*plan);
  });
}

}  // namespace dmvv::runtime
