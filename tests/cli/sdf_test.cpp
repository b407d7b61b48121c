// dmvv sdf: a mesh becomes a grid, and the mesh that belongs to it; so does an SDF of a scene.
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "tests/cli/program.h"
#include "tests/cli/scenes.h"
#include "voml/assets/mesh.h"

using namespace dmvv;
using namespace dmvv::tests;

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

TEST_CASE("a mesh without inside is an error that names its edges, and leaves no grid") {
  const Folder folder;
  const std::string corners =
      "v -0.5 -0.5 -0.5\nv 0.5 -0.5 -0.5\nv -0.5 0.5 -0.5\nv 0.5 0.5 -0.5\n"
      "v -0.5 -0.5 0.5\nv 0.5 -0.5 0.5\nv -0.5 0.5 0.5\nv 0.5 0.5 0.5\n";
  const std::string out_wards = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  const std::string inwards = "f 2 4 3 1\nf 7 8 6 5\nf 5 6 2 1\nf 4 8 7 3\nf 3 7 5 1\nf 6 8 4 2\n";
  const std::string against =
      "f 4 3 1\nf 1 4 2\nf 8 6 5\nf 5 8 7\nf 6 2 1\nf 1 6 5\nf 8 7 3\nf 3 8 4\nf 7 5 1\nf 1 7 3\nf 8 4 2\nf 2 8 6\n";
  const std::string first = ", the first from (-0.5 -0.5 -0.5) to (0.5 -0.5 -0.5)\n";
  const std::pair<std::string, std::string> cases[] = {
      {out_wards + inwards, "12 edges have more than two triangles" + first},
      {against, "18 edges lie between two triangles wound against each other" + first}};
  for (const auto& [faces, words] : cases) {
    const Run run = run_dmvv({"sdf", folder.write("a.obj", corners + faces), "-o", folder.file("a.lxn"), "--check"});
    CAPTURE(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.out.empty());
    CHECK(run.err.find("the mesh has no inside") != std::string::npos);
    CHECK(run.err.find(words) != std::string::npos);
    CHECK(run.err.find("open") == std::string::npos);  // no edge is
    CHECK(folder.listing().size() == 1);
    const Run info = run_dmvv({"info", folder.file("a.obj")});
    CHECK(info.out.find("open edges   0\n") != std::string::npos);
    CHECK(info.out.find("not closed   " + words) != std::string::npos);
  }
  CHECK(run_dmvv({"sdf", folder.write("a.obj", corners + out_wards), "-o", folder.file("a.lxn")}).err.empty());
}

TEST_CASE("a byte order mark, and bytes behind the last triangle: the cube is read; a warning for the latter") {
  const Folder folder;
  const std::string plain = folder.write("box.obj", box_obj(-0.5, 0.5));
  CHECK(run_dmvv({"sdf", plain, "-o", folder.file("a.lxn"), "--resolution", "16"}).err.empty());
  const std::string marked = folder.write("marked.obj", "\xef\xbb\xbf" + box_obj(-0.5, 0.5));
  CHECK(run_dmvv({"sdf", marked, "-o", folder.file("b.lxn"), "--resolution", "16"}).err.empty());
  CHECK((folder.read("a.lxn") == folder.read("b.lxn")));

  const voml::Mesh cube = voml::standard_cube();
  std::string stl(80, '\0');
  const auto put = [&](auto value) { stl.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(std::uint32_t{12});
  for (const glm::uvec3& t : cube.triangles) {
    for (int axis = 0; axis < 3; ++axis) put(0.0f);
    for (int i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(cube.positions[t[i]][axis]));
    }
    put(std::uint16_t{0});
  }
  const std::string path = folder.write("cube.stl", stl + std::string(16, 'x'));
  const Run run = run_dmvv({"sdf", path, "-o", folder.file("c.lxn"), "--resolution", "16"});
  CHECK(run.exit_code == 0);
  CHECK(run.err.find("cube.stl: warning[W0600]: the STL file promises 12 triangles; the 16 bytes behind the last one "
                     "are passed over (at byte 684)") != std::string::npos);
  CHECK((folder.read("a.lxn") == folder.read("c.lxn")));  // the same cube, fitted
  CHECK(run_dmvv({"sdf", path, "-o", folder.file("d.lxn"), "--strict"}).exit_code == 1);
  CHECK(folder.listing().size() == 6);
}

