#include "runtime/frame/frame_kernels.h"

#include "spirv/classify_comp.h"
#include "spirv/compose_comp.h"
#include "spirv/count_groups_comp.h"
#include "spirv/count_hits_comp.h"
#include "spirv/count_stages_comp.h"
#include "spirv/distribute_comp.h"
#include "spirv/follow_comp.h"
#include "spirv/list_comp.h"
#include "spirv/paint_bitmaps_comp.h"
#include "spirv/paint_comp.h"

namespace dmvv::runtime {
namespace {

bool runs_kernel(Step step) {
  return step != Step::raster && step != Step::slice && step != Step::set_out && step != Step::clear &&
         step != Step::report && step != Step::bring_home;
}

bool asks_verdicts(Step step) { return step == Step::classify || step == Step::paint || step == Step::count_hits; }

std::string_view kernel_name(Step step) {
  if (step == Step::cones || step == Step::trace) return compiler::rays_kernel.name;
  if (step == Step::normals) return compiler::normals_kernel.name;
  return step == Step::lead ? compiler::leaders_kernel.name : compiler::pixels_kernel.name;
}

bool writes_pixels(Step step) {
  return step == Step::paint || step == Step::lead || step == Step::follow || step == Step::evaluate ||
         step == Step::stage;
}

}  // namespace

FrameKernels::FrameKernels(const Device::Impl& gpu, const SceneOnDevice& scene, const compiler::Program& program,
                           vk::raii::DescriptorSetLayout verdicts)
    : gpu_(gpu),
      has_bitmaps_(scene.has_bitmaps()),
      io_layout_(make_set_layout(gpu, pixel_bindings)),
      verdict_layout_(std::move(verdicts)),
      layout_(make_pipeline_layout(gpu, std::array{*scene.layout(), *io_layout_}, sizeof(gpu::StepParams))),
      layout_with_verdicts_(make_pipeline_layout(gpu, std::array{*scene.layout(), *io_layout_, *verdict_layout_},
                                                 sizeof(gpu::StepParams))) {
  const auto code = [&](const compiler::KernelSpec& spec) {
    const auto* const kernel = program.find_kernel(spec.name);
    return kernel != nullptr ? kernel->shaders.front().spirv : std::vector<std::uint32_t>{};
  };
  code_of_leaders_ = code(compiler::leaders_kernel);
  code_of_rays_ = code(compiler::rays_kernel);
  code_of_normals_ = code(compiler::normals_kernel);
  code_of_media_ = code(compiler::media_kernel);
  const auto* const pixels = program.find_kernel(compiler::pixels_kernel.name);
  if (pixels == nullptr) return;
  for (const compiler::Shader& shader : pixels->shaders) {
    code_of_pixels_.push_back(shader.spirv);
    if (pixels->is_staged()) stages_go_on_.push_back(shader.has_next);
  }
}

std::span<const std::uint32_t> FrameKernels::code_of(Step step, std::uint32_t stage) const {
  switch (step) {
    case Step::list:
      return list_comp;
    case Step::classify:
      return classify_comp;
    case Step::count_lists:
      return count_groups_comp;
    case Step::paint:
      if (has_bitmaps_) return paint_bitmaps_comp;
      return paint_comp;
    case Step::lead:
      return code_of_leaders_;
    case Step::follow:
      return follow_comp;
    case Step::evaluate:
      if (code_of_pixels_.empty()) return {};
      return code_of_pixels_.front();
    case Step::count_stages:
      return count_stages_comp;
    case Step::stage:
      return code_of_pixels_[stage];
    case Step::distribute:
      return distribute_comp;
    case Step::count_hits:
      return count_hits_comp;
    case Step::cones:
    case Step::trace:
      return code_of_rays_;
    case Step::normals:
      return code_of_normals_;
    case Step::media:
      return code_of_media_;
    case Step::compose:
      return compose_comp;
    case Step::raster:
    case Step::slice:
    case Step::set_out:
    case Step::clear:
    case Step::report:
    case Step::bring_home:
      break;
  }
  return {};
}

FrameKernels::Key FrameKernels::key_of(Step step, std::uint32_t stage, const KernelKind& kind) const {
  const Step first = step == Step::cones ? Step::trace : step;  // one kernel does both
  return {first, step == Step::stage ? stage : 0, writes_pixels(step) ? kind : KernelKind{}};
}

Result<void> FrameKernels::prepare(const FramePlan& plan, const KernelKind& kind) {
  for (const TilePlan& tile : plan.tiles) {
    for (const PlannedStep& planned : tile.steps) {
      if (!runs_kernel(planned.step)) continue;
      const Key key = key_of(planned.step, planned.stage, kind);
      if (made_.contains(key)) continue;
      const std::span<const std::uint32_t> code = code_of(planned.step, planned.stage);
      if (code.empty()) {
        return fail(Fault::environment,
                    fmt::format("the program was compiled without its kernel '{}'", kernel_name(planned.step)));
      }
      const std::array<std::uint32_t, 3> constants{kind.lists, kind.as_bytes, kind.with_regions};
      const auto used =
          writes_pixels(planned.step) ? std::span<const std::uint32_t>(constants) : std::span<const std::uint32_t>();
      const auto& layout = asks_verdicts(planned.step) ? layout_with_verdicts_ : layout_;
      made_.emplace(key, make_compute_pipeline(gpu_, code, layout, used));
    }
  }
  return {};
}

bool FrameKernels::has_evaluation(const KernelKind& kind) const {
  const Step step = stages_go_on_.empty() ? Step::evaluate : Step::stage;
  return made_.contains(key_of(step, 0, kind));
}

FrameKernels::Bound FrameKernels::at(Step step, std::uint32_t stage, const KernelKind& kind) const {
  const bool asks = asks_verdicts(step);
  return {*made_.at(key_of(step, stage, kind)), asks ? *layout_with_verdicts_ : *layout_, asks};
}

}  // namespace dmvv::runtime
