// Every example is clean: no mistake, and no warning either.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "tests/cli/program.h"

using namespace dmvv;
namespace fs = std::filesystem;

TEST_CASE("every example is clean under check --strict") {
  std::vector<std::string> arguments = {"check", "--strict"};
  for (const auto& entry : fs::recursive_directory_iterator(DMVV_BINARY_DIR "/examples")) {
    if (entry.path().extension() == ".voml") arguments.push_back(entry.path().string());
  }
  std::sort(arguments.begin() + 2, arguments.end());
  for (const char* name : {"orange", "skin", "skull", "banana_scan", "virion", "mycoplasma", "molecule", "metaballs",
                           "metaballs_plus", "sticks", "shapes", "library"}) {
    const std::string scene = fs::path(DMVV_BINARY_DIR "/examples") / name / (std::string(name) + ".voml");
    CHECK_MESSAGE(std::find(arguments.begin(), arguments.end(), scene) != arguments.end(), scene);
  }
  const tests::Run run = tests::run_dmvv(arguments);
  CHECK_MESSAGE(run.err.empty(), run.err);
  CHECK(run.exit_code == 0);
  CHECK(std::count(run.out.begin(), run.out.end(), '\n') == static_cast<std::ptrdiff_t>(arguments.size()) - 2);
}
