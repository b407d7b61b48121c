// Codegen::thesis has the errors of the published implementation (spec/thesis.md): each is shown where it differs from
// the reference, with expected places worked out by hand.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "compiler/reference/reference.h"
#include "compiler/thesis/thesis.h"
#include "runtime/runtime.h"
#include "tests/support/scene_table.h"

using namespace dmvv;

namespace {

/// The paths that the thesis form and the reference give at points.
struct Both {
  std::vector<std::string> thesis, reference;
};

Both paths(const std::string& text, const tests::Files& files, const std::vector<glm::dvec3>& points) {
  runtime::DeviceOptions with_validation;
  with_validation.validation = true;
  auto device = runtime::Device::create(with_validation);
  if (!device) FAIL("no Vulkan device: " << device.error().message);
  const auto module = tests::lowered(text, files);
  compiler::CompileOptions options;
  options.codegen = compiler::Codegen::thesis;
  const auto program = tests::compiled(module, options);
  auto evaluator = runtime::Evaluator::create(*device, program);
  REQUIRE(evaluator);
  const auto answers = evaluator->probe(points);
  REQUIRE(answers);
  const compiler::Reference reference(module);
  Both both;
  for (std::size_t i = 0; i < points.size(); ++i) {
    both.thesis.push_back(compiler::format_path(program.regions, (*answers)[i].path));
    CHECK(((*answers)[i].number == 0) == (*answers)[i].path.empty());
    both.reference.push_back(compiler::format_path(program.regions, reference.evaluate(points[i]).path));
  }
  for (const auto& message : device->validation_messages()) FAIL_CHECK(message);
  return both;
}

std::string constant_lxn(double value, std::uint32_t n = 2) {
  return voml::write_lxn(tests::grid_of(glm::uvec3(n), [=](glm::dvec3) { return value; }));
}

/// An object that is IN where its one SDF is negative, OUT elsewhere; `sdf` holds the SDF's attributes.
std::string one_sdf(const std::string& sdf, const std::string& body = "") {
  return "<MVV><OBJECT name='A'><SDF name='S' " + sdf + ">" + body +
         "</SDF><REGION name='IN' type='color' rgb='1 0 0'/><REGION name='OUT' type='color' rgb='0 0 1'/><MAPPINGS>"
         "<SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT></MVV>";
}

using Paths = std::vector<std::string>;

const std::string box = "<OBJECT name='BOX'><REGION name='B' type='color' rgb='0 1 0'/></OBJECT>";

std::string root(const std::string& embedded) {
  return "<MVV>" + box + "<OBJECT name='ROOT'><REGION name='R' type='color' rgb='0 0 1'>" + embedded +
         "</REGION></OBJECT></MVV>";
}

compiler::CompileOptions thesis() {
  compiler::CompileOptions options;
  options.codegen = compiler::Codegen::thesis;
  return options;
}

}  // namespace

TEST_CASE("thesis: the threshold is 0.51 of the stored value: a constant is inside up to 0.02") {
  // 130 / 255 = 0.5098 stores 0.0196; 131 / 255 = 0.5137 stores 0.0275. Both are outside.
  for (const auto& [value, path] : {std::pair{0.0196, "A:IN"}, std::pair{0.0275, "A:OUT"}}) {
    const Both both = paths(one_sdf("file='c.lxn'"), {{"c.lxn", constant_lxn(value)}}, {{0.1, 0.2, 0.3}});
    CHECK(both.thesis == Paths{path});
    CHECK(both.reference == Paths{"A:OUT"});
  }
}

TEST_CASE("thesis: a sphere of radius 0.5 ends at 0.52") {
  // Along the axes and diagonals of a 32^3 grid. Half a step of 2/255, the error of trilinear interpolation
  // (h^2 / 8 times the sum of curvatures, h = 1/16) and the texture unit's weights for 8-bit texels: below 0.01 in all.
  std::vector<glm::dvec3> points;
  std::vector<std::string> expected;
  for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1),
                                      glm::dvec3(1, 1, 1), glm::dvec3(-1, 1, -1), glm::dvec3(1, -1, 0)}) {
    for (const auto& [radius, path] : {std::pair{0.51, "A:IN"}, std::pair{0.53, "A:OUT"}}) {
      points.push_back(glm::normalize(direction) * radius);
      expected.emplace_back(path);
    }
  }
  const Both both = paths(one_sdf("file='s.lxn'"), {{"s.lxn", tests::sphere_lxn(32, 0.5)}}, points);
  CHECK(both.thesis == expected);
  CHECK(both.reference == Paths(points.size(), "A:OUT"));
}

