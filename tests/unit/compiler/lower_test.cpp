#include <doctest/doctest.h>

#include "compiler/reference/reference.h"
#include "tests/support/scene_table.h"

using namespace dmvv;
using tests::lowered;

TEST_CASE("objects stand before those they embed, what the root does not reach is gone") {
  const auto module = lowered(
      "<MVV><OBJECT name='UNUSED'><REGION name='R' type='color' rgb='1 1 1'/></OBJECT>"
      "<OBJECT name='B'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT>"
      "<OBJECT name='A'><REGION name='R' type='color' rgb='0 1 0'><EMBEDDED name='B' scale='0.5 0.5 "
      "0.5'/></REGION></OBJECT></MVV>");
  REQUIRE(module.objects.size() == 2);
  CHECK(module.objects[0].name == "A");
  CHECK(module.objects[1].name == "B");
  CHECK(module.root.index == 0);
  CHECK(module.depth == 2);
}

TEST_CASE("region numbers follow the document, empty regions have none") {
  const auto module = lowered(
      "<MVV><OBJECT name='A'><SDF name='S' file='p.lxn'/><REGION name='Z' type='color' rgb='1 0 0'/>"
      "<REGION name='NOT_USED' type='color' rgb='1 0 0'/><REGION name='E' type='empty'/>"
      "<REGION name='Y' type='color' rgb='1 0 0'/><MAPPINGS><SDF name='S'><POSITIVE><SDF name='S'><POSITIVE "
      "region='E'/>"
      "<NEGATIVE region='Y'/></SDF></POSITIVE><NEGATIVE region='Z'/></SDF></MAPPINGS></OBJECT></MVV>",
      {{"p.lxn", tests::plane_lxn()}});
  std::map<std::string, std::uint32_t> numbers;
  for (const auto& region : module.regions) numbers[region.name] = region.number;
  CHECK(numbers == std::map<std::string, std::uint32_t>{{"Z", 1}, {"E", 0}, {"Y", 2}});
}

TEST_CASE("candidates are numbered through all groups of a region, seeds in file order") {
  const auto module = lowered(
      "<MVV><OBJECT name='B'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT><OBJECT name='A'><REGION name='R' "
      "type='color' rgb='0 1 0'><EMBEDDED name='B'/><INDEX size='2 2 2'><EMBEDDED name='B' seedFile='p.txt'/></INDEX>"
      "<EMBEDDED name='B'/></REGION></OBJECT></MVV>",
      {{"p.txt", "0 0 0\n0.25 0 0\n"}});
  const auto& groups = module.regions[0].groups;
  REQUIRE(groups.size() == 3);
  CHECK(groups[0].first_number == 0);
  CHECK(groups[1].first_number == 1);
  CHECK(groups[2].first_number == 3);
  CHECK(groups[1].box_from_object.has_value());
  CHECK(groups[1].candidates[1].local_from_parent({0.5, 0, 0}) == glm::dvec3(0.0));
}

TEST_CASE("the module as text") {
  const auto module = lowered(tests::chain_scene(2, 0.5), {{"ball.lxn", tests::sphere_lxn(2, 0.5)}});
  const std::string text = compiler::to_text(module);
  CHECK(text == compiler::to_text(lowered(tests::chain_scene(2, 0.5), {{"ball.lxn", tests::sphere_lxn(2, 0.5)}})));
  CHECK(text.find("root object 0, depth 2") == 0);
  CHECK(text.find("grid 0 'ball.lxn' 2x2x2 box (-1 -1 -1) (1 1 1)") != std::string::npos);
}

TEST_CASE("placements that float32 cannot follow") {
  const auto lower = [](const std::string& text) {
    Diagnostics diagnostics;
    auto scene = voml::read_scene("s.voml", memory_files({{"s.voml", text}}), {}, diagnostics);
    REQUIRE(scene);
    compiler::lower(std::move(*scene), diagnostics);
    return diagnostics.render();
  };
  const auto chain = [](const char* outer, const char* inner) {
    return fmt::format(
        "<MVV><OBJECT name='C'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT><OBJECT name='B'><REGION "
        "name='R' type='color' rgb='1 0 0'><EMBEDDED name='C' scale='{0}'/></REGION></OBJECT><OBJECT name='A'>"
        "<REGION name='R' type='color' rgb='0 1 0'><EMBEDDED name='B' translate='0.5 0 0' scale='{1}'/></REGION>"
        "</OBJECT></MVV>",
        inner, outer);
  };
  CHECK(lower(chain("0.1 0.1 0.1", "0.1 0.1 0.1")) == "");
  // 6u (1 + 1) / s a level: the inner frame's error passes 2 / 1024 between s = 1e-3 and 1e-4.
  const std::string at_inner = lower(chain("0.01 0.01 0.01", "0.001 0.001 0.001"));
  CHECK(at_inner.find("W0301") != std::string::npos);
  CHECK(at_inner.find("the object 'C'") != std::string::npos);
  CHECK(at_inner.find("the object 'B'") == std::string::npos);
  const std::string at_outer = lower(chain("1e-5 1e-5 1e-5", "0.1 0.1 0.1"));  // said once, where it begins
  CHECK(at_outer.find("the object 'B'") != std::string::npos);
  CHECK(at_outer.find("the object 'C'") == std::string::npos);
  CHECK(lower(chain("1e-32 1 1", "1 1 1")).find("E0306") != std::string::npos);
}

TEST_CASE("snippets that the root does not reach are compiled when asked for, each once") {
  const std::string text =
      "<MVV><OBJECT name='B'><SDF name='S' function='true'>return nonsense;</SDF><REGION name='R' "
      "type='empty'/></OBJECT>"
      "<OBJECT name='A'><SDF name='S' function='true'>return sqrt(p.x);</SDF><REGION name='R' "
      "type='empty'/></OBJECT></MVV>";
  for (const bool everything : {false, true}) {
    Diagnostics diagnostics;
    auto scene = voml::read_scene("s.voml", memory_files({{"s.voml", text}}), {}, diagnostics);
    REQUIRE(scene);
    const auto module = compiler::lower(std::move(*scene), diagnostics, {.check_everything = everything});
    CHECK(module.has_value() == !everything);
    CHECK(diagnostics.warning_count() == 1);
    CHECK(diagnostics.has_errors() == everything);
  }
}
