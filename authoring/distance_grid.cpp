#include "authoring/distance_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <new>

#include "authoring/boundary.h"
#include "authoring/slices.h"
#include "authoring/triangle_tree.h"

namespace dmvv::authoring {

namespace {

constexpr double cube_side = 2.0;

// ---- where the samples stand ----

/// cube = scale * mesh + offset.
struct Placement {
  double scale = 1.0;
  glm::dvec3 offset{0.0};
  glm::dvec3 operator()(const glm::dvec3& p) const { return scale * p + offset; }
};

double longest_side(const voml::Bounds& box) {
  const glm::dvec3 side = box.hi - box.lo;
  return std::max({side.x, side.y, side.z});
}

Result<void> check(const voml::Mesh& mesh, const voml::Bounds& mesh_box, const GridOptions& options) {
  if (options.resolution < 4 || options.resolution > max_grid_resolution) {
    return fail(Fault::input,
                fmt::format("the resolution is {}; it must be 4 to {}", options.resolution, max_grid_resolution));
  }
  if (!(options.padding >= 0.0 && options.padding <= 1.0)) {
    return fail(Fault::input, fmt::format("the padding is {}; it must be 0 to 1", options.padding));
  }
  if (mesh.triangles.empty()) return fail(Fault::input, "the mesh has no triangle");
  const double longest = longest_side(mesh_box);
  const glm::dvec3 farthest = glm::max(glm::abs(mesh_box.lo), glm::abs(mesh_box.hi));
  const double largest = std::max({farthest.x, farthest.y, farthest.z});
  const double smallest = options.fit ? 1e-9 * largest : 1e-5;  // coordinates below are mostly rounding
  if (!std::isfinite(longest)) {
    return fail(Fault::input, fmt::format("the mesh is too large: its largest coordinate is {}", largest));
  }
  if (!(longest > smallest) || !std::isfinite(cube_side / longest)) {
    return fail(Fault::input, fmt::format("the mesh is too small: its longest side is {}, its largest coordinate {}",
                                          longest, largest));
  }
  if (options.fit) return {};
  if (glm::any(glm::lessThan(mesh_box.lo, glm::dvec3(-1.0))) ||
      glm::any(glm::greaterThan(mesh_box.hi, glm::dvec3(1.0)))) {
    return fail(Fault::input, "the mesh leaves the standard cube [-1,1]^3",
                {fmt::format("it spans ({}, {}, {}) to ({}, {}, {})", mesh_box.lo.x, mesh_box.lo.y, mesh_box.lo.z,
                             mesh_box.hi.x, mesh_box.hi.y, mesh_box.hi.z),
                 "let it be fitted to the cube"});
  }
  return {};
}

Placement place(const voml::Bounds& mesh_box, const GridOptions& options) {
  if (!options.fit) return {};
  const double scale = cube_side / (longest_side(mesh_box) * (1.0 + 2.0 * options.padding));
  return {scale, -scale * (mesh_box.lo + 0.5 * (mesh_box.hi - mesh_box.lo))};
}

enum class Round : std::uint8_t { down, up };

/// The nearest cube coordinate that an LXN file can hold: float32 in the unit cube.
double storable(double c, Round round) {
  const double unit = 0.5 * (c + 1.0);
  float stored = static_cast<float>(unit);
  if (round == Round::down && stored > unit) stored = std::nextafter(stored, 0.0f);
  if (round == Round::up && stored < unit) stored = std::nextafter(stored, 1.0f);
  return 2.0 * stored - 1.0;
}

}  // namespace

voml::Grid empty_grid(const voml::Bounds& box, std::uint32_t resolution, double padding) {
  const double border = padding * longest_side(box);
  const glm::dvec3 lo = glm::max(box.lo - border, -1.0), hi = glm::min(box.hi + border, 1.0);
  const double voxel = longest_side({lo, hi}) / resolution;

  voml::Grid grid;
  for (int axis = 0; axis < 3; ++axis) {
    // Whole voxels: the box grows on both sides, and is pushed back where it would leave the cube.
    constexpr double rounding = 1e-9;
    grid.size[axis] = std::max(1u, static_cast<std::uint32_t>(std::ceil((hi[axis] - lo[axis]) / voxel - rounding)));
    const double length = grid.size[axis] * voxel;
    const double begin = std::clamp(0.5 * (lo[axis] + hi[axis] - length), -1.0, std::max(-1.0, 1.0 - length));
    grid.box_lo[axis] = storable(begin, Round::down);
    grid.box_hi[axis] = storable(std::min(begin + length, 1.0), Round::up);
  }
  return grid;
}

// ---- what is told ----

std::string resolution_needed_text(std::uint32_t resolution) {
  if (resolution == 0) {
    return fmt::format("not even a resolution of {} would keep 99 % of the boundary: make thin parts thicker",
                       finest_resolution_tried);
  }
  const bool too_fine = resolution > max_grid_resolution;
  return fmt::format(
      "a resolution of {} would keep 99 % of the boundary{}", resolution,
      too_fine ? fmt::format("; a grid can have {}: make thin parts thicker, or split the mesh", max_grid_resolution)
               : "");
}

namespace {

// ---- sampling ----

constexpr double accuracy_of_signs = 2.0;  // of winding numbers

/// Fills a grid slice by slice. Slices do not depend on each other, so any number of threads gives the same values.
class Sampler {
 public:
  Sampler(const TriangleTree& tree, const Solid& solid, bool closed, voml::Grid& grid)
      : tree_(tree), solid_(solid), closed_(closed), step_(step_of(grid)), grid_(grid) {}

  void fill_slice(std::uint32_t z) {
    fill_distances(z);
    fill_signs(z);
  }

