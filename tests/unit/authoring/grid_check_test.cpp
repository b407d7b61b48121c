#include "authoring/grid_check.h"

#include "tests/unit/authoring/scene_fields.h"
#include "tests/unit/authoring/shapes.h"

namespace dmvv::tests {

namespace {

using authoring::check_grid;
using authoring::GridCheck;
using authoring::GridReport;

voml::Grid grid_of(const voml::Mesh& mesh, std::uint32_t resolution, GridReport& report) {
  auto grid = authoring::distance_grid(mesh, {.resolution = resolution, .padding = 0.2}, report);
  REQUIRE(grid.has_value());
  return std::move(*grid);
}

}  // namespace

TEST_CASE("the check of a box's grid: none at samples, half a voxel's corner at most at its edges") {
  GridReport report;
  const voml::Mesh mesh = box({0, 0, 0}, {2, 1, 1});
  const voml::Grid grid = grid_of(mesh, 48, report);
  const GridCheck check = check_grid(grid, mesh, report, 4000);
  CHECK(check.voxel == doctest::Approx(2.0 / 48).epsilon(1e-5));
  REQUIRE(check.samples);
  REQUIRE(check.between);
  CHECK(check.samples->points == 4000);
  CHECK(check.samples->greatest < 1.2e-7);
  CHECK(check.surface.points == 4000);
  // Beside a face the distance is linear: only near edges does the interpolant differ, by less than their distance
  // there.
  CHECK(check.surface.greatest < 0.87 * check.voxel);
  CHECK(check.surface.greatest > 0.1 * check.voxel);
  CHECK(check.surface.root_mean_square < 0.3 * check.surface.greatest);
  const glm::dvec3 corner = report.cube_from_mesh_scale * glm::dvec3(1, 0.5, 0.5);
  glm::dvec3 from_edges = glm::abs(glm::abs(check.surface.where) - corner);
  if (from_edges.x > from_edges.y) std::swap(from_edges.x, from_edges.y);
  if (from_edges.y > from_edges.z) std::swap(from_edges.y, from_edges.z);
  if (from_edges.x > from_edges.y) std::swap(from_edges.x, from_edges.y);
  CHECK(from_edges.y < check.voxel);  // the worst place is near an edge: two coordinates are those of faces
  CHECK(check.wrong_side.greatest < check.voxel);
  CHECK(check.bounding_nothing == 0.0);
}

TEST_CASE("the check finds what was done to a grid") {
  GridReport report;
  const voml::Mesh mesh = sphere(4);
  voml::Grid grid = grid_of(mesh, 32, report);
  const double honest = check_grid(grid, mesh, report, 2000).surface.greatest;

  voml::Grid shifted = grid;
  for (float& value : shifted.values) value += 0.02f;
  const GridCheck check = check_grid(shifted, mesh, report, 2000);
  CHECK(check.samples->greatest == doctest::Approx(0.02).epsilon(1e-4));
  CHECK(check.samples->root_mean_square == doctest::Approx(0.02).epsilon(1e-4));
  CHECK(check.surface.greatest >= 0.02);
  CHECK(check.surface.greatest <= 0.02 + honest);
  // Points within 0.02 of the surface have changed sides, and about as many as that shell has of the volume.
  CHECK(check.wrong_side.points > 20);
  CHECK(check.wrong_side.greatest <= 0.02 + honest);
  CHECK(check.wrong_side.greatest > 0.015);

  // One sample far inside turned positive: between samples it shows around that sample alone.
  const std::size_t middle =
      (std::size_t{grid.size.z / 2} * grid.size.y + grid.size.y / 2) * grid.size.x + grid.size.x / 2;
  grid.values[middle] = 1.0f;
  const GridCheck hole = check_grid(grid, mesh, report, 60000);
  CHECK(hole.between->greatest > 0.5);
  CHECK(glm::length(hole.between->where) < 3.0 * hole.voxel);
  CHECK(hole.wrong_side.greatest > 0.5);
}

TEST_CASE("walls inside a solid bound nothing") {
  // A sphere whose centre is 0.9 from another's: of each, the cap of height 1 - 0.45 lies inside the other, 27.5 % of
  // it.
  const voml::Mesh mesh = joined(sphere(4), transformed(sphere(4), 1.0, dvec3(0.9, 0, 0)));
  GridReport report;
  const voml::Grid grid = grid_of(mesh, 32, report);
  const GridCheck check = check_grid(grid, mesh, report, 4000);
  CHECK(check.bounding_nothing == doctest::Approx(0.275).epsilon(0.1));
  CHECK(check.surface.points + std::lround(check.bounding_nothing * 4000) == 4000);
  CHECK(check.surface.greatest < check.voxel);
}

TEST_CASE("a field's own values: the surface's error is a length, whatever the field's slope") {
  const compiler::Module module = module_of(scene_of(function("return 7.0 * (length(p) - 0.5);")));
  const authoring::Field field = field_of(module);
  authoring::BakeReport report;
  const auto baked = authoring::bake(field, {.resolution = 48}, report);
  REQUIRE(baked.has_value());
  voml::Grid grid = *baked;
  const GridCheck honest = check_grid(grid, field, {.resolution = 48, .distance = false}, 2000);
  // Trilinear interpolation of a distance whose second derivatives are 2 along two directions: h^2 / 8 * (2 + 2) at
  // most.
  CHECK(honest.surface.points > 500);
  CHECK(honest.surface.greatest < 0.5 * honest.voxel * honest.voxel * 1.2);
  for (float& value : grid.values) value += 0.07f;
  const GridCheck shifted = check_grid(grid, field, {.resolution = 48, .distance = false}, 2000);
  CHECK(shifted.samples->greatest == doctest::Approx(0.07).epsilon(1e-4));  // the field's units
  CHECK(shifted.surface.greatest == doctest::Approx(0.01).epsilon(0.2));    // units of the cube
  CHECK(shifted.surface.greatest >= 0.01);
  CHECK(shifted.wrong_side.greatest <= 0.0125);

  const auto distances = authoring::bake(field, {.resolution = 48, .distance = true}, report);
  REQUIRE(distances.has_value());
  const GridCheck check = check_grid(*distances, field, {.resolution = 48, .distance = true}, 2000);
  CHECK_FALSE(check.samples);
  CHECK_FALSE(check.between);
  CHECK(check.surface.greatest < honest.voxel * honest.voxel);
}

// ---- what a grid cannot hold ----

namespace {

voml::Mesh turned(voml::Mesh mesh) {
  // Turned so that no axis of the grid is special: by 0.4 about x, then 0.7 about z.
  for (dvec3& p : mesh.positions) {
    p = {p.x, std::cos(0.4) * p.y - std::sin(0.4) * p.z, std::sin(0.4) * p.y + std::cos(0.4) * p.z};
    p = {std::cos(0.7) * p.x - std::sin(0.7) * p.y, std::sin(0.7) * p.x + std::cos(0.7) * p.y, p.z};
  }
  return mesh;
}

}  // namespace

TEST_CASE("what is thick loses no boundary: a ball, a box with its edges, a torus") {
  for (const voml::Mesh& mesh :
       {sphere(4), box({0, 0, 0}, {2, 1, 1}), torus(0.4, 60, 30), turned(box({0, 0, 0}, {2, 1, 1}))}) {
    GridReport report;
    const voml::Grid grid = grid_of(mesh, 24, report);
    const GridCheck check = check_grid(grid, mesh, report, 4000);
    CHECK(check.boundary_lost == 0.0);
    CHECK_FALSE(check.resolution_needed);
  }
}

TEST_CASE(
    "a plate beside a block: the plate's share of the area is lost, and the resolution that is told has samples in "
    "it") {
  // The block keeps the plate's grid from being refused. Areas: the block's 6 * 0.5^2 = 1.5; the plate's 2 * 1 = 2 and
  // its rim.
  const double thick = 0.01;
  const voml::Mesh mesh =
      joined(box({-0.25, -0.25, 0.6}, {0.25, 0.25, 1.1}), box({-0.5, -0.5, -thick / 2}, {0.5, 0.5, thick / 2}));
  GridReport report;
  const voml::Grid grid = grid_of(mesh, 30, report);
  const auto half_in = [&](const voml::Grid& g, const GridReport& r, double z) {
    for (std::uint32_t i = 0; i < g.size.z; ++i) {
      const double at = g.box_lo.z + (i + 0.5) / g.size.z * (g.box_hi.z - g.box_lo.z);
      if (std::abs((at - r.cube_from_mesh_offset.z) / r.cube_from_mesh_scale - z) < thick / 2) return true;
    }
    return false;
  };
  REQUIRE_FALSE(half_in(grid, report, 0.0));
  const GridCheck check = check_grid(grid, mesh, report, 8000);
  const double plate = 2.0 + 4.0 * thick;
  CHECK(check.boundary_lost == doctest::Approx(plate / (plate + 1.5)).epsilon(0.03));
  REQUIRE(check.resolution_needed);
  const std::uint32_t enough = *check.resolution_needed;
  REQUIRE(enough <= 512);
  GridReport finer_report;
  const voml::Grid finer = grid_of(mesh, enough, finer_report);
  CHECK(half_in(finer, finer_report, 0.0));
  CHECK(check_grid(finer, mesh, finer_report, 8000).boundary_lost <= 0.012);
  // Voxels as thick as the plate, 1.105 * 1.4 / 0.01 = 155 of them, have a layer in it; a sixteenth of a voxel of it is
  // needed to be seen, and the search stops within 3 % of the least.
  CHECK(enough <= 180);
}

TEST_CASE("a plate across no axis: kept from where the voxel is a share of its thickness on") {
  // Where the plate passes the middle of a cell, the interpolation is the mean of its corners' distances from the
  // plate's middle, 0.43 to 0.5 voxel by the plate's direction, less half the thickness: negative for voxels of 1
  // to 1.15 of that.
  const double thick = 0.04;
  const voml::Mesh mesh =
      turned(joined(box({-0.25, -0.25, 0.6}, {0.25, 0.25, 1.1}), box({-0.5, -0.5, -thick / 2}, {0.5, 0.5, thick / 2})));
  GridReport report;
  const voml::Grid coarse = grid_of(mesh, 24, report);
  const GridCheck check = check_grid(coarse, mesh, report, 8000);
  CHECK(check.boundary_lost > 0.1);
  REQUIRE(check.resolution_needed);
  const double voxel = 2.0 / *check.resolution_needed / report.cube_from_mesh_scale;  // in the mesh's units
  CHECK(voxel < 1.4 * thick);  // a little more, as a voxel around each point is looked at
  CHECK(voxel > 0.7 * thick);
  GridReport finer_report;
  const voml::Grid finer = grid_of(mesh, *check.resolution_needed, finer_report);
  CHECK(check_grid(finer, mesh, finer_report, 8000).boundary_lost <= 0.012);
}

TEST_CASE("a needle that leaves a ball") {
  // Across: 0.02 by 0.02, of length 1 beyond the ball: an area of 0.08 beside the ball's 4 pi 0.09.
  const double across = 0.02;
  const voml::Mesh mesh = turned(joined(transformed(sphere(4), 0.3, dvec3(0)),
                                        box({0.0, -across / 2, -across / 2}, {1.3, across / 2, across / 2})));
  GridReport report;
  const voml::Grid grid = grid_of(mesh, 40, report);
  const GridCheck check = check_grid(grid, mesh, report, 8000);
  const double needle = 4.0 * across, ball = 4.0 * 3.14159265 * 0.09;
  CHECK(check.boundary_lost > 0.5 * needle / (needle + ball));
  CHECK(check.boundary_lost < 1.1 * needle / (needle + ball));
  REQUIRE(check.resolution_needed);
  GridReport finer_report;
  const voml::Grid finer = grid_of(mesh, *check.resolution_needed, finer_report);
  CHECK(check_grid(finer, mesh, finer_report, 8000).boundary_lost <= 0.012);
}

TEST_CASE("a field's thin parts: found between the steps of a line, and told like a mesh's") {
  const std::string body =
      "vec3 q = abs(p - vec3(0.0, 0.0, 0.6)) - 0.2; float block = max(q.x, max(q.y, q.z));\n"
      "return min(block, max(abs(p.z - 0.013) - 0.004, max(abs(p.x), abs(p.y)) - 0.5));";
  const compiler::Module module = module_of(scene_of(function(body)));
  const authoring::Field field = field_of(module);
  authoring::BakeReport report;
  const authoring::BakeOptions options{.resolution = 24};
  const auto grid = authoring::bake(field, options, report);
  REQUIRE(grid.has_value());
  const GridCheck check = check_grid(*grid, field, options, 4000);
  const double plate = 2.0 + 4.0 * 0.008, block = 6.0 * 0.16;
  CHECK(check.boundary_lost == doctest::Approx(plate / (plate + block)).epsilon(0.06));
  REQUIRE(check.resolution_needed);
  const authoring::BakeOptions finer{.resolution = *check.resolution_needed};
  const auto better = authoring::bake(field, finer, report);
  REQUIRE(better.has_value());
  CHECK(check_grid(*better, field, finer, 4000).boundary_lost <= 0.013);
}

TEST_CASE("a field so thin that no sample is inside is refused") {
  const compiler::Module module = module_of(scene_of(function("return abs(p.z - 0.0123) - 0.001;")));
  authoring::BakeReport report;
  const auto grid = authoring::bake(field_of(module), {.resolution = 16, .padding = 0.5}, report);
  REQUIRE_FALSE(grid.has_value());
  CHECK(grid.error().message == "no sample of the grid lies inside the SDF, which is thinner than a voxel");
}

}  // namespace dmvv::tests
