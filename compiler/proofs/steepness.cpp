#include "compiler/proofs/steepness.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/parallel.h"
#include "compiler/grids/grid_bounds.h"
#include "compiler/grids/storage.h"
#include "compiler/proofs/judge.h"
#include "compiler/snippet/time_range.h"

namespace dmvv::compiler {

namespace {

/// The largest length of a gradient in a voxel between samples z and z + 1: there a derivative along an axis lies
/// between the differences along the four edges.
double steepest_voxel(const voml::Grid& grid, const glm::vec3& samples_per_unit, std::size_t z) {
  const std::size_t nx = grid.size.x, ny = grid.size.y, nz = grid.size.z;
  const std::size_t right = nx > 1 ? 1 : 0, up = ny > 1 ? nx : 0, back = z + 1 < nz ? nx * ny : 0;
  const auto difference = [&](const float* v, std::size_t along, std::size_t a, std::size_t b) {
    const auto edge = [&](std::size_t offset) { return std::abs(v[offset + along] - v[offset]); };
    return std::max(std::max(edge(0), edge(a)), std::max(edge(b), edge(a + b)));
  };
  float steepest = 0.0f;
  for (std::size_t y = 0; y + (ny > 1 ? 1 : 0) < ny; ++y) {
    const float* row = grid.values.data() + (z * ny + y) * nx;
    for (std::size_t x = 0; x + right < nx; ++x) {
      const glm::vec3 g = glm::vec3(difference(row + x, right, up, back), difference(row + x, up, right, back),
                                    difference(row + x, back, right, up)) *
                          samples_per_unit;
      steepest = std::max(steepest, glm::dot(g, g));
    }
  }
  return std::sqrt(static_cast<double>(steepest)) * (1.0 + 1e-5);  // computed in float
}

constexpr snippet::Steepness unknown{std::numeric_limits<double>::infinity(), 0.0};

snippet::Steepness grid_steepness(const voml::Grid& grid, TexelFormat format, Filter filter) {
  if (format != TexelFormat::r32f) return unknown;  // rounded texels make other slopes
  const GridBounds bounds = grid_bounds(grid);
  const glm::dvec3 samples_per_unit = glm::dvec3(grid.size) / (grid.box_hi - grid.box_lo);
  const double slack = filter_error(bounds, bounds.magnitude, format, filter);
  const double lookup = glm::dot(bounds.slope, sample_error(grid, glm::dvec3(0.0)));
  if (filter == Filter::tricubic) {
    return {tricubic_slope * glm::length(bounds.slope * samples_per_unit), slack + tricubic_slope * lookup};
  }
  std::vector<double> steepest(std::max(grid.size.z, 2u) - 1);
  in_parallel(steepest.size(), [&](std::size_t z) { steepest[z] = steepest_voxel(grid, samples_per_unit, z); });
  return {*std::ranges::max_element(steepest), slack + lookup};
}

}  // namespace

std::vector<snippet::Steepness> source_steepness(const Module& module, TexelFormat format, Filter filter) {
  std::vector<snippet::Steepness> of_grids, of_functions, of_sdfs;
  for (const voml::Grid& grid : module.grids) of_grids.push_back(grid_steepness(grid, format, filter));
  for (const Function& function : module.functions) {
    of_functions.push_back(function.snippet.steepness({glm::dvec3(-1.0), glm::dvec3(1.0)}, {-longest_ms, longest_ms}));
  }
  for (const Sdf& sdf : module.sdfs) {
    const auto* function = std::get_if<Id<Function>>(&sdf.source);
    of_sdfs.push_back(function ? of_functions[function->index] : of_grids[std::get<Id<voml::Grid>>(sdf.source).index]);
  }
  return of_sdfs;
}

}  // namespace dmvv::compiler
