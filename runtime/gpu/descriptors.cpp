#include "runtime/gpu/descriptors.h"

#include <algorithm>

#include "runtime/gpu/pipeline_cache.h"

namespace dmvv::runtime {

vk::raii::DescriptorSetLayout make_set_layout(const Device::Impl& gpu, std::span<const SetBinding> bindings) {
  std::vector<vk::DescriptorSetLayoutBinding> made;
  for (const SetBinding& binding : bindings) {
    made.push_back({.binding = binding.number,
                    .descriptorType = binding.type,
                    .descriptorCount = 1,
                    .stageFlags = vk::ShaderStageFlagBits::eCompute});
  }
  return gpu.device.createDescriptorSetLayout(vk::DescriptorSetLayoutCreateInfo{}.setBindings(made));
}

DescriptorSet::DescriptorSet(const Device::Impl& gpu, const vk::raii::DescriptorSetLayout& layout,
                             std::span<const SetBinding> bindings)
    : gpu_(&gpu), bindings_(bindings.begin(), bindings.end()) {
  std::vector<vk::DescriptorPoolSize> sizes;
  for (const SetBinding& binding : bindings) sizes.push_back({binding.type, 1});
  if (sizes.empty()) sizes.push_back({vk::DescriptorType::eStorageBuffer, 1});  // a pool must hold something
  pool_ = gpu.device.createDescriptorPool(
      vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, .maxSets = 1}
          .setPoolSizes(sizes));
  const vk::DescriptorSetLayout handle = *layout;
  set_ = std::move(gpu.device.allocateDescriptorSets(
      {.descriptorPool = *pool_, .descriptorSetCount = 1, .pSetLayouts = &handle})[0]);
}

vk::DescriptorType DescriptorSet::type_of(std::uint32_t binding) const {
  return std::ranges::find(bindings_, binding, &SetBinding::number)->type;
}

void DescriptorSet::update(vk::WriteDescriptorSet write, std::uint32_t binding) {
  write.setDstSet(*set_).setDstBinding(binding).setDescriptorCount(1).setDescriptorType(type_of(binding));
  gpu_->device.updateDescriptorSets(write, nullptr);
}

void DescriptorSet::write(std::uint32_t binding, const GpuBuffer& buffer) {
  const vk::DescriptorBufferInfo info{*buffer.buffer, 0, VK_WHOLE_SIZE};
  update({.pBufferInfo = &info}, binding);
}

void DescriptorSet::write(std::uint32_t binding, const vk::raii::BufferView& texels) {
  const vk::BufferView view = *texels;
  update({.pTexelBufferView = &view}, binding);
}

void DescriptorSet::write(std::uint32_t binding, const GpuImage& image) {
  const vk::DescriptorImageInfo info{{}, *image.view, vk::ImageLayout::eGeneral};
  update({.pImageInfo = &info}, binding);
}

void DescriptorSet::write(std::uint32_t binding, const GpuImage& image, const vk::raii::Sampler& sampler) {
  const vk::DescriptorImageInfo info{*sampler, *image.view, vk::ImageLayout::eShaderReadOnlyOptimal};
  update({.pImageInfo = &info}, binding);
}

vk::raii::PipelineLayout make_pipeline_layout(const Device::Impl& gpu, std::span<const vk::DescriptorSetLayout> sets,
                                              std::uint32_t push_bytes) {
  const vk::PushConstantRange pushed{vk::ShaderStageFlagBits::eCompute, 0, push_bytes};
  return gpu.device.createPipelineLayout({.setLayoutCount = static_cast<std::uint32_t>(sets.size()),
                                          .pSetLayouts = sets.data(),
                                          .pushConstantRangeCount = push_bytes != 0 ? 1u : 0u,
                                          .pPushConstantRanges = &pushed});
}

vk::raii::Pipeline make_compute_pipeline(const Device::Impl& gpu, std::span<const std::uint32_t> spirv,
                                         const vk::raii::PipelineLayout& layout,
                                         std::span<const std::uint32_t> constants) {
  std::vector<vk::SpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, 4 * i, 4});
  const vk::SpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                              constants.size_bytes(), constants.data()};
  const vk::raii::ShaderModule module = gpu.make_shader(spirv.data(), spirv.size());
  const PipelineCache cache(gpu, spirv);
  auto made = gpu.device.createComputePipeline(cache.handle(), {.stage = {.stage = vk::ShaderStageFlagBits::eCompute,
                                                                          .module = *module,
                                                                          .pName = "main",
                                                                          .pSpecializationInfo = &specialization},
                                                                .layout = *layout});
  cache.save();
  return made;
}

}  // namespace dmvv::runtime
