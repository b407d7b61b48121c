// The passes of a frame that can be switched off; none changes a picture.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dmvv::runtime {

/// What is left out of a frame: name and one sentence each.
struct FramePassInfo {
  std::string_view name;
  std::string_view what;
};
const std::vector<FramePassInfo>& frame_pass_names();

/// Which passes a frame has.
struct FramePasses {
#define DMVV_FRAME_PASS(member, name, what) bool member = true;
#include "runtime/view/frame_passes.def"
#undef DMVV_FRAME_PASS

  /// All but those that are named; other names are those of the compiler's passes.
  static FramePasses without(std::span<const std::string> disabled);
  friend bool operator==(const FramePasses&, const FramePasses&) = default;
};

}  // namespace dmvv::runtime
