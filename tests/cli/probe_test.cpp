// dmvv probe: the exact forms that other programs read.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/program.h"
#include "tests/cli/scenes.h"
#include "tests/support/random.h"

using namespace dmvv::tests;

namespace {
constexpr const char* points = "0.4 0 0  # in the inner cube\n\n0.6, -0.1, 1e-3\n1.5 0 0\n";
constexpr const char* json_answers =
    "{\"p\":[0.4,0,0],\"path\":\"SHELL:R.SHELL[0]/CORE:R.CORE\",\"region\":\"R.CORE\",\"rgb\":[1,0.5,0]}\n"
    "{\"p\":[0.6,-0.1,0.001],\"path\":\"SHELL:R.SHELL\",\"region\":\"R.SHELL\",\"rgb\":[0,0,1]}\n"
    "{\"p\":[1.5,0,0],\"path\":null,\"region\":null,\"rgb\":null}\n";

/// The path that an explanation ends in, read off what was asked alone.
std::string path_of(const nlohmann::json& visit) {
  for (const auto& group : visit["groups"]) {
    for (const auto& asked : group["asked"]) {
      if (asked["visit"].is_null() || !asked["visit"]["answers"]) continue;
      return fmt::format("{}:{}[{}]/", visit["object"].get<std::string>(), visit["region"].get<std::string>(),
                         asked["candidate"].get<int>()) +
             path_of(asked["visit"]);
    }
  }
  return visit["object"].get<std::string>() + ':' + visit["region"].get<std::string>();
}

/// Whether every decision and candidate says what its numbers say.
void check_consistent(const nlohmann::json& visit) {
  for (const auto& decision : visit["decisions"]) {
    bool negative = false;
    for (const auto& asked : decision["asked"]) {
      const bool below = asked["held"] && !asked["value"].is_null() && asked["value"] <= decision["iso"];
      CHECK(asked["negative"] == below);
      negative = negative || below;
    }
    CHECK(decision["side"] == (negative ? "NEGATIVE" : "POSITIVE"));
  }
  for (const auto& group : visit["groups"]) {
    for (const auto& asked : group["asked"]) {
      CHECK(asked["held"] == !asked["visit"].is_null());
      if (asked["held"]) check_consistent(asked["visit"]);
    }
  }
}
}  // namespace

TEST_CASE("JSON: one object a point, in order, on every backend and form") {
  const Folder folder;
  const std::string scene = folder.write("scene.voml", nested_cubes);
  const std::string file = folder.write("points.txt", points);
  const std::vector<std::vector<std::string>> ways{{},
                                                   {"--backend", "reference"},
                                                   {"--backend", "vulkan", "--validation"},
                                                   {"--backend", "vulkan", "--codegen", "specialised"},
                                                   {"--backend", "vulkan", "--codegen", "table", "--validation"},
                                                   {"--backend", "vulkan", "--atlas", "r16f", "--no-cache"},
                                                   {"--time", "1234.5"}};
  for (const auto& way : ways) {
    std::vector<std::string> arguments{"probe", scene, "--json", "--points", file};
    arguments.insert(arguments.end(), way.begin(), way.end());
    const Run run = run_dmvv(arguments);
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
    CHECK(run.out == json_answers);
    CHECK(run.err.empty());
  }
}

TEST_CASE("points come from a file, the standard input, or the arguments, in that order") {
  const Folder folder;
  const std::string scene = folder.write("scene.voml", nested_cubes);
  CHECK(run_dmvv({"probe", scene, "--json", "--points", "-"}, points).out == json_answers);
  CHECK(run_dmvv({"probe", scene, "--json", "--point", "0.4 0 0", "--point", "0.6 -0.1 1e-3", "--point", "1.5,0,0"})
            .out == json_answers);
  CHECK(run_dmvv({"probe", scene, "--points", "-", "--point", "-2 0 0"}, "0 0 0").out ==
        "0 0 0\tSHELL:R.SHELL[0]/CORE:R.CORE\t1 0.5 0\n-2 0 0\tempty\n");
  CHECK(run_dmvv({"probe", scene, "--points", "-"}, "").out.empty());
}

