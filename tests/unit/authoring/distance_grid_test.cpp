#include "authoring/distance_grid.h"

#include <doctest/doctest.h>

#include <array>
#include <random>
#include <string>

#include "tests/unit/authoring/shapes.h"

namespace dmvv::tests {

namespace {

using authoring::GridOptions;
using authoring::GridReport;

struct Made {
  voml::Grid grid;
  GridReport report;
};

Made make(const voml::Mesh& mesh, const GridOptions& options) {
  Made made;
  auto grid = authoring::distance_grid(mesh, options, made.report);
  REQUIRE(grid.has_value());
  made.grid = std::move(*grid);
  REQUIRE(made.grid.values.size() == std::size_t{made.grid.size.x} * made.grid.size.y * made.grid.size.z);
  return made;
}

dvec3 mesh_point(const GridReport& report, const dvec3& cube_point) {
  return (cube_point - report.cube_from_mesh_offset) / report.cube_from_mesh_scale;
}

/// Checks the size of a grid's voxels: equal along all axes but for the float32 corners of the box.
void check_cubic(const voml::Grid& grid, double voxel) {
  for (int axis = 0; axis < 3; ++axis) {
    CHECK((grid.box_hi[axis] - grid.box_lo[axis]) / grid.size[axis] == doctest::Approx(voxel).epsilon(1e-5));
    CHECK(grid.box_lo[axis] >= -1.0);
    CHECK(grid.box_hi[axis] <= 1.0);
  }
}

/// How many samples lie on another side than `exact` says, those nearer than `doubtful` to the surface aside.
template <class Exact>
std::size_t wrong_signs(const Made& made, double doubtful, Exact exact) {
  std::size_t wrong = 0;
  for_each_sample(made.grid, [&](const dvec3& p, double value) {
    const double expected = exact(mesh_point(made.report, p));
    if (std::abs(expected) > doubtful && (value < 0.0) != (expected < 0.0)) ++wrong;
  });
  return wrong;
}

}  // namespace

TEST_CASE("a box gives its distances to float32 rounding") {
  const dvec3 lo(10, -3, 2), hi(14, -1, 2.7);
  for (const double padding : {0.0, 0.05, 1.0}) {
    CAPTURE(padding);
    const Made made = make(box(lo, hi), {.resolution = 40, .padding = padding});
    CHECK(made.report.edges.count() == 0);
    double worst = 0.0;
    std::size_t inside = 0;
    for_each_sample(made.grid, [&](const dvec3& p, double value) {
      const double exact = box_distance(mesh_point(made.report, p), lo, hi) * made.report.cube_from_mesh_scale;
      worst = std::max(worst, std::abs(value - exact));
      inside += value < 0.0 ? 1 : 0;
    });
    CHECK(worst < 1.2e-7);  // half a unit in the last place of a float below 2
    CHECK(inside > 0);
  }
}

TEST_CASE("a mesh is fitted into the cube: its longest side with the padding fills it") {
  const Made made = make(box({10, -3, 2}, {14, -1, 2.7}), {.resolution = 48, .padding = 0.1});
  const double scale = 2.0 / (4.0 * 1.2);
  CHECK(made.report.cube_from_mesh_scale == doctest::Approx(scale));
  CHECK(glm::distance(made.report.cube_from_mesh_offset, -scale * dvec3(12, -2, 2.35)) < 1e-12);
  // 4.8 x 2.8 x 1.5 with its padding, in voxels of 0.1.
  CHECK(made.grid.size == glm::uvec3(48, 28, 15));
  CHECK(made.grid.box_lo.x == -1.0);
  CHECK(made.grid.box_hi.x == 1.0);
  check_cubic(made.grid, 2.0 / 48);
}

TEST_CASE("sizes are rounded up and the box grows on both sides") {
  const Made made = make(box({0, 0, 0}, {1, 0.51, 0.999}), {.resolution = 10, .padding = 0.0});
  CHECK(made.grid.size == glm::uvec3(10, 6, 10));
  check_cubic(made.grid, 0.2);
  CHECK(made.grid.box_lo.y == doctest::Approx(-0.6));
  CHECK(made.grid.box_hi.y == doctest::Approx(0.6));
}

TEST_CASE("unfitted, the mesh stays where it is and the box stays in the cube") {
  const dvec3 lo(0.5, -1.0, -0.2), hi(1.0, -0.63, -0.17);
  const Made made = make(box(lo, hi), {.resolution = 24, .padding = 0.2, .fit = false});
  CHECK(made.report.cube_from_mesh_scale == 1.0);
  CHECK(made.report.cube_from_mesh_offset == dvec3(0.0));
  // Padded by 0.1 and clipped: 0.4 .. 1, -1 .. -0.53, -0.3 .. -0.07; voxels of 0.6 / 24.
  CHECK(made.grid.size == glm::uvec3(24, 19, 10));
  check_cubic(made.grid, 0.025);
  CHECK(made.grid.box_lo.x == doctest::Approx(0.4));
  CHECK(made.grid.box_hi.x == 1.0);
  CHECK(made.grid.box_lo.y == -1.0);
  for_each_sample(made.grid,
                  [&](const dvec3& p, double value) { REQUIRE(std::abs(value - box_distance(p, lo, hi)) < 1e-7); });
}

TEST_CASE("a grid survives its file unchanged, box included") {
  const Made made = make(torus(0.3, 24, 12), {.resolution = 17});
  Diagnostics diagnostics;
  const auto read = voml::parse_lxn(voml::write_lxn(made.grid), diagnostics.add_source("torus.lxn", {}), diagnostics);
  INFO(diagnostics.render());
  REQUIRE(read.has_value());
  CHECK(read->box_lo == made.grid.box_lo);
  CHECK(read->box_hi == made.grid.box_hi);
  CHECK(read->size == made.grid.size);
  CHECK(read->values == made.grid.values);
}

TEST_CASE("a sphere's grid is off by no more than its mesh is") {
  const voml::Mesh mesh = sphere(5);
  // The mesh is inscribed: farthest from the sphere at the middle of its largest triangle.
  double sagitta = 0.0;
  for (const authoring::Corners& t : corners_of(mesh)) {
    sagitta = std::max(sagitta, 1.0 - glm::length((t[0] + t[1] + t[2]) / 3.0));
  }
  CHECK(sagitta < 2e-3);
  const Made made = make(mesh, {.resolution = 48, .padding = 0.2});
  const double scale = made.report.cube_from_mesh_scale;
  for_each_sample(made.grid, [&](const dvec3& p, double value) {
    const double exact = scale * (glm::length(mesh_point(made.report, p)) - 1.0);
    REQUIRE(value >= exact - 1e-6);
    REQUIRE(value <= exact + scale * sagitta + 1e-6);
  });
  CHECK(wrong_signs(made, sagitta, [](const dvec3& p) { return glm::length(p) - 1.0; }) == 0);
}

TEST_CASE("a torus has its hole and no wrong sign") {
  const Made made = make(torus(0.4, 200, 100), {.resolution = 60});
  CHECK(made.report.edges.count() == 0);
  double worst = 0.0;
  for_each_sample(made.grid, [&](const dvec3& p, double value) {
    const double exact = made.report.cube_from_mesh_scale * torus_distance(mesh_point(made.report, p), 0.4);
    worst = std::max(worst, std::abs(value - exact));
  });
  CHECK(worst < 5e-4);  // the mesh's sagitta: 1.4 (1 - cos(pi/200)) = 1.7e-4 and 0.4 (1 - cos(pi/100)) = 2e-4
  CHECK(wrong_signs(made, 4e-4, [](const dvec3& p) { return torus_distance(p, 0.4); }) == 0);
}

TEST_CASE("a mesh turned inside out as a whole is turned back") {
  const GridOptions options{.resolution = 32};
  const Made right = make(torus(0.4, 60, 30), options), wrong = make(inside_out(torus(0.4, 60, 30)), options);
  REQUIRE(right.grid.values.size() == wrong.grid.values.size());
  for (std::size_t i = 0; i < right.grid.values.size(); ++i) {
    REQUIRE(std::abs(right.grid.values[i] - wrong.grid.values[i]) < 1e-6);
  }
}

TEST_CASE("holes do not flip the sign: 5 % of the triangles missing, at most 0.5 % wrong") {
  voml::Mesh mesh = torus(0.4, 120, 60);
  std::mt19937 random(5);
  std::erase_if(mesh.triangles, [&](const glm::uvec3&) { return random() % 20 == 0; });
  for (const voml::Mesh& open : {mesh, inside_out(mesh)}) {
    const Made made = make(open, {.resolution = 48});
    CHECK(made.report.edges.count() > 1000);
    const std::size_t wrong = wrong_signs(made, 1e-3, [](const dvec3& p) { return torus_distance(p, 0.4); });
    CHECK(wrong <= made.grid.values.size() / 200);
  }
}

TEST_CASE("a stray open shell beside a body does not flip it") {
  voml::Mesh sheet{{{-1.5, -1, 1.2}, {1.5, -1, 1.2}, {0, 1.5, 1.2}}, {{0, 1, 2}}};
  const Made made = make(joined(sphere(4), sheet), {.resolution = 40});
  CHECK(made.report.edges.count() == 3);
  CHECK(wrong_signs(made, 5e-3, [](const dvec3& p) { return glm::length(p) - 1.0; }) == 0);
}

TEST_CASE("a shell inside, turned inwards, leaves a cavity; overlapping bodies stay solid") {
  const voml::Mesh cavity = joined(sphere(4), inside_out(transformed(sphere(4), 0.6, dvec3(0))));
  CHECK(wrong_signs(make(cavity, {.resolution = 40}), 5e-3,
                    [](const dvec3& p) { return std::abs(glm::length(p) - 0.8) - 0.2; }) == 0);
  const voml::Mesh overlapping = joined(sphere(4), transformed(sphere(4), 1.0, dvec3(0.9, 0, 0)));
  const Made made = make(overlapping, {.resolution = 40});
  for_each_sample(made.grid, [&](const dvec3& at, double value) {
    const dvec3 p = mesh_point(made.report, at);
    const double first = glm::length(p) - 1.0, second = glm::length(p - dvec3(0.9, 0, 0)) - 1.0;
    if (std::min(std::abs(first), std::abs(second)) > 5e-3) REQUIRE((value < 0.0) == (std::min(first, second) < 0.0));
  });
}

TEST_CASE("any number of threads gives the same bytes") {
  voml::Mesh mesh = torus(0.35, 80, 40);
  for (int closed = 1; closed >= 0; --closed) {
    if (closed == 0) mesh.triangles.resize(mesh.triangles.size() - 40);
    const Made one = make(mesh, {.resolution = 40, .threads = 1});
    for (const unsigned threads : {0u, 2u, 3u, 64u}) {
      CHECK(make(mesh, {.resolution = 40, .threads = threads}).grid.values == one.grid.values);
    }
  }
}

TEST_CASE("a flat mesh has no inside") {
  const voml::Mesh flat{{{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}}, {{0, 1, 2}, {0, 2, 3}}};
  for (const double padding : {0.0, 0.5}) {
    GridReport report;
    const auto grid = authoring::distance_grid(flat, {.resolution = 16, .padding = padding}, report);
    REQUIRE_FALSE(grid.has_value());
    CHECK(grid.error().message == "the mesh has no inside");
    CHECK(report.edges.open.count == 4);
  }
}

TEST_CASE("progress rises to the whole") {
  std::vector<std::size_t> told;
  GridReport report;
  std::size_t slices = 0;
  const auto grid =
      authoring::distance_grid(sphere(2), {.resolution = 20}, report, [&](std::size_t done, std::size_t total) {
        told.push_back(done);
        slices = total;
      });
  REQUIRE(grid);
  REQUIRE(told.size() >= 1);
  CHECK(std::ranges::is_sorted(told));
  CHECK(told.front() > 0);
  CHECK(told.back() == slices);
}

TEST_CASE("what no grid can be made of is refused") {
  const auto refused = [](const voml::Mesh& mesh, const GridOptions& options, std::string_view word) {
    GridReport report;
    const auto grid = authoring::distance_grid(mesh, options, report);
    REQUIRE_FALSE(grid.has_value());
    CAPTURE(grid.error().message);
    CHECK(grid.error().fault == Fault::input);
    CHECK(grid.error().message.find(word) != std::string::npos);
  };
  const voml::Mesh cube = voml::standard_cube();
  refused({}, {}, "no triangle");
  refused({{{1, 2, 3}}, {{0, 0, 0}}}, {}, "too small");
  refused(transformed(cube, 1e-3, dvec3(1e9)), {}, "too small");
  refused(transformed(cube, 1e308, dvec3(0)), {}, "too large");
  refused(transformed(cube, 1e-310, dvec3(0)), {}, "too small");
  refused(transformed(cube, 1e-7, dvec3(0)), {.fit = false}, "too small");
  refused(transformed(cube, 1.01, dvec3(0)), {.fit = false}, "leaves the standard cube");
  refused(transformed(cube, 0.5, dvec3(0, -0.6, 0)), {.fit = false}, "leaves the standard cube");
  refused(cube, {.resolution = 3}, "resolution");
  refused(cube, {.resolution = 513}, "resolution");
  refused(cube, {.padding = -0.1}, "padding");
  refused(cube, {.padding = 1.5}, "padding");
  refused(cube, {.padding = NAN}, "padding");
}

// ---- meshes without inside ----

namespace {

/// A cube of edge 1 made of quads; 1-based corners as OBJ files have them.
voml::Mesh cube_of(const std::vector<std::array<std::uint32_t, 3>>& faces) {
  voml::Mesh mesh;
  for (int i = 0; i < 8; ++i) mesh.positions.emplace_back((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5);
  for (const auto& f : faces) mesh.triangles.emplace_back(f[0] - 1, f[1] - 1, f[2] - 1);
  return mesh;
}

std::vector<std::string> refusal(const voml::Mesh& mesh, const GridOptions& options, const std::string& message) {
  authoring::GridReport report;
  const auto grid = authoring::distance_grid(mesh, options, report);
  REQUIRE_FALSE(grid.has_value());
  CHECK(grid.error().fault == Fault::input);
  CHECK(grid.error().message == message);
  return grid.error().reasons;
}

}  // namespace

TEST_CASE("a cube whose faces are there twice, or wound against each other, has no inside: which edges say so") {
  // Fans of the quads 1 3 4 2, 5 6 8 7, 1 2 6 5, 3 7 8 4, 1 5 7 3, 2 4 8 6, and of the same turned around from another
  // corner.
  const voml::Mesh twice =
      cube_of({{1, 3, 4}, {1, 4, 2}, {5, 6, 8}, {5, 8, 7}, {1, 2, 6}, {1, 6, 5}, {3, 7, 8}, {3, 8, 4},
               {1, 5, 7}, {1, 7, 3}, {2, 4, 8}, {2, 8, 6}, {2, 4, 3}, {2, 3, 1}, {7, 8, 6}, {7, 6, 5},
               {5, 6, 2}, {5, 2, 1}, {4, 8, 7}, {4, 7, 3}, {3, 7, 5}, {3, 5, 1}, {6, 8, 4}, {6, 4, 2}});
  const auto doubled = refusal(twice, {.resolution = 24}, "the mesh has no inside");
  REQUIRE(doubled.size() == 2);  // a cube has 12 edges, each with two faces, each there twice
  CHECK(doubled[0] == "12 edges have more than two triangles, the first from (-0.5 -0.5 -0.5) to (0.5 -0.5 -0.5)");
  CHECK(doubled[1].find("there twice") != std::string::npos);

  const voml::Mesh against = cube_of({{4, 3, 1},
                                      {1, 4, 2},
                                      {8, 6, 5},
                                      {5, 8, 7},
                                      {6, 2, 1},
                                      {1, 6, 5},
                                      {8, 7, 3},
                                      {3, 8, 4},
                                      {7, 5, 1},
                                      {1, 7, 3},
                                      {8, 4, 2},
                                      {2, 8, 6}});
  const auto opposed = refusal(against, {.resolution = 24}, "the mesh has no inside that its faces agree on");
  REQUIRE(opposed.size() == 2);  // 12 edges and 6 diagonals
  CHECK(opposed[0] ==
        "18 edges lie between two triangles wound against each other, the first from (-0.5 -0.5 -0.5) to (0.5 -0.5 "
        "-0.5)");
  CHECK(opposed[1].find("turn all faces outwards") != std::string::npos);
}

TEST_CASE("a sheet has no inside because it is open; a sheet of two sides encloses nothing") {
  const voml::Mesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.1}}, {{0, 1, 2}}};
  const auto open = refusal(sheet, {.resolution = 16}, "the mesh has no inside");
  REQUIRE(open.size() == 2);
  CHECK(open[0] == "3 open edges, with a triangle on one side only, the first from (0 0 0) to (1 0 0)");
  const voml::Mesh two_sides{sheet.positions, {{0, 1, 2}, {0, 2, 1}}};
  CHECK(refusal(two_sides, {.resolution = 16}, "the mesh has no inside") ==
        std::vector<std::string>{"its surface is closed, but encloses no volume"});
}

TEST_CASE("a plate between two layers of samples: refused with a resolution that is enough") {
  // Across it the box, 0.2 high with its padding, has an even number of layers: none in the middle, where the plate is.
  const voml::Mesh plate = box({-1, -1, -0.002}, {1, 1, 0.002});
  const auto reasons = refusal(plate, {.resolution = 20, .padding = 0.1},
                               "no sample of the grid lies inside the mesh, which is thinner than a voxel");
  REQUIRE(reasons.size() == 1);
  const std::string words = "a resolution of ";
  REQUIRE(reasons[0].starts_with(words));
  const auto enough = static_cast<std::uint32_t>(std::stoul(reasons[0].substr(words.size())));
  CHECK(enough > 20);
  CHECK(enough <= 600);  // a voxel of 2 * 1.2 / 600 is as thick as the plate
  CHECK(make(plate, {.resolution = std::min(enough, 512u), .padding = 0.1}).grid.values.size() > 0);
}

}  // namespace dmvv::tests
