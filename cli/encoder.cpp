#include "cli/encoder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <sstream>
#include <system_error>
#include <utility>

#include "base/files.h"
#include "voml/assets/image_file.h"

extern char** environ;

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;

std::string reason(int error_number) { return std::generic_category().message(error_number); }

/// Colours are BT.709 in the limited range, and say so; players guess otherwise.
std::vector<std::string> arguments_of(const Encoder::Options& options) {
  const bool is_mp4 = options.format == ClipFormat::mp4;
  std::vector<std::string> words{options.ffmpeg,
                                 "-nostdin",
                                 "-hide_banner",
                                 "-loglevel",
                                 "error",
                                 "-y",
                                 "-f",
                                 "rawvideo",
                                 "-pixel_format",
                                 is_mp4 ? "rgb24" : "rgba",
                                 "-video_size",
                                 fmt::format("{}x{}", options.size_px.x, options.size_px.y),
                                 "-framerate",
                                 fmt::format("{}", options.fps),
                                 "-i",
                                 "pipe:0",
                                 "-vf",
                                 "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int",
                                 "-colorspace",
                                 "bt709",
                                 "-color_primaries",
                                 "bt709",
                                 "-color_trc",
                                 "bt709",
                                 "-color_range",
                                 "tv",
                                 "-fflags",
                                 "+bitexact",
                                 "-flags:v",
                                 "+bitexact"};
  const std::vector<std::string> codec =
      is_mp4 ? std::vector<std::string>{"-c:v",     "libx264", "-preset",   "medium",     "-crf", "18",
                                        "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f",   "mp4"}
             : std::vector<std::string>{"-c:v", "libvpx-vp9", "-crf", "24",       "-b:v",     "0",  "-row-mt",
                                        "1",    "-cpu-used",  "2",    "-pix_fmt", "yuva420p", "-f", "webm"};
  words.insert(words.end(), codec.begin(), codec.end());
  words.push_back("file:" + options.clip);  // whatever the name looks like
  return words;
}

/// The program runs in a process group of its own: Ctrl-C is for us, who then stop it.
Result<pid_t> spawn(const std::vector<std::string>& words, int input, const std::string& log) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t process = -1;
  const int error = posix_spawn(&process, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) return fail(Fault::environment, fmt::format("cannot start '{}': {}", words[0], reason(error)));
  return process;
}

std::uint8_t over_white(std::uint32_t value, std::uint32_t alpha) {
  return static_cast<std::uint8_t>((value * alpha + 255 * (255 - alpha) + 127) / 255);
}

constexpr std::uint64_t most_frame_bytes = std::uint64_t{1} << 32;

std::vector<std::uint8_t> opaque(const std::vector<std::uint8_t>& rgba) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    for (std::size_t channel = 0; channel < 3; ++channel) rgb.push_back(over_white(rgba[i + channel], rgba[i + 3]));
  }
  return rgb;
}

}  // namespace

Result<std::string> find_ffmpeg() {
  if (auto program = find_program("ffmpeg")) return std::move(*program);
  return fail(Fault::environment, "clips are encoded by the program ffmpeg, which is not there",
              {"install it: apt-get install ffmpeg", "or write the frames themselves: -o frames_%04d.png"});
}

Result<std::vector<std::uint8_t>> read_frame(const std::string& path, glm::uvec2 size_px, ClipFormat format) {
  const auto failed = [&](const std::string& why) {
    return fail(Fault::environment, fmt::format("cannot read the frame '{}': {}", path, why),
                {"run the same command again: damaged frames are drawn again"});
  };
  const std::uint64_t samples = std::uint64_t{4} * size_px.x * size_px.y;
  const auto bytes = disk_files()(path, most_frame_bytes);
  if (!bytes) return failed(bytes.error().message);
  const auto image = decode_image(*bytes, path, samples);
  if (!image) return failed(image.error().message);
  if (image->width != size_px.x || image->height != size_px.y || image->channels != 4) {
    return failed(fmt::format("it is {}x{} with {} channels", image->width, image->height, image->channels));
  }
  return format == ClipFormat::mp4 ? opaque(image->samples) : image->samples;
}

Result<Encoder> Encoder::start(Options options) {
  // A socket, not a pipe: writing to a program that has ended is then an error and no signal.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    return fail(Fault::environment, fmt::format("cannot speak to ffmpeg: {}", reason(errno)));
  }
  const auto process = spawn(arguments_of(options), ends[0], options.log);
  close(ends[0]);
  if (!process) {
    close(ends[1]);
    return tl::unexpected(process.error());
  }
  return Encoder(std::move(options), *process, ends[1]);
}

Encoder::Encoder(Encoder&& other) noexcept
    : options_(std::move(other.options_)),
      process_(std::exchange(other.process_, -1)),
      frames_(std::exchange(other.frames_, -1)) {}

Encoder::~Encoder() {
  close_frames();
  if (process_ == -1) return;
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) == -1 && errno == EINTR) continue;
}

void Encoder::close_frames() {
  if (frames_ != -1) close(std::exchange(frames_, -1));
}

Error Encoder::failure() const {
  Error error{Fault::environment, "ffmpeg could not encode the clip", {}};
  std::istringstream lines(disk_files()(options_.log, 1 << 20).value_or(""));
  for (std::string line; std::getline(lines, line);) error.reasons.push_back("ffmpeg: " + line);
  constexpr std::size_t most = 10;
  if (error.reasons.size() > most) error.reasons.erase(error.reasons.begin(), error.reasons.end() - most);
  error.reasons.push_back("the frames are kept; the same command encodes them again");
  return error;
}

Result<void> Encoder::write(std::span<const std::uint8_t> pixels) {
  while (!pixels.empty()) {
    const ssize_t sent = send(frames_, pixels.data(), pixels.size(), MSG_NOSIGNAL);
    if (sent == -1 && errno == EINTR) continue;
    if (sent == -1) {  // it has ended, or closed its input on the way there: wait for its last words
      if (auto finished = finish(); !finished) return finished;
      return tl::unexpected(failure());
    }
    pixels = pixels.subspan(static_cast<std::size_t>(sent));
  }
  return {};
}

Result<void> Encoder::finish() {
  close_frames();
  int status = 0;
  while (waitpid(process_, &status, 0) == -1 && errno == EINTR) continue;
  process_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return tl::unexpected(failure());
  return {};
}

}  // namespace dmvv::cli