 private:
  float& value(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return grid_.values[(std::size_t{z} * grid_.size.y + y) * grid_.size.x + x];
  }
  glm::dvec3 centre(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return grid_.box_lo + (glm::dvec3(x, y, z) + 0.5) * step_;
  }

  void fill_distances(std::uint32_t z) {
    TriangleTree::Index start_of_row = 0;
    for (std::uint32_t y = 0; y < grid_.size.y; ++y) {
      TriangleTree::Index nearest = start_of_row;
      for (std::uint32_t x = 0; x < grid_.size.x; ++x) {
        value(x, y, z) = static_cast<float>(tree_.distance(centre(x, y, z), nearest));
        if (x == 0) start_of_row = nearest;
      }
    }
  }

  /// The open balls around two samples hold no surface. Where they meet, a closed mesh winds around both alike.
  bool same_side(float distance, float neighbour, double step) const {
    constexpr double rounding = 1e-6;  // of float32 distances up to the cube's diagonal
    return closed_ && std::abs(distance) + std::abs(neighbour) > step + rounding;
  }

  void fill_signs(std::uint32_t z) {
    for (std::uint32_t y = 0; y < grid_.size.y; ++y) {
      for (std::uint32_t x = 0; x < grid_.size.x; ++x) {
        float& here = value(x, y, z);
        bool inside;
        if (x > 0 && same_side(here, value(x - 1, y, z), step_.x)) {
          inside = value(x - 1, y, z) < 0.0f;
        } else if (y > 0 && same_side(here, value(x, y - 1, z), step_.y)) {
          inside = value(x, y - 1, z) < 0.0f;
        } else {
          inside = solid_.holds(centre(x, y, z), accuracy_of_signs);
        }
        if (inside) here = 0.0f - here;  // no -0 where the sample lies on the surface
      }
    }
  }

  const TriangleTree& tree_;
  const Solid& solid_;
  bool closed_;
  glm::dvec3 step_;
  voml::Grid& grid_;
};

// ---- a mesh of which no sample is inside ----

std::vector<std::string> why_no_inside(const voml::EdgeFaults& edges) {
  std::vector<std::string> reasons = voml::describe(edges);
  if (edges.opposed.count != 0)
    reasons.emplace_back("turn all faces outwards; mesh editors call it recalculating normals");
  if (edges.crowded.count != 0) {
    reasons.emplace_back("faces that are there twice, back to back, enclose nothing: leave one of each pair");
  }
  if (edges.open.count != 0) reasons.emplace_back("the surface is open: close it, or give the sheet a thickness");
  if (edges.count() == 0) reasons.emplace_back("its surface is closed, but encloses no volume");
  return reasons;
}

/// Why the grid of this shape got no sample inside: the mesh has no inside, or is too thin.
tl::unexpected<Error> nothing_inside(const Solid& solid, const voml::Grid& grid, const voml::Bounds& box,
                                     const GridOptions& options, const voml::EdgeFaults& edges) {
  constexpr std::size_t points = 20000;
  const glm::dvec3 step = step_of(grid);
  double bounding_nothing = 0.0;
  const auto boundary = solid.boundary(points, 1e-4 * std::min({step.x, step.y, step.z}), bounding_nothing);
  const bool wound_wrongly = edges.opposed.count != 0;
  if (boundary.empty() || wound_wrongly) return fail(Fault::input, "the mesh has no inside", why_no_inside(edges));
  const auto value = [&](const glm::dvec3& p) { return solid.signed_distance(p, accuracy_of_signs); };
  const std::uint32_t enough = resolution_that_keeps_most(box, options.padding, options.resolution, value, boundary);
  std::vector<std::string> reasons = voml::describe(edges);
  reasons.push_back(resolution_needed_text(enough));
  return fail(Fault::input, "no sample of the grid lies inside the mesh, which is thinner than a voxel",
              std::move(reasons));
}

}  // namespace

Result<voml::Grid> distance_grid(const voml::Mesh& mesh, const GridOptions& options, GridReport& report,
                                 const Progress& progress) try {
  const voml::Bounds mesh_box = voml::bounds(mesh);
  if (const Result<void> checked = check(mesh, mesh_box, options); !checked) {
    return tl::unexpected(checked.error());
  }
  const Placement cube_from_mesh = place(mesh_box, options);
  const voml::Bounds box{cube_from_mesh(mesh_box.lo), cube_from_mesh(mesh_box.hi)};
  voml::Grid grid = empty_grid(box, options.resolution, options.padding);

  std::vector<Corners> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    triangles.push_back({cube_from_mesh(mesh.positions[t.x]), cube_from_mesh(mesh.positions[t.y]),
                         cube_from_mesh(mesh.positions[t.z])});
  }
  const TriangleTree tree(triangles);
  triangles = {};
  report = {voml::find_edge_faults(mesh), options.padding, cube_from_mesh.scale, cube_from_mesh.offset};

  if (4 * report.edges.opposed.count > report.edges.edges) {
    return fail(Fault::input, "the mesh has no inside that its faces agree on", why_no_inside(report.edges));
  }
  grid.values.resize(std::size_t{grid.size.x} * grid.size.y * grid.size.z);
  const Solid solid(tree);
  Sampler sampler(tree, solid, report.edges.count() == 0, grid);
  for_each_slice(
      grid.size.z, options.threads, [&](std::uint32_t z) { sampler.fill_slice(z); }, progress, 0, grid.size.z);
  if (std::ranges::any_of(grid.values, [](float value) { return value < 0.0f; })) return grid;
  grid.values.clear();
  return nothing_inside(solid, grid, box, options, report.edges);
} catch (const std::bad_alloc&) {
  return fail(Fault::environment,
              fmt::format("there is not enough memory for a distance grid of resolution {}", options.resolution),
              {"choose a lower resolution"});
}

}  // namespace dmvv::authoring
