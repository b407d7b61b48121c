// The frames of an animation: under which names, and whether a file holds one whole. Pure but for the
// last. The rules stand in spec/animate.md.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace dmvv::cli {

/// Frames first to last, both included.
struct FrameRange {
  std::uint32_t first;
  std::uint32_t last;
};
/// "20-39", or "7" for one; of the frames 0 .. count - 1. `count` is at least 1.
Result<FrameRange> parse_frame_range(std::string_view text, std::uint32_t count);

/// File names with the frame's number in them, in one folder.
class FrameNames {
 public:
  /// Reads a path that ends in .png, with one %d, %4d or %04d (up to 9 digits) in its last part; %% stands for a
  /// percent sign there. A number that needs more digits gets them.
  static Result<FrameNames> parse(const std::string& path);

  const std::string& folder() const { return folder_; }    ///< "." if the path names none
  const std::string& pattern() const { return pattern_; }  ///< the last part, as written
  std::string name(std::uint32_t frame) const;             ///< without the folder
  /// The frame whose name this is, if it is one's.
  std::optional<std::uint32_t> frame_of(std::string_view name) const;

 private:
  std::string folder_;
  std::string pattern_;
  std::string before_, after_;  ///< of the number
  int digits_ = 0;
  bool zeros_ = false;  ///< filled with zeros, else with blanks
};

/// Whether the file is a PNG picture of this size, 8 bits a channel, with alpha, from its signature to its last chunk,
/// and every chunk has the checksum it announces: then it is what was once written, byte for byte.
/// Source: PNG specification (W3C 2003), sections 5.2, 5.3 and 11.2.2, annex D.
bool is_whole_frame(const std::string& path, glm::uvec2 size_px);

}  // namespace dmvv::cli
