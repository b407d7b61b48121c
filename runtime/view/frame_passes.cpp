#include "runtime/view/frame_passes.h"

#include <algorithm>

namespace dmvv::runtime {

const std::vector<FramePassInfo>& frame_pass_names() {
  static const std::vector<FramePassInfo> passes{
#define DMVV_FRAME_PASS(member, name, what) {name, what},
#include "runtime/view/frame_passes.def"
#undef DMVV_FRAME_PASS
  };
  return passes;
}

FramePasses FramePasses::without(std::span<const std::string> disabled) {
  const auto is_enabled = [&](std::string_view name) { return std::ranges::find(disabled, name) == disabled.end(); };
  FramePasses passes;
#define DMVV_FRAME_PASS(member, name, what) passes.member = is_enabled(name);
#include "runtime/view/frame_passes.def"
#undef DMVV_FRAME_PASS
  return passes;
}

}  // namespace dmvv::runtime
