// dmvv sdf: a mesh becomes a grid, and the mesh that belongs to it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "tests/cli/program.h"
#include "tests/cli/scenes.h"
#include "voml/mesh.h"

using namespace dmvv;
using namespace dmvv::test;

namespace {

/// A box from lo to hi; without its last `missing` triangles.
std::string box_obj(double lo, double hi, std::size_t missing = 0) {
  const voml::Mesh cube = voml::standard_cube();
  std::string text;
  for (const glm::dvec3& p : cube.positions) {
    const glm::dvec3 q = glm::mix(glm::dvec3(lo), glm::dvec3(hi), (p + 1.0) * 0.5);
    text += "v " + std::to_string(q.x) + ' ' + std::to_string(q.y) + ' ' + std::to_string(q.z) + '\n';
  }
  for (std::size_t i = 0; i + missing < cube.triangles.size(); ++i) {
    const glm::uvec3 t = cube.triangles[i] + 1u;
    text += "f " + std::to_string(t.x) + ' ' + std::to_string(t.y) + ' ' + std::to_string(t.z) + '\n';
  }
  return text;
}

/// The signed distance of a box around the origin.
double box_distance(const glm::dvec3& p, double half) {
  const glm::dvec3 d = glm::abs(p) - half;
  return glm::length(glm::max(d, 0.0)) + std::min(0.0, std::max({d.x, d.y, d.z}));
}

voml::Grid read_grid(const Folder& folder, const std::string& name) {
  Diagnostics diagnostics;
  auto grid = voml::parse_lxn(folder.read(name), diagnostics.add_source(name, ""), diagnostics);
  REQUIRE_MESSAGE(grid, diagnostics.render());
  return *grid;
}

}  // namespace

TEST_CASE("a box that is not fitted: exact distances at the sample points") {
  const Folder folder;
  const Run run = run_dmvv({"sdf", folder.write("box.obj", box_obj(-0.5, 0.5)), "-o", folder.file("box.lxn"),
                            "--resolution", "12", "--padding", "0.25", "--no-fit"});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.err.empty());  // no progress line where nobody looks
  CHECK(run.out.find("12 x 12 x 12 samples") != std::string::npos);
  const voml::Grid grid = read_grid(folder, "box.lxn");
  REQUIRE(grid.size == glm::uvec3(12));
  std::size_t i = 0;
  for (glm::uvec3 at(0); at.z < 12; ++at.z) {
    for (at.y = 0; at.y < 12; ++at.y) {
      for (at.x = 0; at.x < 12; ++at.x, ++i) {
        const glm::dvec3 p = grid.box_lo + (glm::dvec3(at) + 0.5) / 12.0 * (grid.box_hi - grid.box_lo);
        REQUIRE(grid.values[i] == doctest::Approx(box_distance(p, 0.5)).epsilon(1e-5).scale(1.0));
      }
    }
  }
}

TEST_CASE("a fitted mesh fills the cube with its padding, and is written as it was fitted") {
  const Folder folder;
  const Run run =
      run_dmvv({"sdf", folder.write("box.obj", box_obj(10, 14)), "-o", folder.file("box.lxn"), "--resolution", "8",
                "--padding", "0.25", "--threads", "2", "--write-mesh", folder.file("box.ply")});
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  Diagnostics diagnostics;
  const auto mesh = voml::parse_mesh("box.ply", folder.read("box.ply"), diagnostics);
  REQUIRE_MESSAGE(mesh, diagnostics.render());
  CHECK(mesh->triangles.size() == 12);
  // Edge 1 and a quarter of it on either side make 2: the edge is 2 / 1.5 long.
  const voml::Bounds box = voml::bounds(*mesh);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(box.lo[axis] == doctest::Approx(-2.0 / 3.0).epsilon(1e-6));
    CHECK(box.hi[axis] == doctest::Approx(2.0 / 3.0).epsilon(1e-6));
  }
  // It is the grid's own surface: the grid calls a point inside if the mesh does.
  const voml::Grid grid = read_grid(folder, "box.lxn");
  CHECK(*std::min_element(grid.values.begin(), grid.values.end()) < 0.0f);
  CHECK(*std::max_element(grid.values.begin(), grid.values.end()) > 0.0f);
}

TEST_CASE("a mesh with a hole: a warning with the number of open edges, the same grid in two runs") {
  const Folder folder;
  const std::string mesh = folder.write("open.obj", box_obj(-1, 1, 1));
  const Run run = run_dmvv({"sdf", mesh, "-o", folder.file("a.lxn"), "--resolution", "8"});
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("3 open edges") != std::string::npos);
  CHECK(run_dmvv({"sdf", mesh, "-o", folder.file("b.lxn"), "--resolution", "8", "--threads", "1", "--quiet"})
            .err.empty());
  CHECK((folder.read("a.lxn") == folder.read("b.lxn")));
}
