// A Vulkan device: how it is chosen, what it can, and how long its work takes. Nothing here shows Vulkan.
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "runtime/gpu/disk_cache.h"

namespace dmvv::runtime {

struct DeviceOptions {
  std::string name;  ///< part of a device's name, any case; empty: the first discrete GPU, else integrated, else CPU
  bool validation = false;  ///< Khronos validation layer on; its messages are collected
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
  /// Errors (environment): no Vulkan driver (names the Debian package), no device of that name (lists those there are),
  /// no device with all that programs need (says what each lacks), no validation layer (names the package).
  static Result<Device> create(const DeviceOptions& options);
  /// The same in a thread of its own; loading a driver takes some 50 ms. The process' environment must not be changed
  /// while it runs.
  static std::shared_future<Result<Device>> create_async(const DeviceOptions& options);

  const DeviceInfo& info() const;
  /// DeviceOptions::cache.
  std::shared_ptr<const DiskCache> cache() const;
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

}  // namespace dmvv::runtime
