// dmvv bench as a user calls it; what it measures is tested in tests/bench.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/cli/program.h"
#include "tests/cli/scenes.h"

using namespace dmvv::tests;
using nlohmann::json;

TEST_CASE("a scene is measured with every setting: table, JSON and plots") {
  const Folder folder;
  const std::string scene = folder.write("nested.voml", nested_cubes);
  const Run run = run_dmvv({"bench", scene, "--quick", "--size", "64x64", "--json", folder.file("b.json"), "--plots",
                            folder.file("plots"), "--validation"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("nested, with every setting") != std::string::npos);
  std::istringstream lines(run.out);
  for (std::string line; std::getline(lines, line);) CHECK_MESSAGE(line.size() <= 100, line);

  const json result = json::parse(folder.read("b.json"));
  CHECK(result["set"] == "scenes");
  std::vector<std::string> variants;
  for (const json& entry : result["runs"]) {
    CAPTURE(entry["id"]);
    variants.push_back(entry["variant"]);
    CHECK(entry["failure"].is_null());
    // No distance grid is in the scene, so even the thesis' form is right.
    CHECK(entry["errors"]["points"]["wrong"] == 0);
    CHECK(entry["errors"]["pixels"]["wrong"] == 0);
    CHECK(entry["errors"]["pixels"]["compared"] > 1000);
    CHECK(entry["times_ms"]["frame"]["median"] > 0);
    CHECK(entry["peak_bytes"] > 0);
  }
  CHECK(variants == std::vector<std::string>{"auto",
                                             "specialised",
                                             "table",
                                             "thesis",
                                             "camera swings",
                                             "time goes on",
                                             "no merge-assets",
                                             "no prune-sides",
                                             "no drop-unreachable",
                                             "no trim-cubes",
                                             "no index",
                                             "no refine-index",
                                             "no chain-seeds",
                                             "no fold-affine",
                                             "no unite-shapes",
                                             "no sink-answers",
                                             "no box-tests",
                                             "no stages",
                                             "no tapes",
                                             "no shorten-tapes",
                                             "no texel-records",
                                             "no pixel-list"});
  const std::string plot = folder.read("plots/settings_nested.svg");
  CHECK(plot.find("<svg") != std::string::npos);
  CHECK(plot.find("frame of") != std::string::npos);
  CHECK(folder.listing().size() == 4);  // scene, JSON, folder, plot
}

TEST_CASE("a run that is stopped leaves what it measured, and says where it stood") {
  const Folder folder;
  const std::string scene = folder.write("nested.voml", nested_cubes), path = folder.file("b.json");
  const pid_t bench = start_dmvv({"bench", scene, "--quick", "--size", "64x64", "--json", path}, folder.file("err"));
  const auto measured = [&] {
    std::size_t count = 0;
    const json so_far = json::parse(read_file(path));
    for (const json& entry : so_far["runs"]) count += entry["failure"].is_null() ? 1 : 0;
    return count;
  };
  const auto has_measured = [&] {
    return std::filesystem::exists(path) && measured() >= 2;
  };  // valid whenever it is read
  const auto last = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (!has_measured() && std::chrono::steady_clock::now() < last) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  kill(bench, SIGKILL);
  REQUIRE(waitpid(bench, nullptr, 0) == bench);
  REQUIRE(has_measured());

  const json result = json::parse(folder.read("b.json"));
  CHECK(result["schema"].is_number());
  CHECK(result["runs"].size() >= 20);
  const json& unmeasured = result["runs"].back();
  CHECK(unmeasured["failure"] == "not measured: the run ended before");
  const std::string said = folder.read("err");
  CHECK(said.starts_with("bench: 1/"));
  CHECK(said.find(result["runs"][0]["id"]) != std::string::npos);
}

TEST_CASE("what cannot be measured is refused before the work") {
  const Folder folder;
  const Run set = run_dmvv({"bench", "--set", "fast"});
  CHECK(set.exit_code == 2);
  CHECK(set.err.find("unknown set 'fast'") != std::string::npos);
  CHECK(set.err.find("growth to the limits") != std::string::npos);
  const Run scene = run_dmvv({"bench", folder.file("none.voml"), "--json", folder.file("b.json")});
  CHECK(scene.exit_code == 1);
  CHECK(scene.err.find("none.voml") != std::string::npos);
  const Run ending = run_dmvv({"bench", "--json", folder.file("b.txt")});
  CHECK(ending.exit_code == 1);
  const Run missing = run_dmvv({"bench", "--set", "thesis", "--examples", folder.file("no"), "--quick"});
  CHECK(missing.exit_code == 0);
  CHECK(missing.out.find("skin: not there yet") != std::string::npos);
  CHECK(folder.listing().empty());
}
