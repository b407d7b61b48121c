// Inside the runtime only: bytes to the device.
#pragma once

#include "runtime/gpu/gpu.h"

namespace dmvv::runtime {

/// A mapped buffer with a copy of these bytes, to be copied from.
GpuBuffer staging_buffer(const Device::Impl& gpu, const void* bytes, std::size_t size);

/// Copies bytes into a buffer of device memory, by way of a staging buffer.
GpuBuffer upload_buffer(const Device::Impl& gpu, const void* bytes, std::size_t size, vk::BufferUsageFlags usage);

}  // namespace dmvv::runtime
