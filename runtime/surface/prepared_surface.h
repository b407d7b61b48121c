// What pictures are drawn on, prepared while their scene is compiled.
#pragma once

#include <future>
#include <memory>

#include "base/result.h"
#include "runtime/gpu/device.h"
#include "runtime/view/view.h"

namespace dmvv::runtime {

class Rasteriser;

/// What a picture is drawn on, whatever the scene: the support mesh on the device, and the kernels that draw it,
/// compiled. It can be prepared while a scene is compiled; without it, `Evaluator::render` does the same work.
class PreparedSurface {
 public:
  /// For a picture of `view`, in a thread of its own, which waits for the device; slices need nothing. Until it is
  /// ready nothing else may run on the device. Errors: those of the device, and those of
  /// `Evaluator::render` that come from the view.
  static std::future<Result<PreparedSurface>> prepare_async(std::shared_future<Result<Device>> opening,
                                                            const View& view);

  PreparedSurface();
  PreparedSurface(PreparedSurface&&) noexcept;
  PreparedSurface& operator=(PreparedSurface&&) noexcept;
  ~PreparedSurface();

  /// What was prepared; null if nothing was. It is the caller's from then on.
  std::unique_ptr<Rasteriser> take();

 private:
  std::unique_ptr<Rasteriser> rasteriser_;
};

}  // namespace dmvv::runtime
