#include "runtime/gpu/queue.h"

namespace dmvv::runtime {

Submission& Submission::operator=(Submission&& other) noexcept {
  finish();
  device_ = other.device_;
  pool_ = std::move(other.pool_);
  commands_ = std::move(other.commands_);
  timer_ = std::move(other.timer_);
  fence_ = std::move(other.fence_);
  timer_bits_ = other.timer_bits_;
  ms_a_tick_ = other.ms_a_tick_;
  return *this;
}

Submission::~Submission() { finish(); }

void Submission::finish() noexcept {
  if (!*fence_) return;
  try {
    wait();
  } catch (const vk::Error&) {  // the device is lost: nothing runs on it any more
  }
}

double Submission::wait() {
  if (!*fence_) return 0.0;
  const vk::Result waited = device_->waitForFences(*fence_, VK_TRUE, UINT64_MAX);
  fence_ = nullptr;
  commands_ = nullptr;
  pool_ = nullptr;
  if (waited != vk::Result::eSuccess) throw vk::SystemError(vk::make_error_code(waited), "vkWaitForFences");
  if (timer_bits_ == 0) return 0.0;
  const auto [read, stamps] = timer_.getResults<std::uint64_t>(0, 2, 2 * sizeof(std::uint64_t), sizeof(std::uint64_t),
                                                               vk::QueryResultFlagBits::e64);
  timer_ = nullptr;
  if (read != vk::Result::eSuccess) return 0.0;
  const std::uint64_t ticks = (stamps[1] - stamps[0]) & (~std::uint64_t{0} >> (64 - timer_bits_));  // they wrap around
  return ms_a_tick_ * static_cast<double>(ticks);
}

Queue::Queue(const vk::raii::PhysicalDevice& physical, const vk::raii::Device& device, std::uint32_t family)
    : device_(&device),
      queue_(device.getQueue(family, 0)),
      family_(family),
      timer_bits_(physical.getQueueFamilyProperties()[family].timestampValidBits),
      ms_a_tick_(1e-6 * static_cast<double>(physical.getProperties().limits.timestampPeriod)),
      lock_(std::make_unique<std::mutex>()) {}

Submission Queue::submit(const std::function<void(const vk::raii::CommandBuffer&)>& record) const {
  Submission made;
  made.device_ = device_;
  made.timer_bits_ = timer_bits_;
  made.ms_a_tick_ = ms_a_tick_;
  made.pool_ =
      device_->createCommandPool({.flags = vk::CommandPoolCreateFlagBits::eTransient, .queueFamilyIndex = family_});
  made.commands_ = std::move(
      device_
          ->allocateCommandBuffers(
              {.commandPool = *made.pool_, .level = vk::CommandBufferLevel::ePrimary, .commandBufferCount = 1})
          .front());
  const vk::raii::CommandBuffer& commands = made.commands_;
  commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  if (is_timed()) {
    made.timer_ = device_->createQueryPool({.queryType = vk::QueryType::eTimestamp, .queryCount = 2});
    commands.resetQueryPool(*made.timer_, 0, 2);
    commands.writeTimestamp(vk::PipelineStageFlagBits::eTopOfPipe, *made.timer_, 0);
    // Lavapipe keeps a stamp back until something makes it finish its drawing: a dispatch alone does not.
    constexpr auto everything = vk::PipelineStageFlagBits::eAllCommands;
    commands.pipelineBarrier(everything, everything, {}, nullptr, nullptr, nullptr);
  }
  record(commands);
  if (is_timed()) commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *made.timer_, 1);
  commands.end();
  vk::raii::Fence fence(*device_, vk::FenceCreateInfo{});
  const vk::CommandBuffer handle = *commands;
  {
    const std::lock_guard held(*lock_);
    queue_.submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &handle}, *fence);
  }
  made.fence_ = std::move(fence);  // from here on there is something to wait for
  return made;
}

}  // namespace dmvv::runtime
