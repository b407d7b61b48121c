// Inside the runtime only: a tree of verdicts on the device, and when it is worth splitting its cells.
#pragma once

#include <memory>

#include "compiler/judge.h"
#include "compiler/verdict_tree.h"
#include "runtime/gpu.h"

namespace dmvv::runtime {

/// What is proven of a scene, for one time span after the other.
///
/// Rent or buy: a cell is split when the pixels that it left to be evaluated have cost as much as splitting it. So what is
/// spent on proofs is at most what was spent on evaluation, and twice the best that could have been done.
class Verdicts {
 public:
  /// Memory: 36 MiB on the device at most, which the host writes.
  Verdicts(const Device::Impl& gpu, std::shared_ptr<const compiler::Judge> judge);

  const vk::raii::DescriptorSetLayout& layout() const { return layout_; }
  const vk::raii::DescriptorSet& set() const { return set_; }

  /// Hits after which a cell is named busy: a power of two; 0: nothing more can be split.
  std::uint32_t hits_to_split() const;

  /// Call before a frame is submitted: forgets the busy cells of the last one.
  void begin_frame();
  /// Call when the device is done: `evaluated` pixels took `ms`, the surface apart. Splits busy cells for as long, at most.
  void end_frame(std::size_t evaluated, double ms);

  /// Changes whenever a cell was split.
  std::size_t generation() const { return generation_; }

 private:
  void begin_tree();

  std::shared_ptr<const compiler::Judge> judge_;
  GpuBuffer words_, hits_, outcomes_, busy_;
  vk::raii::DescriptorSetLayout layout_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::raii::DescriptorSet set_{nullptr};
  std::optional<compiler::VerdictTree> tree_;
  std::size_t generation_ = 0;
  double ns_a_pixel_ = 0.0;   ///< of evaluation, as last measured on many pixels; 0: not yet
  std::size_t most_evaluated_ = 0;
  double ns_a_cell_ = 1e5;    ///< of splitting, as last measured
};

}  // namespace dmvv::runtime