TEST_CASE("--check tells what was lost: shares as people write them, and a resolution that holds what is told") {
  const Folder folder;
  // A plate through a box, 6 by 2 and 0.05 thick: layers of samples 0.22 apart, one on either side of it.
  const std::string mesh = folder.write(
      "plate.obj", box_obj(-1, 1) +
                       "v -3 0 -1\nv 3 0 -1\nv 3 0.05 -1\nv -3 0.05 -1\nv -3 0 1\nv 3 0 1\nv 3 0.05 1\nv -3 0.05 1\n"
                       "f 9 12 11 10\nf 13 14 15 16\nf 9 10 14 13\nf 12 16 15 11\nf 9 13 16 12\nf 10 11 15 14\n");
  const Run run = run_dmvv({"sdf", mesh, "-o", folder.file("a.lxn"), "--resolution", "30", "--check"});
  CAPTURE(run.err);
  CAPTURE(run.out);
  REQUIRE(run.exit_code == 0);
  const std::string words = "  boundary lost    ";
  REQUIRE(run.out.find(words) != std::string::npos);
  const std::size_t at = run.out.find("a resolution of ");
  REQUIRE(at != std::string::npos);
  const std::string enough = std::to_string(std::stoul(run.out.substr(at + 16)));
  const Run finer = run_dmvv({"sdf", mesh, "-o", folder.file("a.lxn"), "--resolution", enough, "--check"});
  CAPTURE(finer.out);
  REQUIRE(finer.exit_code == 0);
  CHECK(std::stod(finer.out.substr(finer.out.find(words) + words.size())) <= 1.0);
  CHECK(finer.out.find("a resolution of ") == std::string::npos);
  const Run whole = run_dmvv({"sdf", folder.write("box.obj", box_obj(0, 1)), "-o", folder.file("b.lxn"), "--check"});
  CHECK(whole.out.find("  boundary lost    0 % of the surface\n") != std::string::npos);
}

TEST_CASE("--check reports on what was written: exact at samples, and where the surface is worst") {
  const Folder folder;
  const std::string mesh = folder.write("box.obj", box_obj(0, 3));
  const Run run = run_dmvv({"sdf", mesh, "-o", folder.file("box.lxn"), "--resolution", "24", "--check"});
  CAPTURE(run.err);
  CAPTURE(run.out);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("check against the 12 triangles of " + mesh + "; a voxel is 0.08333\n") != std::string::npos);
  const auto number_behind = [&](const std::string& words) {
    const std::size_t at = run.out.find(words);
    REQUIRE(at != std::string::npos);
    return std::stod(run.out.substr(at + words.size()));
  };
  CHECK(number_behind("at samples       max ") < 1.2e-7);
  CHECK(number_behind("on the surface   max ") < 0.0834);
  CHECK(number_behind("between samples  max ") < 0.0834);
  CHECK(number_behind("wrong side       ") < 400);  // of 40,000
}

