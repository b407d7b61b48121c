// dmvv render: its files, their bytes, what it says.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/program.h"
#include "tests/cli/scenes.h"

using namespace dmvv::tests;
using nlohmann::json;

TEST_CASE("render writes the picture it names, the same bytes each time, without validation messages") {
  const Folder folder;
  const std::string scene = folder.write("scene.voml", nested_cubes);
  for (const std::string name : {"p.png", "p.exr", "p.tif"}) {
    CAPTURE(name);
    std::string first;
    for (int round = 0; round < 2; ++round) {
      const Run run = run_dmvv({"render", scene, "-o", folder.file(name), "--size", "64x48", "--cut", "0 0 1 0",
                                "--samples", "2", "--validation"});
      CHECK(run.exit_code == 0);
      CHECK(run.err.empty());
      CHECK(run.out.starts_with(folder.file(name) + ": 64x48, "));
      const std::string bytes = folder.read(name);
      CHECK(bytes.size() > 100);
      if (round == 1) CHECK((bytes == first));
      first = bytes;
    }
  }
  CHECK(folder.listing().size() == 4);  // the scene and three pictures
}

TEST_CASE("quiet says nothing") {
  const Folder folder;
  const Run run = run_dmvv(
      {"render", folder.write("s.voml", nested_cubes), "-o", folder.file("p.png"), "--size", "8x8", "--quiet"});
  CHECK(run.exit_code == 0);
  CHECK(run.out.empty());
  CHECK(run.err.empty());
}

TEST_CASE("region and depth pictures, in both forms, with a legend") {
  const Folder folder;
  const std::string scene = folder.write("scene.voml", nested_cubes);
  const std::string region = "region=" + folder.file("ids.exr"), depth = "depth=" + folder.file("z.exr");
  for (const std::vector<std::string>& words : {std::vector<std::string>{region, depth}, {region + ',' + depth}}) {
    // The scene comes last: an --aov that swallowed all words would miss it.
    std::vector<std::string> arguments{"render", "-o", folder.file("p.png"), "--size", "16x16", "--aov"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    arguments.push_back(scene);
    const Run run = run_dmvv(arguments);
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    CHECK(folder.listing().size() == 5);  // scene, p.png, ids.exr, ids.json, z.exr
    const json expected = json::parse(R"({"regions":[
      {"number":1,"object":"CORE","region":"R.CORE","kind":"color","rgb":[1,0.5,0]},
      {"number":2,"object":"SHELL","region":"R.SHELL","kind":"color","rgb":[0,0,1]}]})");
    CHECK(json::parse(folder.read("ids.json")) == expected);
    for (const char* name : {"p.png", "ids.exr", "ids.json", "z.exr"}) std::remove(folder.file(name).c_str());
  }
}

TEST_CASE("the timings name every part and leave no gap") {
  const Folder folder;
  const Run run = run_dmvv(
      {"render", folder.write("s.voml", nested_cubes), "-o", folder.file("p.png"), "--size", "64x64", "--timings"});
  REQUIRE(run.exit_code == 0);
  std::istringstream lines(run.err);
  std::string line, step;
  std::getline(lines, line);
  CHECK(line == "dmvv: timings in ms");
  std::vector<std::string> steps;
  double sum = 0, ms = 0, total = -1;
  while (lines >> step >> ms) {
    if (step == "total") {
      total = ms;
    } else {
      steps.push_back(step);
      sum += ms;
    }
  }
  for (const char* part : {"read", "compile", "SPIR-V", "device", "pipeline", "upload", "frame", "encode"}) {
    CHECK_MESSAGE(std::count(steps.begin(), steps.end(), part) == 1, part);
  }
  CHECK(std::abs(sum - total) < 0.1 * static_cast<double>(steps.size() + 1));  // each is rounded to 0.1 ms
}

TEST_CASE("an open support mesh is drawn with a warning when it is cut") {
  const Folder folder;
  const std::string open =
      folder.write("open.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
  const Run run = run_dmvv({"render", folder.write("s.voml", nested_cubes), "-o", folder.file("p.png"), "--size",
                            "16x16", "--mesh", open, "--cut", "1 0 0 0"});
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("3 open edges") != std::string::npos);  // the triangle that is missing has three
}

TEST_CASE("beside a picture: normals and doubt, of what has them") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes),
                    mesh = std::string(DMVV_SOURCE_DIR) + "/tests/cli/cube.obj";
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"render", scene, "-o", folder.file("p.png"), "--size", "32x24"});
    return run_dmvv(more);
  };
  const std::string both = "normal=" + folder.file("n.exr") + ",doubt=" + folder.file("d.png");
  const Run run = with({"--aov", both});
  CHECK_MESSAGE(run.exit_code == 0, run.err);
  CHECK(folder.listing().size() == 4);
  const Run no_rays = with({"--aov", "doubt=" + folder.file("e.png"), "--mesh", mesh});
  CHECK(no_rays.exit_code == 2);
  CHECK(no_rays.err.find("--aov doubt: only rays can miss something") != std::string::npos);
  const Run section = with({"--aov", "normal=" + folder.file("m.png"), "--slice", "z=0"});
  CHECK(section.exit_code == 2);
  CHECK(section.err.find("--aov normal: a section has no normals") != std::string::npos);
  CHECK(with({"--aov", "normal=" + folder.file("m.png"), "--mesh", mesh}).exit_code == 0);
}

TEST_CASE("a picture with nothing in it says so, and how to see something") {
  const Folder folder;
  const std::string scene = folder.write("ball.voml", R"(<MVV><OBJECT name="A">
  <SDF name="S" function="true">return length(p) - 0.5;</SDF><REGION name="R" type="color" rgb="1 0 0"/></OBJECT></MVV>)");
  const std::vector<std::string> render{"render", scene, "-o", folder.file("a.png"), "--size", "32x32"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), render.begin(), render.end());
    const Run run = run_dmvv(more);
    CHECK(run.exit_code == 0);
    return run.err;
  };
  CHECK(with({}).empty());
  const std::string beside = with({"--camera", "eye 0 0 4 look 0 9 4"});
  CHECK(beside.find("warning: nothing to see: no ray meets anything; all that the scene holds lies between (-0.5") !=
        std::string::npos);
  CHECK(with({"--camera", "eye 0 0 0.1 look 0 0 -1"}).find("warning: the eye stands within something opaque") !=
        std::string::npos);
  CHECK(with({"--camera", "eye 0 0 0.1 look 0 0 -1", "--cut", "0 0 1 0"}).empty());
  const std::string cube = std::string(DMVV_SOURCE_DIR) + "/tests/cli/cube.obj";
  CHECK(with({"--mesh", cube}).find("warning: nothing to see: the scene is empty wherever the support mesh is seen") !=
        std::string::npos);
  CHECK(with({"--slice", "z=0.9"}).find("empty on this section") != std::string::npos);
  CHECK(with({"--quiet", "--camera", "eye 0 0 4 look 0 9 4"}).empty());
  CHECK(with({"--cut", "0 0 1 0"}).empty());
  CHECK(with({"--slice", "z=0"}).empty());
}
