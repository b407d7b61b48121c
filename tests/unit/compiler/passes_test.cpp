#include "compiler/passes/passes.h"

#include <doctest/doctest.h>

#include "compiler/reference/reference.h"
#include "tests/support/scene_table.h"

using namespace dmvv;

TEST_CASE("merge-assets keeps one of two equal grids") {
  auto module = tests::lowered(
      "<MVV><OBJECT name='A'><SDF name='S' file='a.lxn'/><SDF name='T' file='b.lxn' scale='0.5 0.5 0.5'/>"
      "<REGION name='X' type='color' rgb='1 0 0'/><REGION name='Y' type='color' rgb='1 0 0'/><MAPPINGS><SDF name='S'>"
      "<POSITIVE region='X'/><NEGATIVE><SDF name='T'><POSITIVE region='X'/><NEGATIVE "
      "region='Y'/></SDF></NEGATIVE></SDF>"
      "</MAPPINGS></OBJECT></MVV>",
      {{"a.lxn", tests::sphere_lxn(8, 0.8)}, {"b.lxn", tests::sphere_lxn(8, 0.8)}});
  REQUIRE(module.grids.size() == 2);
  compiler::merge_assets(module);
  CHECK(module.grids.size() == 1);
  const std::string once = compiler::to_text(module);
  compiler::merge_assets(module);
  CHECK(compiler::to_text(module) == once);
}

TEST_CASE("prune-sides removes a decision between equal sides, drop-unreachable its distance function") {
  auto module = tests::lowered(
      "<MVV><OBJECT name='A'><SDF name='S' file='a.lxn'/><SDF name='T' file='b.lxn'/>"
      "<REGION name='X' type='color' rgb='1 0 0'/><REGION name='Y' type='color' rgb='1 0 0'/><MAPPINGS><SDF name='S'>"
      "<POSITIVE><SDF name='T'><POSITIVE region='X'/><NEGATIVE region='X'/></SDF></POSITIVE><NEGATIVE "
      "region='Y'/></SDF>"
      "</MAPPINGS></OBJECT></MVV>",
      {{"a.lxn", tests::sphere_lxn(8, 0.8)}, {"b.lxn", tests::sphere_lxn(4, 0.3)}});
  CHECK(module.nodes.size() == 5);
  compiler::prune_sides(module);
  compiler::drop_unreachable(module);
  CHECK(module.nodes.size() == 3);
  CHECK(module.sdfs.size() == 1);
  CHECK(module.grids.size() == 1);
  CHECK(module.grids[0].path == "a.lxn");
  const std::string once = compiler::to_text(module);
  compiler::prune_sides(module);
  compiler::drop_unreachable(module);
  CHECK(compiler::to_text(module) == once);
}

TEST_CASE("passes leave every answer as it was") {
  for (const auto& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    const auto before = tests::lowered(scene.text, scene.files);
    auto after = before;
    compiler::merge_assets(after);
    compiler::prune_sides(after);
    compiler::drop_unreachable(after);
    const compiler::Reference a(before), b(after);
    tests::Random random(1);
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 p = random.point();
      CHECK(a.evaluate(p).number == b.evaluate(p).number);
    }
  }
}
