// dmvv mesh: a support mesh of a scene's own surface; and the word about pictures that would be blank without one.
#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include "tests/cli/program.h"
#include "voml/assets/mesh.h"

using namespace dmvv::tests;

namespace {

// A ball of radius 0.5 at (0.2, 0, 0) in an empty cube.
const char* const ball = R"(<MVV><OBJECT name="A">
  <SDF name="S" function="true">return length(p - vec3(0.2, 0.0, 0.0)) - 0.5;</SDF>
  <REGION name="R" type="color" rgb="1 0 0"/>
</OBJECT></MVV>)";

/// Closed, wound alike, each triangle with an area.
void check_sound(const std::string& ply) {
  dmvv::Diagnostics diagnostics;
  const auto mesh = dmvv::voml::parse_mesh("a.ply", ply, diagnostics);
  REQUIRE_MESSAGE(mesh, diagnostics.render());
  const dmvv::voml::EdgeFaults faults = dmvv::voml::find_edge_faults(*mesh);
  CHECK(faults.open.count == 0);
  CHECK(faults.opposed.count == 0);
  std::size_t without_area = 0;
  for (const glm::uvec3& t : mesh->triangles) {
    const glm::dvec3 a = mesh->positions[t.x];
    const double area = glm::length(glm::cross(mesh->positions[t.y] - a, mesh->positions[t.z] - a));
    without_area += area > 0.0 ? 0 : 1;
  }
  CHECK(without_area == 0);
  const auto first = dmvv::voml::first_of_equal(mesh->positions);
  for (std::uint32_t i = 0; i < first.size(); ++i) REQUIRE(first[i] == i);
}

}  // namespace

TEST_CASE("meshes of examples are closed, wound alike, and without triangles that have no area") {
  const Folder folder;
  for (const char* name :
       {"shapes/shapes", "sticks/sticks", "library/red_blood_cell", "library/vessel", "library/cell"}) {
    CAPTURE(name);
    const std::string scene = std::string(DMVV_BINARY_DIR) + "/examples/" + name + ".voml", mesh = folder.file("a.ply");
    const Run run = run_dmvv({"mesh", scene, "-o", mesh, "--resolution", "40"});
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    check_sound(folder.read("a.ply"));
  }
}

TEST_CASE("a mesh of a scene shows it, where its cube's faces do not") {
  const Folder folder;
  const std::string scene = folder.write("ball.voml", ball);
  const std::string mesh = folder.file("ball.ply");
  const Run made = run_dmvv({"mesh", scene, "-o", mesh, "--resolution", "40"});
  CAPTURE(made.err);
  REQUIRE(made.exit_code == 0);
  CHECK(made.out.find(" triangles, from -0.300 -0.500 -0.500 to 0.700 0.500 0.500, ") != std::string::npos);
  const std::string bytes = folder.read("ball.ply");
  check_sound(bytes);
  const Run seen =
      run_dmvv({"render", scene, "-o", folder.file("a.png"), "--size", "40x30", "--mesh", mesh, "--cut", "1 0 0 0.2"});
  CHECK(seen.exit_code == 0);
  CHECK(seen.err.empty());  // neither blank, nor open edges
  CHECK(run_dmvv({"mesh", scene, "-o", mesh, "--resolution", "40", "--quiet"}).out.empty());
  CHECK(folder.read("ball.ply") == bytes);
}

TEST_CASE("a mesh of nothing, wrong resolutions, wrong endings: no file") {
  const Folder folder;
  const std::string nothing =
      folder.write("n.voml", "<MVV><OBJECT name='A'><REGION name='R' type='empty'/></OBJECT></MVV>");
  const Run run = run_dmvv({"mesh", nothing, "-o", folder.file("n.ply"), "--resolution", "16"});
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("is empty at every point that was looked at") != std::string::npos);
  CHECK(run_dmvv({"mesh", nothing, "-o", folder.file("n.obj")}).exit_code == 1);
  CHECK(run_dmvv({"mesh", nothing, "-o", folder.file("n.ply"), "--resolution", "4"}).exit_code == 2);
  CHECK(folder.listing().size() == 1);
}
