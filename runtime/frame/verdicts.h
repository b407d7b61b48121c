// Inside the runtime only: trees of verdicts on the device, and when it is worth splitting their cells.
#pragma once

#include <memory>

#include "compiler/proofs/judge.h"
#include "compiler/proofs/verdict_tree.h"
#include "runtime/gpu/gpu.h"

namespace dmvv::runtime {

/// What is proven of a scene: in one tree for ever, in another for the span of time in which the frames are.
///
/// Rent or buy: a cell is split when the pixels that it left to be evaluated have cost half as much as splitting it. So what
/// is spent on proofs is at most twice what was spent on evaluation.
class Verdicts {
 public:
  /// Memory: 72 MiB on the device at most, which the host writes.
  Verdicts(const Device::Impl& gpu, std::shared_ptr<const compiler::Judge> judge);

  const vk::raii::DescriptorSetLayout& layout() const { return layout_; }
  const vk::raii::DescriptorSet& set() const { return set_; }

  /// Call before a frame is submitted, with its time.
  void begin_frame(double time_ms);
  /// Tells `classify` what it needs to know.
  void fill(gpu::PixelsParams& params) const;
  /// Call when the device is done in `ms`, in which it evaluated so many pixels and `drew` the surface or not. Splits busy
  /// cells for a quarter of that time, at most; returns what that took.
  double end_frame(std::uint32_t evaluated, double ms, bool drew);

 private:
  /// A tree in its part of the memory.
  struct Grove {
    compiler::VerdictTree::Memory memory;
    std::optional<compiler::VerdictTree> tree;
    std::vector<std::uint32_t> busy;  ///< cells that are to be split when there is time, in the order they were named
    std::uint32_t frames_full = 0;  ///< in which there were cells to split and no memory
  };
  void begin_span(double time_ms);
  void judge_span();
  std::uint32_t hits_to_split() const;
  /// Splits the first of the busy cells. Returns milliseconds.
  double split(Grove& grove, std::size_t most_cells);

  std::shared_ptr<const compiler::Judge> judge_;
  GpuBuffer words_, hits_, outcomes_, busy_;
  vk::raii::DescriptorSetLayout layout_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::raii::DescriptorSet set_{nullptr};

  Grove always_, span_;
  std::optional<compiler::Judge::Times> times_;  ///< of span_; none if no span is worth it
  double last_time_ms_ = 0.0;
  bool has_time_ = false;

  bool is_pixel_measured_ = false;  ///< in a frame without a surface to draw; else it is guessed
  double ns_a_pixel_ = 0.0;  ///< of evaluation, as last measured on many pixels; 0: not yet
  std::size_t most_evaluated_ = 0;
  double split_ns_ = 5e5, split_cells_ = 10.0;  ///< what splitting cost lately, and of how many cells
  double ns_a_cell() const { return split_ns_ / split_cells_; }

  // Whether spans pay.
  double spent_ns_ = 0.0, saved_ns_ = 0.0;  ///< in this span
  std::uint32_t first_count_ = 0;           ///< most pixels that a frame of it had to evaluate
  std::uint32_t pause_ = 0, next_pause_ = 1;  ///< frames without a span, now and after the next that does not pay
};

}  // namespace dmvv::runtime
