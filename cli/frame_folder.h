// The folder of an animation's frames: a MANIFEST.json that says how all of them were made, and the frames that are
// there. Several runs may fill it at once. The rules stand in spec/animate.md.
#pragma once

#include <glm/vec2.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "cli/frames.h"

namespace dmvv::cli {

/// Every file is made in a folder of its own within the folder and then renamed, so nothing half-written ever has a
/// frame's name; what a killed run left behind is removed by the next one that is alone.
class FrameFolder {
 public:
  /// `manifest` says what determines the frames' pixels; all of it must be the same for frames to be kept, except what
  /// "scene" says. Nothing is touched yet.
  FrameFolder(FrameNames names, glm::uvec2 size_px, nlohmann::ordered_json manifest);
  FrameFolder(const FrameFolder&) = delete;
  FrameFolder& operator=(const FrameFolder&) = delete;
  ~FrameFolder();

  /// Refuses (input) a folder that holds frames made otherwise (says what differs), or frames of which no manifest says
  /// how they were made.
  Result<void> check() const;

  /// Makes the folder if it is missing, and the manifest. With `restart` the frames that are there are removed instead
  /// of checked; refused (input) while another run fills the folder.
  Result<void> begin(bool restart);

  /// Those of the range that are not there whole.
  std::vector<std::uint32_t> missing(FrameRange range) const;

  std::string path(std::uint32_t frame) const;
  /// Where to make the file that will be `name`; the same names until `publish`. After begin().
  std::string partial(std::string_view name) const;
  /// The finished partial(name) becomes `target`, which must be on the same file system.
  Result<void> publish(std::string_view name, const std::string& target) const;
  /// A file beside the frames.
  std::string file(std::string_view name) const;
  const FrameNames& names() const { return names_; }

  /// Removes the frames and the manifest, and the folder if nothing else is in it. False, and nothing is removed, if
  /// another run is using it.
  bool remove();

 private:
  class Lock;

  void remove_frames() const;
  void remove_partials() const;

  FrameNames names_;
  glm::uvec2 size_px_;
  nlohmann::ordered_json manifest_;
  std::unique_ptr<Lock> lock_;
  std::string partials_;  ///< this run's own folder; empty before begin()
};

}  // namespace dmvv::cli
