#include "compiler/reference/reference.h"
#include <doctest/doctest.h>
#include <cmath>
#include "compiler/grids/sample.h"
#include "compiler/ir/legend.h"
#include "tests/support/scene_table.h"

using namespace dmvv;

namespace {

std::string path_at(const compiler::Module& module, glm::dvec3 p) {
  const auto answer = compiler::Reference(module).evaluate(p);
  return compiler::format_path(compiler::legend(module), answer.path);
}

}  // namespace

TEST_CASE("trilinear sampling is cell-centred, exact for linear functions, clamped outside the outer centres") {
  const auto linear = [](glm::dvec3 p) { return 0.5 * p.x - 0.25 * p.y + p.z; };
  const voml::Grid grid = tests::grid_of({8, 4, 16}, linear, {-0.5, -1, 0}, {0.5, 1, 1});
  CHECK(compiler::sample(grid, {0.1, 0.2, 0.3}) == doctest::Approx(linear({0.1, 0.2, 0.3})).epsilon(1e-6));
  // Half a cell from the border the samples end: x centres stop at 0.4375.
  CHECK(compiler::sample(grid, {0.5, 0, 0.5}) == doctest::Approx(linear({0.4375, 0, 0.5})).epsilon(1e-6));
  const voml::Grid single = tests::grid_of({1, 1, 1}, [](glm::dvec3) { return 3.0; });
  CHECK(compiler::sample(single, {0.9, -0.9, 0}) == 3.0);
}

TEST_CASE("the boundary belongs to the negative side, the closed cube to the object") {
  const auto module = tests::lowered(
      "<MVV><OBJECT name='A'><SDF name='S' file='p.lxn'/><REGION name='IN' type='color' rgb='1 0 0'/>"
      "<REGION name='OUT' type='color' rgb='0 0 1'/><MAPPINGS><SDF name='S'><POSITIVE region='OUT'/><NEGATIVE "
      "region='IN'/>"
      "</SDF></MAPPINGS></OBJECT></MVV>",
      {{"p.lxn", tests::plane_lxn()}});
  CHECK(path_at(module, {0, 0.3, 0}) == "A:IN");
  CHECK(path_at(module, {1e-9, 0.3, 0}) == "A:OUT");
  CHECK(path_at(module, {-1, 1, 1}) == "A:IN");
  CHECK(path_at(module, {-1.0000001, 1, 1}).empty());
  CHECK(path_at(module, {std::nan(""), 0, 0}).empty());
  CHECK_FALSE(compiler::Reference(module).evaluate({1e-9, 0.3, 0}).certain);
  CHECK(compiler::Reference(module).evaluate({0.25, 0.3, 0}).certain);
}

TEST_CASE("outside its cube or box a distance function is positive") {
  const auto module = tests::lowered(
      "<MVV><OBJECT name='A'><SDF name='S' file='deep.lxn' scale='0.5 0.5 0.5'/><REGION name='IN' type='color' rgb='1 "
      "0 0'/>"
      "<REGION name='OUT' type='color' rgb='0 0 1'/><MAPPINGS><SDF name='S'><POSITIVE region='OUT'/><NEGATIVE "
      "region='IN'/>"
      "</SDF></MAPPINGS></OBJECT></MVV>",
      {{"deep.lxn",
        voml::write_lxn(tests::grid_of({2, 2, 2}, [](glm::dvec3) { return -1.0; }, {-0.5, -1, -1}, {1, 1, 1}))}});
  CHECK(path_at(module, {0.49, 0.49, -0.49}) == "A:IN");
  CHECK(path_at(module, {0.51, 0, 0}) == "A:OUT");
  CHECK(path_at(module, {-0.24, 0, 0}) == "A:IN");
  CHECK(path_at(module, {-0.26, 0, 0}) == "A:OUT");
}

