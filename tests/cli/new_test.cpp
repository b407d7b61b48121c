// dmvv new: the scene it writes holds no mistake, renders, and is what its comments say.
#include <doctest/doctest.h>

#include "tests/cli/program.h"

using namespace dmvv::tests;

namespace {

/// The path of regions at a point, by the reference.
std::string path_at(const std::string& scene, const std::string& point, const std::string& time_ms) {
  const Run run = run_dmvv({"probe", scene, "--point", point, "--time", time_ms, "--json"});
  CHECK_MESSAGE(run.exit_code == 0, run.err);
  const std::string key = "\"path\":\"";
  const std::size_t begin = run.out.find(key);
  if (begin == std::string::npos) return "";
  return run.out.substr(begin + key.size(), run.out.find('"', begin + key.size()) - begin - key.size());
}

}  // namespace

TEST_CASE("the new scene is fine without a warning, and renders") {
  const Folder folder;
  const Run run = run_dmvv({"new", folder.file("melon")});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  const std::string scene = folder.file("melon.voml");
  CHECK(run.out.find("dmvv check " + scene) != std::string::npos);
  CHECK(run.out.find("dmvv render " + scene + " -o " + folder.file("melon.png") + " --cut") != std::string::npos);
  CHECK(folder.listing().size() == 1);

  const Run check = run_dmvv({"check", "--strict", scene});
  CHECK_MESSAGE(check.exit_code == 0, check.err);
  CHECK(check.err.empty());
  CHECK(check.out.find("fine: 2 objects, 4 SDFs, 6 regions") != std::string::npos);
  const Run render = run_dmvv({"render", scene, "-o", folder.file("melon.png"), "--cut", "0 0 1 0", "--size", "64x48"});
  CHECK_MESSAGE(render.exit_code == 0, render.err);
  CHECK(render.err.empty());
}

TEST_CASE("shell, flesh and stones, and a boundary that moves") {
  const Folder folder;
  REQUIRE(run_dmvv({"new", folder.file("melon")}).exit_code == 0);
  const std::string scene = folder.file("melon.voml");
  // On the axes the dents vanish: the radius is 0.80 at first, and 0.83 after a quarter of four seconds.
  CHECK(path_at(scene, "0 0.815 0", "0").empty());
  CHECK(path_at(scene, "0 0.815 0", "1000") == "MELON:R.RIND");
  CHECK(path_at(scene, "0 0 0", "0") == "MELON:R.FLESH");
  CHECK(path_at(scene, "0.38 0 0", "0") == "MELON:R.FLESH[0]/MELON_STONE:R.KERNEL");
  CHECK(path_at(scene, "0.38 0.08 0", "0") == "MELON:R.FLESH[0]/MELON_STONE:R.SHELL");  // 0.5 of 0.38 to 0.6
}

TEST_CASE("a file that is there is left as it is") {
  const Folder folder;
  const std::string scene = folder.write("melon.voml", "mine");
  for (const char* name : {"melon", "melon.voml"}) {
    const Run run = run_dmvv({"new", folder.file(name)});
    CHECK(run.exit_code == 1);
    CHECK(run.out.empty());
    CHECK(run.err.find("melon.voml' exists") != std::string::npos);
  }
  CHECK(read_file(scene) == "mine");
  CHECK(folder.listing().size() == 1);
}

TEST_CASE("two runs write the same bytes, with and without the ending") {
  const Folder a, b;
  REQUIRE(run_dmvv({"new", a.file("melon")}).exit_code == 0);
  REQUIRE(run_dmvv({"new", b.file("melon.voml"), "--quiet"}).exit_code == 0);
  CHECK(a.read("melon.voml") == b.read("melon.voml"));
  CHECK(!a.read("melon.voml").empty());
}

TEST_CASE("object names are made of any file name") {
  const Folder folder;
  const auto root_of = [&](const std::string& name) {
    const Run run = run_dmvv({"new", folder.file(name)});
    CHECK_MESSAGE(run.exit_code == 0, run.err);
    const Run check = run_dmvv({"check", "--strict", folder.file(name + ".voml")});
    CHECK_MESSAGE(check.exit_code == 0, check.err);
    const std::string path = path_at(folder.file(name + ".voml"), "0 0 0", "0");
    return path.substr(0, path.find(':'));
  };
  CHECK(root_of("my \"first\" & <best> scene") == "MY_FIRST_BEST_SCENE");
  CHECK(root_of("v1.2--x") == "V1_2_X");
  CHECK(root_of("\xc3\xa4pfel") == "PFEL");
  CHECK(root_of("--") == "SCENE");
}

TEST_CASE("no name, no folder") {
  const Folder folder;
  CHECK(run_dmvv({"new"}).exit_code == 2);
  CHECK(run_dmvv({"new", ""}).exit_code == 2);
  CHECK(run_dmvv({"new", folder.file("")}).exit_code == 2);
  CHECK(run_dmvv({"new", folder.file(".voml")}).exit_code == 2);
  const Run run = run_dmvv({"new", folder.file("no/melon")});
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("does not exist") != std::string::npos);
  CHECK(folder.listing().empty());
}
