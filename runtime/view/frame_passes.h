// The passes of a frame that can be switched off.
#pragma once

#include <string_view>
#include <vector>

namespace dmvv::runtime {

/// What is left out of a frame, name and one sentence each; none changes a picture.
struct FramePassInfo {
  std::string_view name;
  std::string_view what;
};
const std::vector<FramePassInfo>& frame_pass_names();

}  // namespace dmvv::runtime
