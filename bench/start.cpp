#include "bench/start.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <optional>

#include "base/files.h"
#include "bench/process.h"

namespace dmvv::bench {
namespace {

std::string text_of(const glm::dvec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

std::vector<std::string> command(const SceneSource& source, const StartOptions& options, const std::string& picture) {
  std::vector<std::string> words{options.program, "render",
                                 source.path,     "-o",
                                 picture,         "--quiet",
                                 "--size",        fmt::format("{}x{}", options.size_px.x, options.size_px.y),
                                 "--time",        fmt::format("{}", source.time_ms)};
  const auto add = [&](const char* option, std::string value) {
    words.emplace_back(option);
    words.push_back(std::move(value));
  };
  if (!source.root.empty()) add("--root", source.root);
  if (!source.mesh_path.empty()) add("--mesh", source.mesh_path);
  for (const runtime::Plane& cut : source.cuts) add("--cut", fmt::format("{} {}", text_of(cut.normal), cut.d));
  if (const auto& camera = source.camera) {
    add("--camera", fmt::format("eye {} look {} up {} fov {}", text_of(camera->eye), text_of(camera->look),
                                text_of(camera->up), camera->fov_deg / source.zoom));
  }
  return words;
}

/// Those of this process, but for the folder of all caches.
std::vector<std::string> variables_with(const std::string& caches) {
  std::vector<std::string> variables = environment_variables();
  std::erase_if(variables, [](const std::string& variable) {
    return variable.starts_with("XDG_CACHE_HOME=") || variable.starts_with("MESA_SHADER_CACHE_") ||
           variable.starts_with("__GL_SHADER_DISK_CACHE");
  });
  variables.push_back("XDG_CACHE_HOME=" + caches);
  return variables;
}

/// Milliseconds that it took; none if it failed.
std::optional<double> timed(const std::vector<std::string>& words, const std::string& caches) {
  const auto start = std::chrono::steady_clock::now();
  const auto done = run_program(words, variables_with(caches), "/dev/null");
  if (!done || !*done) return std::nullopt;
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
      const auto ms = timed(words, caches.path());
      if (ms)
        times.push_back(*ms);
      else
        starts.failure = fmt::format("'{}' failed", fmt::join(words, " "));
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
