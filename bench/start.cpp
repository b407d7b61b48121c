#include "bench/start.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <optional>

namespace dmvv::bench {
namespace {

std::string text_of(const glm::dvec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

std::vector<std::string> command(const SceneSource& source, const StartOptions& options, const std::string& picture) {
  std::vector<std::string> words{options.program, "render", source.path, "-o", picture, "--quiet", "--size",
                                 fmt::format("{}x{}", options.size_px.x, options.size_px.y), "--time", fmt::format("{}", source.time_ms)};
  const auto add = [&](const char* option, std::string value) {
    words.emplace_back(option);
    words.push_back(std::move(value));
  };
  if (!source.root.empty()) add("--root", source.root);
  if (!source.mesh_path.empty()) add("--mesh", source.mesh_path);
  for (const runtime::Plane& cut : source.cuts) add("--cut", fmt::format("{} {}", text_of(cut.normal), cut.d));
  if (const auto& camera = source.camera) {
    add("--camera", fmt::format("eye {} look {} up {} fov {}", text_of(camera->eye), text_of(camera->look), text_of(camera->up),
                                camera->fov_deg / source.zoom));
  }
  return words;
}

/// The process' environment, but for the folder of all caches.
std::vector<std::string> environment(const std::string& caches) {
  std::vector<std::string> variables{"XDG_CACHE_HOME=" + caches};
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    const bool is_cache = text.starts_with("XDG_CACHE_HOME=") || text.starts_with("MESA_SHADER_CACHE_") || text.starts_with("__GL_SHADER_DISK_CACHE");
    if (!is_cache) variables.emplace_back(text);
  }
  return variables;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> result;
  for (std::string& word : words) result.push_back(word.data());
  result.push_back(nullptr);
  return result;
}

/// Milliseconds that it took; none if it failed.
std::optional<double> run(std::vector<std::string> words, const std::string& caches) {
  std::vector<std::string> variables = environment(caches);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const auto start = std::chrono::steady_clock::now();
  pid_t process = -1;
  const int error = posix_spawn(&process, words.front().c_str(), &files, nullptr, pointers(words).data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&files);
  int status = 0;
  if (error != 0 || waitpid(process, &status, 0) != process || !WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Starts measure_starts(const SceneSource& source, const StartOptions& options) {
  Starts starts{source.name, {}, {}, {}};
  const TemporaryFolder pictures;
  const std::vector<std::string> words = command(source, options, pictures.path() + "/picture.png");
  for (std::uint32_t i = 0; i < options.cold; ++i) {
    const TemporaryFolder caches;
    const auto once = [&](std::vector<double>& times) {
      const auto ms = run(words, caches.path());
      if (ms) times.push_back(*ms);
      else starts.failure = fmt::format("'{}' failed", fmt::join(words, " "));
    };
    once(starts.cold_ms);
    if (i + 1 == options.cold) {
      for (std::uint32_t k = 0; k < options.warm; ++k) once(starts.warm_ms);
    }
    if (!starts.failure.empty()) break;
  }
  return starts;
}

}  // namespace dmvv::bench