TEST_CASE("thesis: values are stored in 256 steps from -1 to 1") {
  // 0.3 is stored as 166/255, which is 0.30196: the boundary of an offset stands at 0.28196 instead of 0.28.
  const tests::Files files{{"c.lxn", constant_lxn(0.3)}, {"far.lxn", constant_lxn(5.0)}};
  CHECK(paths(one_sdf("file='c.lxn' offset='0.2815'"), files, {{0, 0, 0}}).thesis == Paths{"A:OUT"});
  CHECK(paths(one_sdf("file='c.lxn' offset='0.2825'"), files, {{0, 0, 0}}).thesis == Paths{"A:IN"});
  CHECK(paths(one_sdf("file='far.lxn' offset='0.985'"), files, {{0, 0, 0}}).thesis == Paths{"A:IN"});  // cut to 1
  CHECK(paths(one_sdf("file='far.lxn' offset='0.975'"), files, {{0, 0, 0}}).thesis == Paths{"A:OUT"});
}

TEST_CASE("thesis: the atlas is one row of bare grids in a power of two") {
  const std::vector<voml::Grid> grids{tests::grid_of({3, 5, 6}, [](glm::dvec3) { return -1.0; }),
                                      tests::grid_of({4, 5, 6}, [](glm::dvec3) { return 0.0; })};
  Diagnostics diagnostics;
  const auto atlas = compiler::pack_thesis_atlas(grids, 64, diagnostics);
  REQUIRE(atlas);
  CHECK(atlas->texture.extent == glm::uvec3(8, 8, 8));  // 4 + 3, 5, 6
  CHECK(atlas->slots[1] == glm::uvec3(0, 0, 0));        // the largest first
  CHECK(atlas->slots[0] == glm::uvec3(4, 0, 0));
  const auto texel = [&](int x, int y, int z) { return static_cast<int>(atlas->texture.texels[(z * 8 + y) * 8 + x]); };
  CHECK(texel(3, 4, 5) == 128);  // round(127.5)
  CHECK(texel(4, 0, 0) == 0);
  CHECK(texel(6, 4, 5) == 0);
  CHECK(texel(7, 0, 0) == 255);
  CHECK(texel(0, 5, 0) == 255);
  CHECK(texel(0, 0, 6) == 255);
  CHECK_FALSE(compiler::pack_thesis_atlas(grids, 7, diagnostics));
}

TEST_CASE("thesis: neighbours in the atlas and its padding bleed into a grid's outer half texel") {
  // Texels 0-3 are 0 (-1), texels 4-7 are 140 (0.1): at q.x of the second grid a texture lookup lies at texel
  // 2 (q.x + 1) + 3.5, and 140/255 (2 (q.x + 1) + 0.5) <= 0.51 up to q.x = -0.786.
  const std::string scene =
      "<MVV><OBJECT name='A'><SDF name='T' file='a.lxn'/><SDF name='S' file='b.lxn'/><REGION name='IN' type='color' "
      "rgb='1 0 0'/><REGION name='OUT' type='color' rgb='0 0 1'/><MAPPINGS><SDF name='T'><POSITIVE region='OUT'/>"
      "<NEGATIVE><SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></NEGATIVE></SDF></MAPPINGS>"
      "</OBJECT></MVV>";
  const Both row =
      paths(scene, {{"a.lxn", constant_lxn(-1.0, 4)}, {"b.lxn", constant_lxn(0.1, 4)}}, {{-0.9, 0, 0}, {-0.7, 0, 0}});
  CHECK(row.thesis == Paths{"A:IN", "A:OUT"});
  CHECK(row.reference == Paths{"A:OUT", "A:OUT"});
  // Five texels of 128 (0), then padding of 255: at q.x = 0.9 a quarter of the way between.
  const Both padded = paths(one_sdf("file='z.lxn'"), {{"z.lxn", constant_lxn(0.0, 5)}}, {{0.9, 0, 0}, {0.5, 0, 0}});
  CHECK(padded.thesis == Paths{"A:OUT", "A:IN"});
  CHECK(padded.reference == Paths{"A:IN", "A:IN"});
}

