#include "runtime/gpu/pipeline_cache.h"

namespace dmvv::runtime {
namespace {

/// Drivers must take back what they gave, and only they: the key names all that the Vulkan specification's pipeline
/// cache header does, and the driver's version.
std::string key_of(const Device::Impl& gpu, std::span<const std::uint32_t> spirv) {
  const auto properties = gpu.physical.getProperties();
  std::string key = fmt::format("pipelines, vendor {:x}, device {:x}, driver {:x}, ", properties.vendorID,
                                properties.deviceID, properties.driverVersion);
  for (const std::uint8_t byte : properties.pipelineCacheUUID) key += fmt::format("{:02x}", byte);
  return key.append("\n").append(reinterpret_cast<const char*>(spirv.data()), spirv.size_bytes());
}

}  // namespace

PipelineCache::PipelineCache(const Device::Impl& gpu, std::span<const std::uint32_t> spirv) : gpu_(gpu) {
  if (gpu.cache) {
    key_ = key_of(gpu, spirv);
    known_ = gpu.cache->find(key_).value_or("");
  }
  cache_ = gpu.device.createPipelineCache({.initialDataSize = known_.size(), .pInitialData = known_.data()});
}

void PipelineCache::save() const {
  if (!gpu_.cache) return;
  const std::vector<std::uint8_t> data = cache_.getData();
  const std::string_view bytes(reinterpret_cast<const char*>(data.data()), data.size());
  if (bytes != known_) gpu_.cache->keep(key_, bytes);
}

}  // namespace dmvv::runtime
