#include "runtime/view/frame_passes.h"

namespace dmvv::runtime {

const std::vector<FramePassInfo>& frame_pass_names() {
  static const std::vector<FramePassInfo> passes{
      {"pixel-list", "pixels without a surface are not evaluated"},
      {"clusters", "what lies beside the picture or is cut away is not drawn; what no cut meets is not tested"},
      {"keep-surface", "what stands still before a camera that stands still is not drawn again"},
      {"keep-picture", "a frame in which nothing changed is not evaluated again"},
      {"verdicts", "where a proof tells the answer, nothing is evaluated; proofs are made from the second frame on"},
      {"trials", "of verdicts and reach only what makes frames faster is used, as is tried now and then"},
      {"reach", "one pixel of 4 x 4 tells how far its answer holds; those within are not evaluated"},
      {"keep-still", "while only the time changes, what does not depend on it is not evaluated again"},
  };
  return passes;
}

}  // namespace dmvv::runtime