TEST_CASE("thesis: a seed at the lower border of an index is in none of its cells") {
  // Entered by its corners, moved by 0.001 of the index: [-1, -0.9986] / 2 + 0.499 lies below 0.
  const std::string text = root(
      "<INDEX size='4 4 4'><EMBEDDED name='BOX' translate='-0.9993 0 0' scale='0.0007 0.2 0.2'/>"
      "<EMBEDDED name='BOX' translate='0.9993 0 0' scale='0.0007 0.2 0.2'/></INDEX>");
  const Both both = paths(text, {}, {{-0.9993, 0, 0}, {0.9993, 0, 0}});
  CHECK(both.thesis == Paths{"ROOT:R", "ROOT:R[1]/BOX:B"});
  CHECK(both.reference == Paths{"ROOT:R[0]/BOX:B", "ROOT:R[1]/BOX:B"});
  const Both seeds = paths(one_sdf("type='seeding' index='4 4 4' file='c.lxn' seedFile='p.txt' scale='0.0007 0.2 0.2'"),
                           {{"c.lxn", constant_lxn(-0.5)}, {"p.txt", "-0.49965 0 0\n0.49965 0 0\n"}},
                           {{-0.9993, 0, 0}, {0.9993, 0, 0}});
  CHECK(seeds.thesis == Paths{"A:OUT", "A:IN"});
  CHECK(seeds.reference == Paths{"A:IN", "A:IN"});
}

TEST_CASE("thesis: of several INDEX only the first is searched, and nothing beside it") {
  const std::string text = root(
      "<EMBEDDED name='BOX' translate='-0.5 0 0' scale='0.2 0.2 0.2'/><INDEX size='2 2 2'><EMBEDDED name='BOX' "
      "scale='0.2 0.2 0.2'/></INDEX><INDEX size='2 2 2'><EMBEDDED name='BOX' translate='0.5 0 0' scale='0.2 0.2 0.2'/>"
      "</INDEX>");
  const Both both = paths(text, {}, {{-0.5, 0, 0}, {0, 0, 0}, {0.5, 0, 0}});
  CHECK(both.thesis == Paths{"ROOT:R", "ROOT:R[1]/BOX:B", "ROOT:R"});
  CHECK(both.reference == Paths{"ROOT:R[0]/BOX:B", "ROOT:R[1]/BOX:B", "ROOT:R[2]/BOX:B"});
}

TEST_CASE("thesis: one enclosing point is remembered; a second level that comes back empty ends the search") {
  const auto& scene = tests::conformance_scene("two levels, second comes back empty");
  // At 0.6 the point is in the tube but beside the cell in it; the next candidate of the root holds it.
  const Both both = paths(scene.text, scene.files, {{0.6, 0, 0}, {0.1, 0.3, 0}, {0.85, 0, 0}});
  CHECK(both.reference == Paths{"ROOT:BASE[1]/CELL:PLASMA", "ROOT:BASE[0]/TUBE:LUMEN[0]/CELL:PLASMA", "ROOT:BASE"});
  CHECK(both.thesis == Paths{"", "ROOT:BASE[0]/TUBE:LUMEN[0]/CELL:PLASMA", "ROOT:BASE"});
}

TEST_CASE("thesis: 512 steps at most") {
  // The root takes one step, each candidate that does not hold the point another: number 510 is the last to be asked.
  for (const int hit : {510, 511}) {
    std::string positions, scales;
    for (int i = 0; i <= hit; ++i) positions += i == hit ? "0 0 0\n" : "0.45 0.45 0.45\n";
    for (int i = 0; i <= hit; ++i) scales += "0.1 0.1 0.1\n";
    const Both both = paths(root("<EMBEDDED name='BOX' seedFile='p.txt' scaleFile='s.txt'/>"),
                            {{"p.txt", positions}, {"s.txt", scales}}, {{0, 0, 0}});
    const std::string found = fmt::format("ROOT:R[{}]/BOX:B", hit);
    CHECK(both.reference == Paths{found});
    CHECK(both.thesis == Paths{hit == 510 ? found : "ROOT:R"});
  }
}

TEST_CASE("thesis: only the first of a region's candidates is tiled") {
  const std::string tiled = "<EMBEDDED name='BOX' type='tiling' scale='0.2 0.2 0.2'/>";
  const std::string missed = "<EMBEDDED name='BOX' translate='0 0.9 0' scale='0.1 0.1 0.1'/>";
  CHECK(paths(root(tiled), {}, {{0.7, 0, 0}}).thesis == Paths{"ROOT:R[0]/BOX:B"});
  const Both both = paths(root(missed + tiled), {}, {{0.7, 0, 0}, {0.1, 0, 0}});
  CHECK(both.thesis == Paths{"ROOT:R", "ROOT:R[1]/BOX:B"});
  CHECK(both.reference == Paths{"ROOT:R[1]/BOX:B", "ROOT:R[1]/BOX:B"});
}

