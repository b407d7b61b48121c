// dmvv info: figures that mathematics gives.
#include <doctest/doctest.h>

#include "runtime/view/picture.h"
#include "tests/cli/program.h"
#include "tests/cli/scenes.h"

using namespace dmvv::tests;

namespace {
void check_says(const Run& run, const std::vector<std::string>& parts) {
  CAPTURE(run.err);
  CHECK(run.exit_code == 0);
  for (const std::string& part : parts)
    CHECK_MESSAGE(run.out.find(part) != std::string::npos, part << "\nin\n" << run.out);
}
}  // namespace

TEST_CASE("a grid of a linear function has its coefficients for slopes") {
  const Folder folder;
  // f = 3x - 4y: gradient (3, -4, 0) of norm 5, half of the cube inside; the outer samples stand at 7/8.
  const std::string grid = folder.write("f.lxn", sampled(8, [](const glm::dvec3& q) { return 3 * q.x - 4 * q.y; }));
  check_says(run_dmvv({"info", grid}),
             {"8 x 8 x 8", "(-1 -1 -1) to (1 1 1)", "values       -6.125 to 6.125",
              "Lipschitz    3 along x, 4 along y, 0 along z; gradient at most 5", "2176 bytes"});
}

TEST_CASE("a scene as a tree, with counts and memory") {
  const Folder folder;
  folder.write("seeds.txt", "0.1 0 0\n0.2 0 0\n0.3 0 0\n");
  const std::string scene = folder.write("s.voml", R"(<MVV>
  <OBJECT name="PIP"><REGION name="R.PIP" type="color" rgb="1 1 0"/></OBJECT>
  <OBJECT name="PULP"><REGION name="R.PULP" type="color" rgb="1 0.5 0">
    <EMBEDDED name="PIP" type="seeding" seedFile="seeds.txt" scale="0.01 0.01 0.01"/></REGION></OBJECT>
  <OBJECT name="FRUIT"><REGION name="R.PEEL" type="color" rgb="1 0.6 0">
    <EMBEDDED name="PULP" scale="0.5 0.5 0.5"/><EMBEDDED name="PIP" scale="0.1 0.1 0.1" translate="0.8 0 0"/></REGION></OBJECT>
</MVV>)");
  check_says(run_dmvv({"info", scene}),
             {"root FRUIT", "3 objects, 0 SDFs, 3 regions, 5 embedded candidates, 0 SDF seeds, depth 3",
              "\n  FRUIT: 0 decisions, 1 region\n", "\n    R.PEEL: 1 x PULP: 0 decisions, 1 region\n",
              "\n      R.PULP: 3 x PIP: 0 decisions, 1 region\n", "\n    R.PEEL: 1 x PIP: as above\n", "3 seeds"});
}

TEST_CASE("a scene: what moves, which code, what the passes found, and what is uploaded") {
  const Folder folder;
  const std::string scene = folder.write("s.voml", R"(<MVV>
  <OBJECT name="PIP"><SDF name="BALL" function="true">return length(p) - 0.5;</SDF>
    <REGION name="R.PIP" type="color" rgb="1 1 0"/></OBJECT>
  <OBJECT name="PULSE"><SDF name="SKIN" function="true">return length(p) - 0.9 - 0.01 * sin(t);</SDF>
    <REGION name="R.PULSE" type="color" rgb="1 0 0"><EMBEDDED name="PIP"/></REGION></OBJECT>
  <OBJECT name="BOX"><REGION name="R.BOX" type="color" rgb="1 1 1"><EMBEDDED name="PULSE"/></REGION></OBJECT>
</MVV>)");
  check_says(run_dmvv({"info", scene}),
             {"\n  BOX: 0 decisions, 1 region\n    code    specialised\n    moves   what it embeds\n",
              "\n    R.BOX: 1 x PULSE: 1 decision, 2 regions\n      code    specialised\n      moves   SKIN\n",
              "\n        moves   no\n", "; no texels\n", "\npasses\n  merge-assets     nothing to do\n",
              "\n  box-tests        2 of 2 box tests are left out\n", "\n  time             1 value a frame\n"});
  check_says(run_dmvv({"info", scene, "--codegen", "table", "--disable", "index"}),
             {"\n    code    table\n", "\n  index            off\n", ", objects 12 bytes, "});
  check_says(run_dmvv({"info", scene, "--root", "PIP"}), {"\n  time             none: the scene is static\n"});
  CHECK(run_dmvv({"info", scene, "--codegen", "thesis"}).exit_code == 2);
}

TEST_CASE("a picture: is it a bitmap?") {
  const Folder folder;
  dmvv::runtime::Picture picture;
  picture.size_px = {4, 16};
  picture.rgba.assign(4 * 4 * 16, 1.0f);
  REQUIRE(dmvv::runtime::write_picture(folder.file("b.png"), picture));
  check_says(run_dmvv({"info", folder.file("b.png")}), {"4 x 16", "4 channels", "a bitmap of 4 x 4 x 4 texels"});
  picture.size_px = {8, 8};
  REQUIRE(dmvv::runtime::write_picture(folder.file("p.png"), picture));
  check_says(run_dmvv({"info", folder.file("p.png")}), {"8 x 8", "no bitmap"});
}

TEST_CASE("a mesh: bounds and open edges") {
  const Folder folder;
  const std::string mesh = folder.write("t.obj", "v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 3\n");
  check_says(run_dmvv({"info", mesh}), {"3 vertices, 1 triangle\n", "(0 0 0) to (2 3 0)", "open edges   3"});
}
