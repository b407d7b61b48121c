// Inside the runtime only: the open device, its buffers and images, and the border where exceptions become errors.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "runtime/gpu/device.h"
#include "runtime/gpu/queue.h"

namespace dmvv::runtime {

/// What the validation layer said; outlives the instance that writes into it.
struct MessageLog {
  mutable std::mutex mutex;
  std::vector<std::string> messages;
};

enum class MemoryUse {
  device,    ///< read and written by the device only
  upload,    ///< mapped; written by the host, read by the device
  readback,  ///< mapped; written by the device, read by the host
};

struct GpuBuffer {
  vk::raii::Buffer buffer{nullptr};
  vk::raii::DeviceMemory memory{nullptr};
  vk::DeviceSize bytes = 0;
  void* mapped = nullptr;  ///< coherent; null for MemoryUse::device
};

struct GpuImage {
  vk::raii::Image image{nullptr};
  vk::raii::DeviceMemory memory{nullptr};
  vk::raii::ImageView view{nullptr};
};

/// Descriptors that kernels over pixels have beside the scene's (runtime/frame/render.cpp, shaders/pixel_io.glsl):
/// images; buffers, the four of the verdicts included.
inline constexpr std::uint32_t images_of_pixels = 7, buffers_of_pixels = 8;
/// What only some devices have, and kernels are chosen by. What all of them must have: runtime/gpu/device.cpp.
struct DeviceExtras {
  bool long_atomics = false;  ///< 64-bit integers, and their atomics in storage buffers
  bool large_texel_buffers =
      false;                     ///< storage texel buffers of no fewer words than storage buffers have on every device
  bool two_word_texels = false;  ///< storage texel buffers of texels of two words
  bool fine_sines =
      false;  ///< as good as spec/accuracy.md assumes; else kernels bring their own (runtime/gpu/own_sines.h)
};

struct Device::Impl {
  std::shared_ptr<MessageLog> log;
  vk::raii::Context context;
  vk::raii::Instance instance{nullptr};
  vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
  vk::raii::PhysicalDevice physical{nullptr};
  vk::raii::Device device{nullptr};
  Queue queue;
  vk::PhysicalDeviceLimits limits;
  DeviceExtras extras;
  DeviceInfo info;
  std::shared_ptr<const DiskCache> cache;  ///< may be null

  Impl();
  GpuBuffer make_buffer(vk::DeviceSize bytes, vk::BufferUsageFlags usage, MemoryUse use) const;
  GpuImage make_image(vk::ImageType type, vk::Format format, vk::Extent3D extent, vk::ImageUsageFlags usage) const;
  vk::raii::ShaderModule make_shader(const std::uint32_t* words, std::size_t count) const;
  /// Records commands, submits them and waits until they are done. Returns the milliseconds they took by the device's
  /// own time stamps; 0 if it has none.
  double run(const std::function<void(const vk::raii::CommandBuffer&)>& record) const {
    return queue.submit(record).wait();
  }

 private:
  vk::raii::DeviceMemory allocate(const vk::MemoryRequirements& needs, MemoryUse use) const;
};

/// As Device::create, but the device has no extras: its pictures are the same, and take longer.
Result<Device> create_without_extras(const DeviceOptions& options);

/// The whole of a colour image changes its layout; `before` is made available and visible to `after`.
vk::ImageMemoryBarrier color_barrier(vk::Image image, vk::ImageLayout from, vk::ImageLayout to, vk::AccessFlags before,
                                     vk::AccessFlags after);
inline vk::ImageMemoryBarrier color_barrier(const GpuImage& image, vk::ImageLayout from, vk::ImageLayout to,
                                            vk::AccessFlags before, vk::AccessFlags after) {
  return color_barrier(*image.image, from, to, before, after);
}

/// Calls `body` and turns what the driver or the C++ library throws into an error: "while <what>: ...".
template <class Body>
auto guarded(const char* what, Body body) -> decltype(body()) {
  try {
    return body();
  } catch (const vk::SystemError& error) {
    return fail(Fault::environment, fmt::format("the Vulkan driver failed while {}", what), {error.what()});
  } catch (const std::bad_alloc&) {
    return fail(Fault::environment, fmt::format("not enough memory while {}", what));
  } catch (const std::exception& error) {
    return fail(Fault::environment, fmt::format("failed while {}", what), {error.what()});
  }
}

/// Adds the milliseconds of its lifetime to `timings` (if there are any) as `step`.
class Stopwatch {
 public:
  Stopwatch(Timings* timings, const char* step);
  ~Stopwatch();
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  Timings* timings_;
  const char* step_;
  std::int64_t start_ns_;
};

}  // namespace dmvv::runtime