TEST_CASE("thesis: analytic seeds are evaluated at the point before seeding") {
  // The seed's cube is 0 <= x <= 1: 0.94 is at 0.88 in it, inside a sphere of 0.9, but 0.94 itself is not.
  const Both both =
      paths(one_sdf("function='true' type='seeding' seedFile='p.txt' scale='0.5 0.5 0.5'", "return length(p) - 0.9;"),
            {{"p.txt", "0.25 0 0\n"}}, {{0.94, 0, 0}, {0.5, 0, 0}});
  CHECK(both.thesis == Paths{"A:OUT", "A:IN"});
  CHECK(both.reference == Paths{"A:IN", "A:IN"});
  // Not seeded, the point is right; the boundary stands at f = 0.02.
  const Both single =
      paths(one_sdf("function='true' translate='0.25 0 0' scale='0.5 0.5 0.5'", "return length(p) - 0.5;"), {},
            {{0.5095, 0, 0}, {0.5105, 0, 0}});
  CHECK(single.thesis == Paths{"A:IN", "A:OUT"});
  CHECK(single.reference == Paths{"A:OUT", "A:OUT"});
}

TEST_CASE("thesis: scenes beyond the fixed buffers are refused, naming the buffer and both numbers") {
  const auto refused = [](const std::string& text, const tests::Files& files, const std::string& part) {
    CAPTURE(part);
    Diagnostics diagnostics;
    CHECK_FALSE(compiler::compile(tests::lowered(text, files), thesis(), diagnostics));
    REQUIRE(diagnostics.all().size() == 1);
    CHECK(diagnostics.all()[0].code == Code::thesis_limit);
    CHECK_MESSAGE(diagnostics.all()[0].message.find(part) != std::string::npos, diagnostics.all()[0].message);
  };
  // A chain of `count` decisions, each with an SDF of its own if `distinct`.
  const auto chain = [](int count, bool distinct) {
    std::string sdfs, open, close;
    for (int i = 0; i < count; ++i) {
      const std::string name = fmt::format("S{}", distinct ? i : i % 60);
      if (distinct || i < 60) sdfs += fmt::format("<SDF name='{}' function='true'>return p.x - {}.0;</SDF>", name, i);
      open += fmt::format("<SDF name='{}'><POSITIVE region='P'/><NEGATIVE>", name);
      close = "</NEGATIVE></SDF>" + close;
    }
    return "<MVV><OBJECT name='A'>" + sdfs +
           "<REGION name='P' type='color' rgb='1 0 0'/><REGION name='N' type='color' "
           "rgb='0 0 1'/><MAPPINGS>" +
           open + "<REGION name='N'/>" + close + "</MAPPINGS></OBJECT></MVV>";
  };
  refused(chain(65, false), {}, "128 nodes; this scene needs 131");
  Diagnostics fine;
  CHECK(compiler::compile(tests::lowered(chain(63, true)), thesis(), fine));  // 127 nodes
  const std::string full = "<EMBEDDED name='BOX'/>";
  refused(root("<INDEX size='64 64 64'>" + full + full + "</INDEX>"), {}, "262144 instances");
  refused(root("<INDEX size='128 64 64'><EMBEDDED name='BOX' scale='0.1 0.1 0.1'/></INDEX>"), {},
          "262144 cells of index grids; this scene needs 524288");
  std::string objects;
  std::string embedded;
  for (int i = 0; i < 64; ++i) {
    objects += fmt::format("<OBJECT name='O{}'><REGION name='R' type='color' rgb='0 1 0'/></OBJECT>", i);
    embedded += fmt::format("<EMBEDDED name='O{}' scale='0.5 0.5 0.5'/>", i);
  }
  refused("<MVV>" + objects + "<OBJECT name='ROOT'><REGION name='R' type='color' rgb='0 0 1'>" + embedded +
              "</REGION></OBJECT></MVV>",
          {}, "64 regions; this scene needs 65");
}

TEST_CASE("thesis: every conformance scene runs to its end") {
  runtime::DeviceOptions with_validation;
  with_validation.validation = true;
  auto device = runtime::Device::create(with_validation);
  REQUIRE(device);
  tests::Random random(3);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 500; ++i) points.push_back(random.point());
  for (const auto& scene : tests::conformance_scenes()) {
    CAPTURE(scene.name);
    const auto program = tests::compiled(tests::lowered(scene.text, scene.files), thesis());
    auto evaluator = runtime::Evaluator::create(*device, program);
    REQUIRE(evaluator);
    CHECK(evaluator->probe(points, 1234.5));
  }
  for (const auto& message : device->validation_messages()) FAIL_CHECK(message);
}
