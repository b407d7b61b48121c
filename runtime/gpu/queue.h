// Inside the runtime only: the queue of a device, and the work that was given to it.
#pragma once

#include <functional>
#include <mutex>
#include <vulkan/vulkan_raii.hpp>

namespace dmvv::runtime {

/// Commands that were submitted. What they use must stay until they are done. Waits for them when it goes.
class Submission {
 public:
  Submission() = default;
  Submission(Submission&&) noexcept = default;
  Submission& operator=(Submission&& other) noexcept;
  ~Submission();

  /// Waits until the commands are done; what they wrote for the host can be read then. Returns the milliseconds they
  /// took by the device's own time stamps; 0 if it has none. Throws vk::SystemError if the device is lost.
  double wait();

 private:
  friend class Queue;
  void finish() noexcept;

  const vk::raii::Device* device_ = nullptr;
  vk::raii::CommandPool pool_{nullptr};
  vk::raii::CommandBuffer commands_{nullptr};
  vk::raii::QueryPool timer_{nullptr};
  vk::raii::Fence fence_{nullptr};
  std::uint32_t timer_bits_ = 0;
  double ms_a_tick_ = 0.0;
};

/// The one queue of a device. Any thread may submit: commands are recorded into a pool of their own, and a lock holds
/// the queue only while they are handed over. Submissions begin in the order in which they were submitted; what must
/// have ended before is up to their barriers.
class Queue {
 public:
  Queue() = default;
  Queue(const vk::raii::PhysicalDevice& physical, const vk::raii::Device& device, std::uint32_t family);

  /// Records commands and submits them. Returns at once.
  Submission submit(const std::function<void(const vk::raii::CommandBuffer&)>& record) const;
  /// Whether there are time stamps.
  bool is_timed() const { return timer_bits_ != 0; }

 private:
  const vk::raii::Device* device_ = nullptr;
  vk::raii::Queue queue_{nullptr};
  std::uint32_t family_ = 0;
  std::uint32_t timer_bits_ = 0;  ///< of a time stamp that count
  double ms_a_tick_ = 0.0;
  std::unique_ptr<std::mutex> lock_;
};

}  // namespace dmvv::runtime
