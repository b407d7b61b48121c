// The skin: what it holds, and that its indices cost nothing but time.
#include <doctest/doctest.h>

#include <filesystem>
#include <regex>

#include "base/files.h"
#include "compiler/ir/module.h"
#include "tests/cli/program.h"
#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::tests;
namespace fs = std::filesystem;

namespace {

const fs::path folder = DMVV_BINARY_DIR "/examples/skin";

/// The scene with every index of its author of one cell, beside the scene: it reads the same files.
class OneCell {
 public:
  OneCell() : path_(folder / "skin_one_cell.voml") {
    const std::string text = read_file((folder / "skin.voml").string());
    const std::string changed =
        std::regex_replace(text, std::regex("<INDEX size=\"[0-9 ]+\""), "<INDEX size=\"1 1 1\"");
    REQUIRE(changed != text);
    REQUIRE(write_file(path_.string(), changed));
  }
  ~OneCell() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  OneCell(const OneCell&) = delete;
  OneCell& operator=(const OneCell&) = delete;
  std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

}  // namespace

TEST_CASE("the skin has as many objects as it says, on four levels, grids and functions mixed") {
  Diagnostics diagnostics;
  auto scene = voml::read_scene((folder / "skin.voml").string(), disk_files(), {}, diagnostics);
  REQUIRE_MESSAGE(scene, diagnostics.render());
  const auto module = compiler::lower(std::move(*scene), diagnostics);
  REQUIRE_MESSAGE(module, diagnostics.render());
  std::size_t candidates = 0, grids = 0;
  for (const compiler::Region& region : module->regions)
    for (const auto& group : region.groups) candidates += group.candidates.size();
  for (const compiler::Sdf& sdf : module->sdfs) grids += std::holds_alternative<Id<voml::Grid>>(sdf.source) ? 1 : 0;
  CHECK(candidates >= 1200);
  CHECK(module->depth >= 4);
  CHECK(grids >= 20);
  CHECK(module->sdfs.size() - grids >= 20);
}

TEST_CASE("pictures of the skin do not depend on its indices") {
  const Folder out;
  const OneCell one_cell;
  // The block as a whole, and so near that a pixel is a tenth of a cell: there its borders are everywhere.
  const std::vector<std::string> cameras{"eye 1.35 1.45 4.6 look 0.06 -0.07 -0.15 fov 27.5",
                                         "eye 0.8 0.62 1.2 look 0.62 0.52 0.35 fov 12"};
  for (const std::string& camera : cameras) {
    CAPTURE(camera);
    std::vector<std::string> pictures, regions;
    for (const std::string& path : {(folder / "skin.voml").string(), one_cell.path()}) {
      const Run run = run_dmvv({"render", path, "--mesh", (folder / "skin.ply").string(), "--cut", "0 0 1 0.35",
                                "--camera", camera, "--size", "160x90", "--time", "700", "--codegen", "table", "-o",
                                out.file("p.png"), "--aov", "region=" + out.file("r.exr")});
      REQUIRE_MESSAGE(run.exit_code == 0, run.err);
      pictures.push_back(out.read("p.png"));
      regions.push_back(out.read("r.exr"));
    }
    CHECK(pictures[0] == pictures[1]);
    CHECK(regions[0] == regions[1]);
  }
}