TEST_CASE("embedding: first answer in document order wins, an empty one passes on, paths count candidates") {
  const std::string objects =
      "<MVV><OBJECT name='HALF'><SDF name='S' file='p.lxn'/><REGION name='IN' type='color' rgb='1 0 0'/><REGION "
      "name='OUT' "
      "type='empty'/><MAPPINGS><SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT>"
      "<OBJECT name='BOX'><REGION name='B' type='color' rgb='0 1 0'/></OBJECT>";
  const auto module = tests::lowered(
      objects +
          "<OBJECT name='ROOT'><REGION name='R' type='color' rgb='0 0 1'><EMBEDDED name='HALF' scale='0.5 0.5 0.5'/>"
          "<EMBEDDED name='BOX' translate='0.5 0 0' scale='0.5 0.25 0.25'/></REGION></OBJECT></MVV>",
      {{"p.lxn", tests::plane_lxn()}});
  CHECK(path_at(module, {-0.2, 0.1, 0}) == "ROOT:R[0]/HALF:IN");
  CHECK(path_at(module, {0.2, 0.1, 0}) == "ROOT:R[1]/BOX:B");
  CHECK(path_at(module, {0.2, 0.4, 0}) == "ROOT:R");
  CHECK(compiler::Reference(module).evaluate({0.2, 0.4, 0}).rgba == glm::dvec4(0, 0, 1, 1));
}

TEST_CASE("lookup grids never change an answer") {
  for (const auto& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    const auto module = tests::lowered(scene.text, scene.files);
    const compiler::Reference indexed(module), plain(module, {false});
    tests::Random random(2);
    for (int i = 0; i < 1000; ++i) {
      const glm::dvec3 p = random.point();
      const auto a = indexed.evaluate(p), b = plain.evaluate(p);
      CHECK(a.number == b.number);
      CHECK(a.path == b.path);
    }
  }
}

TEST_CASE("bitmaps: rows from the bottom, wrapped, trilinear between texel centres") {
  voml::Bitmap bitmap;
  bitmap.n = 2;
  for (int i = 0; i < 8; ++i) bitmap.texels.emplace_back(i % 2 * 255, i / 2 % 2 * 255, i / 4 * 255, 255);
  compiler::Module module;
  module.bitmaps.push_back(bitmap);
  compiler::Region region;
  region.name = "R";
  region.object = {0};
  region.number = 1;
  region.kind = voml::RegionKind::bitmap;
  region.bitmap = {0};
  module.regions.push_back(region);
  module.nodes.push_back({Id<compiler::Region>{0}});
  module.objects.push_back({"A", {0}, {}});
  module.root = {0};
  const compiler::Reference reference(module);
  // Texel centres of a 2^3 bitmap over [-1,1] are at -0.5 and 0.5.
  CHECK(reference.evaluate({0.5, -0.5, -0.5}).rgba == glm::dvec4(1, 0, 0, 1));
  CHECK(reference.evaluate({-0.5, 0.5, 0.5}).rgba == glm::dvec4(0, 1, 1, 1));
  CHECK(reference.evaluate({0, -0.5, -0.5}).rgba.r == doctest::Approx(0.5));
  CHECK(reference.evaluate({0.75, -0.5, -0.5}).rgba.r ==
        doctest::Approx(0.75));  // half-way round the border to texel 0
  CHECK(reference.evaluate({1, -0.5, -0.5}).rgba.r == doctest::Approx(0.5));
}

TEST_CASE("a colour is certain only where rounding a point to float32 cannot change it by 1e-3") {
  // Stripes along x of an object of size s at x = 0.9: rounding x moves the local point by up to 2^-24 0.9 / s, and the
  // colour by as much. At s = 1e-5 that is 5e-3.
  const auto striped = [](double s, bool stripes) {
    voml::Bitmap bitmap;
    bitmap.n = 2;
    for (int i = 0; i < 8; ++i) bitmap.texels.emplace_back(stripes ? i % 2 * 255 : 255, 0, 0, 255);
    compiler::Module module = tests::lowered(fmt::format(
        "<MVV><OBJECT name='A'><REGION name='R' type='color' rgb='1 0 0'/></OBJECT><OBJECT name='ROOT'><REGION "
        "name='R' "
        "type='color' rgb='0 0 1'><EMBEDDED name='A' translate='0.9 0 0' scale='{0} {0} {0}'/></REGION></OBJECT></MVV>",
        s));
    module.bitmaps.push_back(bitmap);
    for (compiler::Region& region : module.regions) {
      if (region.rgb.r != 1.0) continue;
      region.kind = voml::RegionKind::bitmap;
      region.bitmap = {0};
    }
    return compiler::Reference(module).evaluate({0.9, 0, 0});
  };
  CHECK(striped(0.05, true).certain);
  CHECK_FALSE(striped(1e-5, true).certain);
  CHECK(striped(1e-5, false).certain);
  CHECK(striped(1e-5, true).path.size() == 2);
}
