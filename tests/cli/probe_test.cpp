// dmvv probe: the exact forms that other programs read.
#include <doctest/doctest.h>

#include "tests/cli/program.h"
#include "tests/cli/scenes.h"

using namespace dmvv::test;

namespace {
constexpr const char* points = "0.4 0 0  # in the inner cube\n\n0.6, -0.1, 1e-3\n1.5 0 0\n";
constexpr const char* json_answers =
    "{\"p\":[0.4,0,0],\"path\":\"SHELL:R.SHELL[0]/CORE:R.CORE\",\"region\":\"R.CORE\",\"rgb\":[1,0.5,0]}\n"
    "{\"p\":[0.6,-0.1,0.001],\"path\":\"SHELL:R.SHELL\",\"region\":\"R.SHELL\",\"rgb\":[0,0,1]}\n"
    "{\"p\":[1.5,0,0],\"path\":null,\"region\":null,\"rgb\":null}\n";
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
  // Samples of -0.5 and 0.5 at x = -0.5 and 0.5. Beyond the outer sample trilinear stays at -0.5; Catmull-Rom goes on to
  // -0.568 at x = -0.95.
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
