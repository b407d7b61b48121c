// Starts of a program that writes down how it was started.
#include "bench/start.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cstdint>
#include <sstream>

#include "base/files.h"

namespace dmvv::bench {
namespace {

std::string script(const TemporaryFolder& folder, const std::string& commands) {
  const std::string path = folder.path() + "/program";
  REQUIRE(write_file(path, "#!/bin/sh\n" + commands));
  REQUIRE(chmod(path.c_str(), 0700) == 0);
  return path;
}

SceneSource scene() {
  SceneSource source;
  source.name = "s";
  source.path = "s.voml";
  return source;
}

std::vector<std::string> lines_of(const std::string& path) {
  std::istringstream text(disk_files()(path, 1 << 20).value());
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

TEST_CASE("cold starts find no cache, warm ones what the last cold one left") {
  const TemporaryFolder folder;
  const std::string log = folder.path() + "/log";
  const std::string program = script(folder, fmt::format("ls \"$XDG_CACHE_HOME\" | wc -l >> '{0}'\n"
                                                         "echo \"$MESA_SHADER_CACHE_DIR\" > '{0}.mesa'\n"
                                                         "touch \"$XDG_CACHE_HOME/left\"\n",
                                                         log));
  setenv("MESA_SHADER_CACHE_DIR", "elsewhere", 1);
  const Starts starts = measure_starts(scene(), {.program = program, .size_px = {64, 64}, .cold = 2, .warm = 3});
  unsetenv("MESA_SHADER_CACHE_DIR");
  CHECK(starts.failure.empty());
  CHECK(starts.cold_ms.size() == 2);
  CHECK(starts.warm_ms.size() == 3);
  for (const double ms : starts.cold_ms) CHECK(ms > 0.0);
  CHECK(lines_of(log) == std::vector<std::string>{"0", "0", "1", "1", "1"});
  CHECK(lines_of(log + ".mesa") == std::vector<std::string>{""});
}

TEST_CASE("the program is told how to look at the scene") {
  const TemporaryFolder folder;
  const std::string log = folder.path() + "/log";
  const std::string program = script(folder, fmt::format("for word; do echo \"$word\" >> '{}'; done\n", log));
  SceneSource source = scene();
  source.root = "O.A";
  source.mesh_path = "m.ply";
  source.cuts = {{{0.0, 0.0, 1.0}, 0.25}};
  source.camera =
      runtime::Camera{.eye = {3.0, 2.0, 1.0}, .look = {0.0, 0.5, 0.0}, .up = {0.0, 1.0, 0.0}, .fov_deg = 40.0};
  source.zoom = 8.0;
  source.time_ms = 40.0;
  const Starts starts = measure_starts(source, {.program = program, .size_px = {64, 32}, .cold = 1, .warm = 0});
  CHECK(starts.failure.empty());
  std::vector<std::string> words = lines_of(log);
  REQUIRE(words.size() == 17);
  words.erase(words.begin() + 3);  // the picture, somewhere
  CHECK(words == std::vector<std::string>{"render", "s.voml", "-o", "--quiet", "--size", "64x32", "--time", "40",
                                          "--root", "O.A", "--mesh", "m.ply", "--cut", "0 0 1 0.25", "--camera",
                                          "eye 3 2 1 look 0 0.5 0 up 0 1 0 fov 5"});
}

TEST_CASE("a start that fails is told with its command, and is not measured") {
  const TemporaryFolder folder;
  const std::string fails = script(folder, "exit 1\n");
  const Starts starts = measure_starts(scene(), {.program = fails});
  CHECK(starts.failure.starts_with("'" + fails + " render s.voml"));
  CHECK(starts.cold_ms.empty());
  CHECK(starts.warm_ms.empty());
  CHECK(!measure_starts(scene(), {.program = folder.path() + "/nothing"}).failure.empty());
}

}  // namespace
}  // namespace dmvv::bench