TEST_CASE("an SDF of a scene is baked: its own values, or distances, and the same picture of it") {
  const Folder folder;
  const std::string scene = folder.write(
      "ball.voml",
      "<MVV><OBJECT name=\"BALL\"><SDF name=\"SKIN\" function=\"true\" offset=\"1\" translate=\"0.1 0 0\">return 4.0 * "
      "dot(p, p) + 0.001 * t;</SDF><REGION name=\"R\" type=\"color\" rgb=\"1 0 0\"/></OBJECT></MVV>");
  // 4 |p|^2 + 0.36 - 1 is negative within 0.4 of (0.1, 0, 0).
  const auto centre = [](const voml::Grid& grid, std::size_t i) {
    const glm::dvec3 at(i % grid.size.x, i / grid.size.x % grid.size.y, i / (grid.size.x * grid.size.y));
    return grid.box_lo + (at + 0.5) / glm::dvec3(grid.size) * (grid.box_hi - grid.box_lo) - glm::dvec3(0.1, 0, 0);
  };
  const std::vector<std::string> command{
      "sdf",    "--from", scene,          "--sdf", "SKIN",   "-o", folder.file("a.lxn"),
      "--time", "360",    "--resolution", "40",    "--check"};
  const Run run = run_dmvv(command);
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("check against 'SKIN' of " + scene) != std::string::npos);
  const voml::Grid values = read_grid(folder, "a.lxn");
  for (std::size_t i = 0; i < values.values.size(); ++i) {
    const glm::dvec3 p = centre(values, i);
    REQUIRE(values.values[i] == doctest::Approx(4.0 * glm::dot(p, p) - 0.64).epsilon(1e-6).scale(1.0));
  }

  std::vector<std::string> with_distance = command;
  with_distance[6] = folder.file("b.lxn");
  with_distance.push_back("--distance");
  CHECK(run_dmvv(with_distance).exit_code == 0);
  const voml::Grid distances = read_grid(folder, "b.lxn");
  for (std::size_t i = 0; i < distances.values.size(); ++i) {
    // voxel^2 / 2 times the curvature is 6e-4.
    REQUIRE(std::abs(distances.values[i] - (glm::length(centre(distances, i)) - 0.4)) < 6e-4);
  }
}

TEST_CASE("what dmvv sdf refuses: neither or both sources, options of the other, names that no object has") {
  const Folder folder;
  const std::string scene =
      folder.write("s.voml",
                   "<MVV><OBJECT name=\"O\"><SDF name=\"SKIN\" function=\"true\">return p.x;</SDF><REGION name=\"R\" "
                   "type=\"color\" rgb=\"1 0 0\"/></OBJECT></MVV>");
  const std::string mesh = folder.write("box.obj", box_obj(0, 1)), out = folder.file("x.lxn");
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string word;
  };
  const Case cases[] = {{{"sdf", "-o", out}, 2, "nothing to make a grid from"},
                        {{"sdf", mesh, "--from", scene, "--sdf", "SKIN", "-o", out}, 2, "a mesh and --from at once"},
                        {{"sdf", "--from", scene, "-o", out}, 2, "--from needs --sdf"},
                        {{"sdf", mesh, "--sdf", "SKIN", "-o", out}, 2, "--sdf is for --from"},
                        {{"sdf", mesh, "--distance", "-o", out}, 2, "--distance is for --from"},
                        {{"sdf", mesh, "--time", "5", "-o", out}, 2, "--time is for --from"},
                        {{"sdf", "--from", scene, "--sdf", "SKIN", "--no-fit", "-o", out}, 2, "--no-fit is for meshes"},
                        {{"sdf", "--from", scene, "--sdf", "SKN", "-o", out}, 1, "did you mean 'SKIN'?"},
                        {{"sdf", "--from", mesh, "--sdf", "SKIN", "-o", out}, 1, "box.obj"},
                        {{"sdf", "--from", folder.file("none.voml"), "--sdf", "SKIN", "-o", out}, 1, "none.voml"}};
  for (const Case& c : cases) {
    const Run run = run_dmvv(c.arguments);
    CAPTURE(run.err);
    CHECK(run.exit_code == c.exit_code);
    CHECK(run.err.find(c.word) != std::string::npos);
    CHECK(run.out.empty());
  }
  CHECK(folder.listing().size() == 2);  // nothing was written
}

TEST_CASE("256^3 in the memory that --help states: 8 bytes a sample") {
  const Folder folder;
  const std::string mesh = folder.write("box.obj", box_obj(-1, 1));
  const pid_t child =
      start_dmvv({"sdf", mesh, "-o", folder.file("box.lxn"), "--resolution", "256", "--check"}, folder.file("err"));
  int status = 0;
  rusage usage{};
  REQUIRE(wait4(child, &status, 0, &usage) == child);
  CHECK(status == 0);
  const double samples = 256.0 * 256.0 * 256.0, mebibyte = 1024.0 * 1024.0;
  CHECK(static_cast<double>(usage.ru_maxrss) * 1024.0 < 8.0 * samples + 64.0 * mebibyte);  // 64: the program itself
  CHECK(folder.read("box.lxn").size() == static_cast<std::size_t>(128 + 4 * samples));
}
