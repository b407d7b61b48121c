// Inside the runtime only: trees of verdicts on the device.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "compiler/proofs/judge.h"
#include "compiler/proofs/verdict_tree.h"
#include "runtime/frame/proof_budget.h"
#include "runtime/gpu/descriptors.h"

namespace dmvv::runtime {

/// Descriptor set 2 of the kernels that ask verdicts.
inline constexpr std::array<SetBinding, 4> verdict_bindings{{
    {DMVV_BIND_VERDICT_WORDS, vk::DescriptorType::eStorageBuffer},
    {DMVV_BIND_VERDICT_HITS, vk::DescriptorType::eStorageBuffer},
    {DMVV_BIND_OUTCOMES, vk::DescriptorType::eStorageBuffer},
    {DMVV_BIND_BUSY_CELLS, vk::DescriptorType::eStorageBuffer},
}};

/// What is proven of a scene: in one tree for ever, in another for the span of time in which the frames are.
/// ProofBudget says how much is proven when.
class Verdicts {
 public:
  /// Memory: 72 MiB on the device at most, which the host writes.
  Verdicts(const Device::Impl& gpu, std::shared_ptr<const compiler::Judge> judge,
           const vk::raii::DescriptorSetLayout& layout);

  vk::DescriptorSet set() const { return *set_; }

  /// Call before a frame's first tile is submitted, with the frame's time.
  void begin_frame(double time_ms);
  /// Tells `classify` what it needs to know.
  void fill(gpu::FrameParams& params) const;
  /// Call when the device is done with all tiles in `ms`, in which it evaluated so many pixels and `drew` a surface or
  /// not. Splits busy cells for a quarter of that time, at most; returns what that took, in milliseconds.
  double end_frame(std::uint32_t evaluated, double ms, bool drew);

 private:
  /// A tree in its part of the memory.
  struct PlacedTree {
    compiler::VerdictTree::Memory memory;
    std::optional<compiler::VerdictTree> tree;
    std::vector<std::uint32_t> busy;  ///< cells that are to be split when there is time, in the order they were named
    std::uint32_t frames_full = 0;    ///< in which there were cells to split and no memory
  };
  void note_busy_cells();
  /// Splits the first of the busy cells. Returns milliseconds.
  double split(PlacedTree& placed, std::size_t most_cells);
  /// A full tree begins anew after a while: what is looked at now is worth more than what was.
  void renew_if_full(PlacedTree& placed);

  std::shared_ptr<const compiler::Judge> judge_;
  GpuBuffer words_, hits_, outcomes_, busy_;
  DescriptorSet set_;
  PlacedTree always_, span_;
  std::optional<compiler::Judge::Times> times_;  ///< of span_; none if no span is worth it
  ProofBudget budget_;
};

}  // namespace dmvv::runtime