TEST_CASE("a filter means the same on every backend") {
  // Samples of -0.5 and 0.5 at x = -0.5 and 0.5. Beyond the outer sample trilinear stays at -0.5; Catmull-Rom goes on
  // to -0.568 at x = -0.95.
  const Folder folder;
  folder.write("plane.lxn", sampled(2, [](const glm::dvec3& q) { return q.x; }));
  const std::string scene = folder.write("scene.voml", R"(<MVV><OBJECT name="A">
  <SDF name="S" file="plane.lxn" offset="-0.53"/><REGION name="R" type="color" rgb="1 0 0"/></OBJECT></MVV>)");
  for (const std::string backend : {"reference", "vulkan"}) {
    CAPTURE(backend);
    const std::vector<std::string> probe{"probe", scene, "--point", "-0.95 0 0", "--backend", backend};
    const auto with = [&](const std::string& filter) {
      std::vector<std::string> arguments = probe;
      arguments.insert(arguments.end(), {"--filter", filter});
      return run_dmvv(arguments).out;
    };
    CHECK(with("hardware") == "-0.95 0 0\tempty\n");
    CHECK(with("shader") == "-0.95 0 0\tempty\n");
    CHECK(with("tricubic") == "-0.95 0 0\tA:R\t1 0 0\n");
  }
}

TEST_CASE("another root is another scene") {
  const Folder folder;
  const std::string scene = folder.write("scene.voml", nested_cubes);
  CHECK(run_dmvv({"probe", scene, "--root", "CORE", "--point", "0.9 0 0"}).out == "0.9 0 0\tCORE:R.CORE\t1 0.5 0\n");
}

TEST_CASE("--explain: the way to an answer, in words") {
  const Folder folder;
  const std::string scene = folder.write("scene.voml", R"(<MVV>
  <OBJECT name="CORE"><SDF name="HALF" function="true">return p.x - 0.001 * t;</SDF>
    <REGION name="R.CORE" type="color" rgb="1 0.5 0"/></OBJECT>
  <OBJECT name="SHELL"><REGION name="R.SHELL" type="color" rgb="0 0 1">
    <INDEX size="1 1 1" scale="0.75 0.75 0.75"><EMBEDDED name="CORE" scale="0.5 0.5 0.5"/></INDEX></REGION></OBJECT>
</MVV>)");
  CHECK(run_dmvv({"probe", scene, "--explain", "--time", "500", "--point", "0.125 0 0"}).out ==
        "0.125 0 0\tSHELL:R.SHELL[0]/CORE:R.CORE\t1 0.5 0\n"
        "  certain; nearest to another outcome: SDF HALF of CORE, about 0.125 away\n"
        "  SHELL at (0.125 0 0)\n"
        "    region R.SHELL\n"
        "      INDEX: at (0.166667 0 0): inside\n"
        "      1 embedded object, asked one by one\n"
        "      [0] CORE at (0.25 0 0)\n"
        "        SDF HALF at (0.25 0 0): -0.25 <= 0: NEGATIVE\n"
        "        region R.CORE, its colour: 1 0.5 0\n");
  const Run both = run_dmvv({"probe", scene, "--explain", "--point", "0.2 0 0", "--point", "0.8 0 0"});
  CHECK(both.out ==
        "0.2 0 0\tSHELL:R.SHELL\t0 0 1\n"
        "  certain; nearest to another outcome: SDF HALF of CORE, about 0.2 away\n"
        "  SHELL at (0.2 0 0)\n"
        "    region R.SHELL\n"
        "      INDEX: at (0.266667 0 0): inside\n"
        "      1 embedded object, asked one by one\n"
        "      [0] CORE at (0.4 0 0)\n"
        "        SDF HALF at (0.4 0 0): 0.4 > 0: POSITIVE\n"
        "        region (empty), empty: nothing here\n"
        "      nobody answers; its colour: 0 0 1\n"
        "0.8 0 0\tSHELL:R.SHELL\t0 0 1\n"
        "  certain; nearest to another outcome: the INDEX of R.SHELL, about 0.05 away\n"
        "  SHELL at (0.8 0 0)\n"
        "    region R.SHELL\n"
        "      INDEX: at (1.06667 0 0): outside, nobody is asked\n"
        "      nobody answers; its colour: 0 0 1\n");
  CHECK(run_dmvv({"probe", scene, "--explain", "--point", "0 0 0"}).out.find("not certain in float32") !=
        std::string::npos);
  CHECK(run_dmvv({"probe", scene, "--explain", "--point", "0 0 0", "--backend", "vulkan"}).exit_code == 2);
}

