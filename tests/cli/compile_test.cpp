// dmvv compile: which files, and the same bytes twice.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/cli/program.h"
#include "tests/cli/scenes.h"

using namespace dmvv::tests;

namespace {

/// A ball of radius 0.5, its cube embedded twice.
std::string ball_scene(const Folder& folder) {
  folder.write("ball.lxn",
               sampled(8, [](const glm::dvec3& q) { return std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z) - 0.5; }));
  return folder.write("scene.voml", R"(<MVV>
  <OBJECT name="BALL"><SDF name="F" file="ball.lxn"/><REGION name="R.BALL" type="color" rgb="1 0 0"/></OBJECT>
  <OBJECT name="TWO"><REGION name="R.TWO" type="color" rgb="0 1 0">
    <EMBEDDED name="BALL" translate="-0.5 0 0" scale="0.5 0.5 0.5"/>
    <EMBEDDED name="BALL" translate="0.5 0 0" scale="0.5 0.5 0.5"/>
  </REGION></OBJECT>
</MVV>)");
}

std::vector<std::string> names(const std::string& folder) {
  std::vector<std::string> result;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    result.push_back(entry.path().filename().string());
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace

TEST_CASE("every dump in each form, byte by byte the same in two runs") {
  const Folder folder;
  const std::string scene = ball_scene(folder);
  for (const std::string codegen : {"specialised", "table", "thesis"}) {
    CAPTURE(codegen);
    for (const std::string run : {"first", "second"}) {
      const Run result = run_dmvv({"compile", scene, "-o", folder.file(codegen + run), "--codegen", codegen});
      CAPTURE(result.err);
      REQUIRE(result.exit_code == 0);
      CHECK(result.err.empty());
    }
    const auto files = names(folder.file(codegen + "first"));
    CHECK(files == names(folder.file(codegen + "second")));
    for (const std::string name : {"module.txt", "points.comp", "points.spv", "points.spvasm", "pixels.comp",
                                   "pixels.spv", "pixels.spvasm", "records.txt", "atlas.txt", "stats.txt"}) {
      CHECK_MESSAGE(std::count(files.begin(), files.end(), name) == 1, name);
    }
    CHECK(std::any_of(files.begin(), files.end(), [](const std::string& name) { return name.ends_with(".exr"); }));
    for (const std::string& name : files) {
      CHECK_MESSAGE((folder.read(codegen + "first/" + name) == folder.read(codegen + "second/" + name)), name);
    }
    CHECK(folder.read(codegen + "first/pixels.spv").starts_with(std::string("\x03\x02\x23\x07", 4)));
    CHECK(folder.read(codegen + "first/pixels.spvasm").find("OpEntryPoint GLCompute") != std::string::npos);
    CHECK(folder.read(codegen + "first/stats.txt").find("candidates      2\n") != std::string::npos);
  }
}

TEST_CASE("only what was asked for, into a folder that is there") {
  const Folder folder;
  const std::string scene = ball_scene(folder);
  std::filesystem::create_directory(folder.file("dump"));
  CHECK(run_dmvv({"compile", scene, "-o", folder.file("dump"), "--dump", "glsl,stats", "--quiet"}).exit_code == 0);
  CHECK(names(folder.file("dump")) == std::vector<std::string>{"pixels.comp", "points.comp", "stats.txt"});
}

TEST_CASE("for many frames a program has its leaders and stages, and each of its shaders is written") {
  const Folder folder;
  const auto run = run_dmvv({"compile", std::string(DMVV_SOURCE_DIR) + "/examples/library/library.voml", "-o",
                             folder.file("dump"), "--many-frames", "--dump", "glsl,program"});
  CHECK(run.err == "");
  CHECK(names(folder.file("dump")) == std::vector<std::string>{"leaders.comp", "pixels.stage_0.comp",
                                                               "pixels.stage_1.comp", "points.comp", "program.dmvv"});
  CHECK(folder.read("dump/leaders.comp").find("#define DMVV_QUERY_RADIUS") != std::string::npos);
  CHECK(folder.read("dump/program.dmvv").starts_with("dmvv program\n"));
}

TEST_CASE("atlas formats and filters are dumped under their names, normalised texels as floats") {
  const Folder folder;
  const std::string scene = ball_scene(folder);
  for (const std::string format : {"r32f", "r16f", "snorm16", "snorm8"}) {
    CAPTURE(format);
    const Run run = run_dmvv({"compile", scene, "-o", folder.file(format), "--atlas", format, "--filter", "tricubic",
                              "--dump", "atlas,glsl"});
    CHECK_MESSAGE(run.exit_code == 0, run.err);
    // 8 samples and a border of two on each side.
    CHECK(folder.read(format + "/atlas.txt").find("12 x 12 x 12 texels " + format + ",") != std::string::npos);
    CHECK(folder.read(format + "/points.comp").find("sample_grid(") != std::string::npos);
  }
}

TEST_CASE("a scene without grids has no texture") {
  const Folder folder;
  CHECK(run_dmvv({"compile", folder.write("s.voml", nested_cubes), "-o", folder.file("dump"), "--dump", "atlas"})
            .exit_code == 0);
  CHECK(names(folder.file("dump")) == std::vector<std::string>{"atlas.txt"});
  CHECK(folder.read("dump/atlas.txt") == "no textures\n");
}
