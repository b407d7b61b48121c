// A real scan: 100,002 triangles, closed, of genus 2 (its README). Prints the time that its grid takes.
#include <doctest/doctest.h>

#include <chrono>
#include <random>

#include "authoring/distance_grid.h"
#include "base/files.h"
#include "tests/unit/authoring/shapes.h"

namespace dmvv::tests {

namespace {

voml::Mesh read_skull() {
  const auto bytes = disk_files()(DMVV_SKULL, 1u << 30);
  REQUIRE(bytes.has_value());
  Diagnostics diagnostics;
  auto mesh = voml::parse_mesh(DMVV_SKULL, *bytes, diagnostics);
  INFO(diagnostics.render());
  REQUIRE(mesh.has_value());
  return std::move(*mesh);
}

voml::Grid make(const voml::Mesh& mesh, authoring::GridReport& report) {
  const auto start = std::chrono::steady_clock::now();
  auto grid = authoring::distance_grid(mesh, {.resolution = 64}, report);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  REQUIRE(grid.has_value());
  MESSAGE(grid->size.x, " x ", grid->size.y, " x ", grid->size.z, " samples, ", report.edges.count(),
          " open edges: ", 1e3 * taken.count(), " ms");
  return std::move(*grid);
}

}  // namespace

TEST_CASE("the skull's grid agrees with brute force, with the known volume, and with itself when holes are torn") {
  const voml::Mesh mesh = read_skull();
  CHECK(mesh.positions.size() == 49999);
  CHECK(mesh.triangles.size() == 100002);
  authoring::GridReport report;
  const voml::Grid grid = make(mesh, report);
  CHECK(report.edges.count() == 0);

  const voml::Mesh placed = transformed(mesh, report.cube_from_mesh_scale, report.cube_from_mesh_offset);
  const std::vector<authoring::Corners> triangles = corners_of(placed);
  const dvec3 voxel = (grid.box_hi - grid.box_lo) / dvec3(grid.size);
  std::mt19937 random(3);
  double worst = 0.0, inside = 0.0;
  std::size_t checked = 0, wrong = 0;
  for_each_sample(grid, [&](const dvec3& p, double value) {
    inside += value < 0.0 ? 1.0 : 0.0;
    const bool near_surface = std::abs(value) < voxel.x;
    if (random() % (near_surface ? 200 : 1000) != 0) return;
    ++checked;
    worst = std::max(worst, std::abs(std::abs(value) - distance(p, triangles)));
    wrong += (value < 0.0) != (winding_number(p, triangles) > 0.5) ? 1 : 0;
  });
  MESSAGE(checked, " samples against brute force: largest error ", worst);
  CHECK(checked > 100);
  CHECK(worst < 1e-7);
  CHECK(wrong == 0);

  const double scale = report.cube_from_mesh_scale;
  CHECK(inside * voxel.x * voxel.y * voxel.z / (scale * scale * scale) == doctest::Approx(563.4).epsilon(0.005));

  voml::Mesh torn = mesh;
  std::erase_if(torn.triangles, [&](const glm::uvec3&) { return random() % 20 == 0; });
  const voml::Grid torn_grid = make(torn, report);
  CHECK(report.edges.count() > 10000);
  REQUIRE(torn_grid.size == grid.size);  // the outermost vertices are still in use
  std::size_t flipped = 0;
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    flipped += (grid.values[i] < 0.0f) != (torn_grid.values[i] < 0.0f) ? 1 : 0;
  }
  MESSAGE("torn: ", 100.0 * static_cast<double>(flipped) / static_cast<double>(grid.values.size()), " % flipped");
  CHECK(flipped <= grid.values.size() / 200);
}

}  // namespace dmvv::tests
