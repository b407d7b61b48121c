// Frames -> clip, by the program ffmpeg as a child process.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace dmvv::cli {

enum class ClipFormat : std::uint8_t {
  mp4,   ///< H.264, 4:2:0, opaque: transparent pixels over white; both sides even
  webm,  ///< VP9, 4:2:0, with alpha
};

/// The executable of this name in a folder of $PATH. Errors (environment): there is none; names the Debian package.
Result<std::string> find_ffmpeg();

/// What the encoder eats for one frame: 3 (mp4) or 4 (webm) bytes a pixel, rows from the top.
/// Errors: a picture that cannot be read, or of another size.
Result<std::vector<std::uint8_t>> read_frame(const std::string& path, glm::uvec2 size_px, ClipFormat format);

/// A running ffmpeg. One that was not finished is stopped when it goes out of scope; what it has written stays.
class Encoder {
 public:
  struct Options {
    std::string ffmpeg;  ///< its path
    ClipFormat format;
    glm::uvec2 size_px;
    double fps;
    std::string clip;  ///< what is written
    std::string log;   ///< a file for its messages
  };
  static Result<Encoder> start(Options options);
  Encoder(Encoder&&) noexcept;
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder();

  /// The next frame. Errors (environment): ffmpeg has ended (its last messages).
  Result<void> write(std::span<const std::uint8_t> pixels);
  /// Waits until the clip is written. Errors (environment): ffmpeg failed (its last messages).
  Result<void> finish();

 private:
  Encoder(Options options, pid_t process, int frames)
      : options_(std::move(options)), process_(process), frames_(frames) {}
  void close_frames();
  Error failure() const;

  Options options_;
  pid_t process_ = -1;  ///< -1: none is running
  int frames_ = -1;     ///< its standard input
};

}  // namespace dmvv::cli
