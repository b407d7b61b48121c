// Program -> pictures, region ids, depth, point values. The only part that knows Vulkan; nothing here shows it.
#pragma once

#include <cstdint>
#include <future>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "compiler/program.h"
#include "runtime/gpu/device.h"
#include "runtime/surface/prepared_surface.h"
#include "runtime/view/frame_passes.h"
#include "runtime/view/picture.h"
#include "runtime/view/view.h"
#include "voml/assets/mesh.h"

namespace dmvv::compiler {
class Judge;  // proofs/judge.h
}

namespace dmvv::runtime {

/// A program on a device: its buffers and textures uploaded, its pipelines made when first needed.
class Evaluator {
 public:
  /// Errors: input fault if the program exceeds a limit of the device (names the limit and both numbers), environment
  /// fault if memory is short or the driver fails (VkResult by name). Adds "upload" to `timings`. With a judge, frames
  /// leave out what it proves.
  static Result<Evaluator> create(Device& device, const compiler::Program& program, Timings* timings = nullptr,
                                  PreparedSurface prepared = {}, std::shared_ptr<const compiler::Judge> judge = {});

  /// The scene at a time and at points in root coordinates (rounded to float32). Answers in the order of the points.
  /// Needs the points kernel. Adds "pipeline" (first use), "gpu" and "probe" to `timings`. Errors: environment; input
  /// if the device ran out of loop rounds at some point.
  Result<std::vector<compiler::PointAnswer>> probe(std::span<const glm::dvec3> points, double time_ms = 0.0,
                                                   Timings* timings = nullptr);

  /// Draws a picture that stays on the device, and returns before the device is done: a `render` of the same view only
  /// brings it home (unless it has more than 10 million samples, or the pass keep-picture is off). Needs the pixels
  /// kernel. Adds "pipeline" and "frame", the host's share, to `timings`. Errors: those of `render` that come from the
  /// view; what the device finds is told by `finish`, or by whichever call comes next.
  Result<void> draw(const View& view, Timings* timings = nullptr);
  /// Waits for what `draw` began; adds "gpu" to `timings`. Errors: as `render`, of the picture drawn.
  Result<void> finish(Timings* timings = nullptr);

  /// One picture. Needs the pixels kernel. Adds "pipeline" (first use for slices, for surfaces, for cut surfaces: the
  /// driver's compilation included, by drawing 8x8 pixels) "gpu" and "frame" to `timings`. A mesh drawn before is kept
  /// on the device. Errors (input): views that cannot be drawn (sides times samples beyond 16384 or the device's limit,
  /// more than 64 cuts, a broken mesh or camera), pixels for which the device ran out of loop rounds; else environment.
  /// Memory: some 220 MiB on the device at most, whatever the size; the picture itself on the host.
  Result<Picture> render(const View& view, Timings* timings = nullptr);

  /// What `render` would do for this view now, as text: tiles, steps in their order, what each reads and writes.
  /// Nothing is drawn, and later frames do not depend on it. Errors: those of `render` that come from the view.
  Result<std::string> plan(const View& view);

  struct Impl;
  explicit Evaluator(std::unique_ptr<Impl> impl);
  Evaluator(Evaluator&&) noexcept;
  Evaluator& operator=(Evaluator&&) noexcept;
  ~Evaluator();

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace dmvv::runtime
