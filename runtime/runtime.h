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
#include "runtime/gpu/disk_cache.h"
#include "runtime/view/view.h"
#include "voml/assets/mesh.h"

namespace dmvv::runtime {

struct DeviceOptions {
  std::string name;  ///< part of a device's name, any case; empty: the first discrete GPU, else integrated, else CPU
  bool validation = false;  ///< Khronos validation layer on; its messages are collected
  /// False: the driver's own shader cache begins empty for this device, in a folder that goes with the process (set by
  /// its environment: not while other threads read that).
  bool driver_cache = true;
  /// Keeps pipelines for those drivers that give them away; may be null.
  std::shared_ptr<const DiskCache> cache = nullptr;
};

/// Limits of a device that a program must respect, in the units of the Vulkan specification.
struct DeviceInfo {
  std::string name;
  std::string kind;  ///< "discrete", "integrated", "virtual", "cpu"
  std::string driver;
  std::string api_version;  ///< "1.3.230"
  std::uint32_t max_extent_3d;
  std::uint64_t max_storage_buffer;
  std::uint32_t max_texel_buffer_elements;  ///< of storage texel buffers; 0: it cannot have all records in them
};

/// Milliseconds of named steps, in order.
struct Timing {
  std::string step;
  double ms;
};
using Timings = std::vector<Timing>;

/// The step "gpu": the device's share of the step after it ("frame", "probe") by its own time stamps; part of that
/// step, not another one. Absent where the device has no time stamps.
inline constexpr const char* gpu_step = "gpu";

/// An open Vulkan device; copies are the same. Everything made from it must be destroyed before the last of them.
class Device {
 public:
  /// Errors (environment): no Vulkan driver (names the Debian package), no device of that name (lists those there are), no
  /// device with all that programs need (says what each lacks), no validation layer (names the package).
  static Result<Device> create(const DeviceOptions& options);
  /// The same in a thread of its own; loading a driver takes some 50 ms. The process' environment must not be changed
  /// while it runs.
  static std::shared_future<Result<Device>> create_async(const DeviceOptions& options);

  const DeviceInfo& info() const;
  /// All messages of the validation layer so far; empty if it is off or has nothing to say.
  std::vector<std::string> validation_messages() const;

  struct Impl;
  explicit Device(std::unique_ptr<Impl> impl);
  Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

/// Every device that can run programs, as `create` prefers them: by kind, of a kind those with 64-bit atomics first.
Result<std::vector<DeviceInfo>> list_devices();

class Rasteriser;

/// What a picture is drawn on, whatever the scene: the support mesh on the device, and the kernels that draw it, compiled. It can
/// be prepared while a scene is compiled; without it, `Evaluator::render` does the same work.
class Canvas {
 public:
  /// For a picture of `view`, in a thread of its own, which waits for the device; slices need nothing. Until it is ready
  /// nothing else may run on the device, and the mesh must stay. Errors: those of the device, and those of
  /// `Evaluator::render` that come from the view.
  static std::future<Result<Canvas>> prepare_async(std::shared_future<Result<Device>> opening, const View& view);

  Canvas();
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;
  ~Canvas();

 private:
  friend class Evaluator;
  std::unique_ptr<Rasteriser> rasteriser_;
};

/// A program on a device: its buffers and textures uploaded, its pipelines made when first needed.
class Evaluator {
 public:
  /// Errors: input fault if the program exceeds a limit of the device (names the limit and both numbers), environment
  /// fault if memory is short or the driver fails (VkResult by name). Adds "upload" to `timings`.
  static Result<Evaluator> create(Device& device, const compiler::Program& program, Timings* timings = nullptr,
                                  Canvas canvas = {});

  /// The scene at a time and at points in root coordinates (rounded to float32). Answers in the order of the points.
  /// Needs the points kernel. Adds "pipeline" (first use), "gpu" and "probe" to `timings`. Errors: environment; input if the
  /// device ran out of loop rounds at some point.
  Result<std::vector<compiler::PointAnswer>> probe(std::span<const glm::dvec3> points, double time_ms = 0.0,
                                                   Timings* timings = nullptr);

  /// One picture. Needs the pixels kernel. Adds "pipeline" (first use for slices, for surfaces, for cut surfaces: the
  /// driver's compilation included, by drawing 8x8 pixels) "gpu" and "frame" to `timings`. A mesh drawn before is kept on the
  /// device. Errors (input): views that cannot be drawn (sides times samples beyond 16384 or the device's limit, more
  /// than 64 cuts, a broken mesh or camera), pixels for which the device ran out of loop rounds; else environment.
  /// Memory: some 220 MiB on the device at most, whatever the size; the picture itself on the host.
  Result<Picture> render(const View& view, Timings* timings = nullptr);

  struct Impl;
  explicit Evaluator(std::unique_ptr<Impl> impl);
  Evaluator(Evaluator&&) noexcept;
  Evaluator& operator=(Evaluator&&) noexcept;
  ~Evaluator();

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace dmvv::runtime
