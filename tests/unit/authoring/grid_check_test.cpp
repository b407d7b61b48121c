#include "authoring/grid_check.h"

#include "tests/unit/authoring/scene_fields.h"
#include "tests/unit/authoring/shapes.h"

namespace dmvv::test {

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
  // Beside a face the distance is linear: only near edges does the interpolant differ, by less than their distance there.
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
  const std::size_t middle = (std::size_t{grid.size.z / 2} * grid.size.y + grid.size.y / 2) * grid.size.x + grid.size.x / 2;
  grid.values[middle] = 1.0f;
  const GridCheck hole = check_grid(grid, mesh, report, 60000);
  CHECK(hole.between->greatest > 0.5);
  CHECK(glm::length(hole.between->where) < 3.0 * hole.voxel);
  CHECK(hole.wrong_side.greatest > 0.5);
}

TEST_CASE("walls inside a solid bound nothing") {
  // A sphere whose centre is 0.9 from another's: of each, the cap of height 1 - 0.45 lies inside the other, 27.5 % of it.
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
  const GridCheck honest = check_grid(grid, field, false, 2000);
  // Trilinear interpolation of a distance whose second derivatives are 2 along two directions: h^2 / 8 * (2 + 2) at most.
  CHECK(honest.surface.points > 500);
  CHECK(honest.surface.greatest < 0.5 * honest.voxel * honest.voxel * 1.2);
  for (float& value : grid.values) value += 0.07f;
  const GridCheck shifted = check_grid(grid, field, false, 2000);
  CHECK(shifted.samples->greatest == doctest::Approx(0.07).epsilon(1e-4));  // the field's units
  CHECK(shifted.surface.greatest == doctest::Approx(0.01).epsilon(0.2));    // units of the cube
  CHECK(shifted.surface.greatest >= 0.01);
  CHECK(shifted.wrong_side.greatest <= 0.0125);

  const auto distances = authoring::bake(field, {.resolution = 48, .distance = true}, report);
  REQUIRE(distances.has_value());
  const GridCheck check = check_grid(*distances, field, true, 2000);
  CHECK_FALSE(check.samples);
  CHECK_FALSE(check.between);
  CHECK(check.surface.greatest < honest.voxel * honest.voxel);
}

}  // namespace dmvv::test
