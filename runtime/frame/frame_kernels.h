// Inside the runtime only: the kernels over a frame's pixels, made when first needed.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "compiler/program.h"
#include "runtime/frame/frame_images.h"
#include "runtime/frame/frame_plan.h"
#include "runtime/frame/scene_on_device.h"

namespace dmvv::runtime {

/// What kernels that write pixels are specialised to.
struct KernelKind {
  bool lists = true;
  bool as_bytes = false;
  bool with_regions = false;
  friend auto operator<=>(const KernelKind&, const KernelKind&) = default;
};

class FrameKernels {
 public:
  /// `verdicts` is the layout of descriptor set 2.
  FrameKernels(const Device::Impl& gpu, const SceneOnDevice& scene, const compiler::Program& program,
               vk::raii::DescriptorSetLayout verdicts);

  const vk::raii::DescriptorSetLayout& io_layout() const { return io_layout_; }
  const vk::raii::DescriptorSetLayout& verdict_layout() const { return verdict_layout_; }

  bool has_rays() const { return !code_of_rays_.empty(); }
  bool has_media() const { return !code_of_media_.empty(); }
  bool has_leaders() const { return !code_of_leaders_.empty(); }
  const std::vector<bool>& stages_go_on() const { return stages_go_on_; }

  /// Makes what the plan's steps need and is not there. Errors (environment): the program was compiled without the
  /// kernel.
  Result<void> prepare(const FramePlan& plan, const KernelKind& kind);
  /// Whether `prepare` would make the kernels that evaluate.
  bool has_evaluation(const KernelKind& kind) const;

  struct Bound {
    vk::Pipeline pipeline;
    vk::PipelineLayout layout;
    bool asks_verdicts;
  };
  /// The kernel of a step that `prepare` has seen.
  Bound at(Step step, std::uint32_t stage, const KernelKind& kind) const;

 private:
  struct Key {
    Step step;
    std::uint32_t stage;
    KernelKind kind;
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  /// Kernels that write no pixels are the same for all kinds.
  Key key_of(Step step, std::uint32_t stage, const KernelKind& kind) const;
  std::span<const std::uint32_t> code_of(Step step, std::uint32_t stage) const;

  const Device::Impl& gpu_;
  bool has_bitmaps_;
  std::vector<std::uint32_t> code_of_leaders_, code_of_rays_, code_of_normals_, code_of_media_;
  std::vector<std::vector<std::uint32_t>> code_of_pixels_;  ///< of each stage
  std::vector<bool> stages_go_on_;
  vk::raii::DescriptorSetLayout io_layout_, verdict_layout_;
  vk::raii::PipelineLayout layout_, layout_with_verdicts_;
  std::map<Key, vk::raii::Pipeline> made_;
};

}  // namespace dmvv::runtime
