#include "authoring/distance_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <new>

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
  if (options.resolution < 4 || options.resolution > 512) {
    return fail(Fault::input, fmt::format("the resolution is {}; it must be 4 to 512", options.resolution));
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

namespace {

// ---- sampling ----

/// Fills a grid slice by slice. Slices do not depend on each other, so any number of threads gives the same values.
class Sampler {
 public:
  Sampler(const TriangleTree& tree, bool closed, voml::Grid& grid)
      : tree_(tree),
        closed_(closed),
        orientation_(tree.signed_volume() < 0.0 ? -1.0 : 1.0),
        step_(step_of(grid)),
        grid_(grid) {}

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
          inside = orientation_ * tree_.winding_number(centre(x, y, z)) > 0.5;
        }
        if (inside) here = 0.0f - here;  // no -0 where the sample lies on the surface
      }
    }
  }

  const TriangleTree& tree_;
  bool closed_;
  double orientation_;  ///< -1 for a mesh that is inside out
  glm::dvec3 step_;
  voml::Grid& grid_;
};

}  // namespace

Result<voml::Grid> distance_grid(const voml::Mesh& mesh, const GridOptions& options, GridReport& report,
                                 const Progress& progress) try {
  const voml::Bounds mesh_box = voml::bounds(mesh);
  if (const Result<void> checked = check(mesh, mesh_box, options); !checked) {
    return tl::unexpected(checked.error());
  }
  const Placement cube_from_mesh = place(mesh_box, options);
  voml::Grid grid =
      empty_grid({cube_from_mesh(mesh_box.lo), cube_from_mesh(mesh_box.hi)}, options.resolution, options.padding);

  std::vector<Corners> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    triangles.push_back({cube_from_mesh(mesh.positions[t.x]), cube_from_mesh(mesh.positions[t.y]),
                         cube_from_mesh(mesh.positions[t.z])});
  }
  const TriangleTree tree(triangles);
  triangles = {};
  report = {voml::count_open_edges(mesh), cube_from_mesh.scale, cube_from_mesh.offset};

  grid.values.resize(std::size_t{grid.size.x} * grid.size.y * grid.size.z);
  Sampler sampler(tree, report.open_edges == 0, grid);
  for_each_slice(
      grid.size.z, options.threads, [&](std::uint32_t z) { sampler.fill_slice(z); }, progress, 0, grid.size.z);
  return grid;
} catch (const std::bad_alloc&) {
  return fail(Fault::environment,
              fmt::format("there is not enough memory for a distance grid of resolution {}", options.resolution),
              {"choose a lower resolution"});
}

}  // namespace dmvv::authoring