TEST_CASE("--explain ends in the answer that probe gives without it, on the examples") {
  namespace fs = std::filesystem;
  dmvv::tests::Random random(11);
  std::string points_text = "0 0 0\n";
  for (int i = 0; i < 120; ++i) {
    const double reach = i % 3 == 0 ? 1.05 : i % 3 == 1 ? 0.6 : 0.2;
    const glm::dvec3 p = random.point(-reach, reach);
    points_text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  }
  std::size_t scenes = 0, answers = 0, levels = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(DMVV_BINARY_DIR) / "examples")) {
    const fs::path& scene = entry.path();
    if (scene.extension() != ".voml" || scene.stem() != scene.parent_path().filename()) continue;
    CAPTURE(scene.string());
    ++scenes;
    const std::vector<std::string> probe{"probe", scene.string(), "--points", "-", "--json", "--time", "1234.5"};
    std::vector<std::string> explain = probe;
    explain.push_back("--explain");
    const Run plain = run_dmvv(probe, points_text), explained = run_dmvv(explain, points_text);
    REQUIRE(plain.exit_code == 0);
    REQUIRE(explained.exit_code == 0);
    std::istringstream plain_lines(plain.out), explained_lines(explained.out);
    for (std::string a, b; std::getline(plain_lines, a);) {
      REQUIRE(std::getline(explained_lines, b));
      CHECK(b.starts_with(a.substr(0, a.size() - 1) + ",\"certain\":"));
      const auto json = nlohmann::json::parse(b);
      const auto& visit = json["visit"];
      if (visit.is_null()) {
        CHECK(json["path"].is_null());
        continue;
      }
      check_consistent(visit);
      CHECK(visit["answers"] == !json["path"].is_null());
      if (json["path"].is_null()) continue;
      ++answers;
      const std::string path = path_of(visit);
      CHECK(path == json["path"]);
      levels = std::max(levels, static_cast<std::size_t>(std::ranges::count(path, '/')) + 1);
    }
  }
  CHECK(scenes >= 7);
  CHECK(answers > 100);
  CHECK(levels >= 3);
}

TEST_CASE("a ray tells what it meets, where, and why there") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  const auto json = run_dmvv({"probe", scene, "--ray", "0.2 0.1 5 0 0 -2", "--json"});
  CHECK(json.err == "");
  const auto line = nlohmann::json::parse(json.out);
  CHECK(line["o"] == nlohmann::json::array({0.2, 0.1, 5.0}));
  CHECK(line["d"] == nlohmann::json::array({0.0, 0.0, -2.0}));
  CHECK(line["segments"].size() >= 1);
  CHECK(line["segments"][0]["t0"] == 2.0);  // the cube's face z = 1
  CHECK(line["depth"] == 2.0);
  CHECK(line["certain"] == true);
  CHECK(line["rgba"][3] == 1.0);
  const auto why = run_dmvv({"probe", scene, "--ray", "0.2 0.1 5 0 0 -2", "--explain"});
  CHECK(why.out.find("from the standard cube") != std::string::npos);
  const auto cut = run_dmvv({"probe", scene, "--ray", "0.2 0.1 5 0 0 -1", "--cut", "0 0 1 0.75", "--json"});
  CHECK(nlohmann::json::parse(cut.out)["depth"] == 4.25);
  const auto missed = run_dmvv({"probe", scene, "--ray", "5 0 0 0 0 1", "--json"});
  CHECK(nlohmann::json::parse(missed.out)["segments"].empty());
  CHECK(nlohmann::json::parse(missed.out)["depth"].is_null());
}

TEST_CASE("rays that are none are refused") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", nested_cubes);
  for (const char* ray : {"0 0 5 0 0 0", "0 0 5 0 0", "0 0 5 0 0 x", "0 0 5 0 0 inf", "0 0 5 0 0 1 2", ""}) {
    CAPTURE(ray);
    const auto run = run_dmvv({"probe", scene, "--ray", ray});
    CHECK(run.exit_code == 2);
    CHECK(run.err.find("--ray: ") != std::string::npos);
    CHECK(run.out == "");
  }
  CHECK(run_dmvv({"probe", scene, "--ray", "0 0 5 0 0 1", "--point", "0 0 0"}).exit_code == 2);
  CHECK(run_dmvv({"probe", scene, "--ray", "0 0 5 0 0 1", "--backend", "vulkan"}).exit_code == 2);
  CHECK(run_dmvv({"probe", scene, "--point", "0 0 0", "--cut", "0 0 1 0"}).exit_code == 2);
}
