#include "authoring/bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <new>
#include <utility>

#include "authoring/slices.h"
#include "authoring/triangle_tree.h"

namespace dmvv::authoring {

namespace {

Result<void> check(const BakeOptions& options) {
  if (options.resolution < 4 || options.resolution > 512) {
    return fail(Fault::input, fmt::format("the resolution is {}; it must be 4 to 512", options.resolution));
  }
  if (!(options.padding >= 0.0 && options.padding <= 1.0)) {
    return fail(Fault::input, fmt::format("the padding is {}; it must be 0 to 1", options.padding));
  }
  return {};
}

/// A positive number as float32. Zero would count as inside.
float above_zero(double value) { return std::max(static_cast<float>(value), std::numeric_limits<float>::min()); }

// ---- the boundary, as triangles ----

/// The field at the samples of a grid and, beyond it, at one more on every side.
struct Lattice {
  glm::dvec3 origin, step;
  glm::uvec3 size{0};
  std::vector<float> values;

  std::size_t index(const glm::uvec3& at) const { return (std::size_t{at.z} * size.y + at.y) * size.x + at.x; }
  bool inside(const glm::uvec3& at) const { return values[index(at)] <= 0.0f; }
  glm::dvec3 place(const glm::uvec3& at) const { return origin + glm::dvec3(at) * step; }
};

/// Finds the boundary between a point inside and one outside.
glm::dvec3 bisect(const Field& field, glm::dvec3 in, glm::dvec3 out) {
  constexpr int halvings = 40;
  for (int i = 0; i < halvings; ++i) {
    const glm::dvec3 middle = 0.5 * (in + out);
    (field(middle) <= 0.0 ? in : out) = middle;
  }
  return 0.5 * (in + out);
}

/// The point of the boundary that is met first from `p` along the field's gradient, if that is within `reach`.
std::optional<glm::dvec3> along_gradient(const Field& field, const glm::dvec3& p, double reach) {
  const double h = 0.01 * reach;
  const glm::dvec3 gradient(field(p + glm::dvec3(h, 0, 0)) - field(p - glm::dvec3(h, 0, 0)),
                            field(p + glm::dvec3(0, h, 0)) - field(p - glm::dvec3(0, h, 0)),
                            field(p + glm::dvec3(0, 0, h)) - field(p - glm::dvec3(0, 0, h)));
  const double length = glm::length(gradient);
  if (!(length > 0.0 && std::isfinite(length))) return std::nullopt;
  const bool inside = field(p) <= 0.0;
  const glm::dvec3 outwards = gradient / length;
  glm::dvec3 last = p;
  for (const double share : {0.05, 0.2, 0.5, 1.0}) {
    const glm::dvec3 next = p + (inside ? share : -share) * reach * outwards;
    if ((field(next) <= 0.0) != inside) return inside ? bisect(field, last, next) : bisect(field, next, last);
    last = next;
  }
  return std::nullopt;
}

/// The corner that the boundary's triangles have in a cell with samples on both sides.
glm::dvec3 corner_in_cell(const Field& field, const Lattice& lattice, const glm::uvec3& cell) {
  glm::dvec3 sum(0.0), in(0.0), out(0.0);
  int crossings = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::uint32_t edge = 0; edge < 4; ++edge) {
      glm::uvec3 a = cell;
      a[(axis + 1) % 3] += edge & 1;
      a[(axis + 2) % 3] += edge >> 1;
      glm::uvec3 b = a;
      b[axis] += 1;
      if (lattice.inside(a) == lattice.inside(b)) continue;
      const double va = lattice.values[lattice.index(a)], vb = lattice.values[lattice.index(b)];
      const double t = va / (va - vb);
      sum += glm::mix(lattice.place(a), lattice.place(b), std::isfinite(t) ? t : 0.5);
      ++crossings;
      in = lattice.place(lattice.inside(a) ? a : b);
      out = lattice.place(lattice.inside(a) ? b : a);
    }
  }
  const glm::dvec3 mean = sum / static_cast<double>(crossings);
  const double voxel = std::min({lattice.step.x, lattice.step.y, lattice.step.z});
  if (const auto found = along_gradient(field, mean, voxel)) return *found;
  return bisect(field, in, out);
}

/// The corners in one slice of cells, by the cell's number in the slice, ascending.
using SliceCorners = std::vector<std::pair<std::uint32_t, glm::dvec3>>;

SliceCorners corners_in_slice(const Field& field, const Lattice& lattice, std::uint32_t z) {
  SliceCorners corners;
  for (std::uint32_t y = 0; y + 1 < lattice.size.y; ++y) {
    for (std::uint32_t x = 0; x + 1 < lattice.size.x; ++x) {
      int inside = 0;
      for (std::uint32_t corner = 0; corner < 8; ++corner) {
        inside += lattice.inside({x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)}) ? 1 : 0;
      }
      if (inside == 0 || inside == 8) continue;
      corners.emplace_back(y * lattice.size.x + x, corner_in_cell(field, lattice, {x, y, z}));
    }
  }
  return corners;
}

/// Two triangles for each pair of neighbouring samples on different sides, between the corners of the four cells around
/// it. Which way they face is left open.
std::vector<Corners> triangles_between(const Lattice& lattice, const std::vector<SliceCorners>& slices) {
  std::vector<Corners> triangles;
  const auto corner = [&](const glm::uvec3& cell) {
    const SliceCorners& slice = slices[cell.z];
    const std::uint32_t number = cell.y * lattice.size.x + cell.x;
    return std::ranges::lower_bound(slice, number, {}, [](const auto& entry) { return entry.first; })->second;
  };
  for (glm::uvec3 a(0); a.z < lattice.size.z; ++a.z) {
    for (a.y = 0; a.y < lattice.size.y; ++a.y) {
      for (a.x = 0; a.x < lattice.size.x; ++a.x) {
        for (int axis = 0; axis < 3; ++axis) {
          const int second = (axis + 1) % 3, third = (axis + 2) % 3;
          if (a[axis] + 1 >= lattice.size[axis] || a[second] == 0 || a[third] == 0 ||
              a[second] + 1 >= lattice.size[second] || a[third] + 1 >= lattice.size[third]) {
            continue;
          }
          glm::uvec3 b = a;
          b[axis] += 1;
          if (lattice.inside(a) == lattice.inside(b)) continue;
          glm::dvec3 around[4];
          for (int i = 0; i < 4; ++i) {
            glm::uvec3 cell = a;
            cell[second] -= i == 0 || i == 3 ? 1 : 0;
            cell[third] -= i < 2 ? 1 : 0;
            around[i] = corner(cell);
          }
          triangles.push_back({around[0], around[1], around[2]});
          triangles.push_back({around[0], around[2], around[3]});
        }
      }
    }
  }
  return triangles;
}

void bake_values(const Field& field, const BakeOptions& options, voml::Grid& grid, BakeReport& report,
                 const Progress& progress) {
  std::atomic<std::size_t> not_finite{0};
  const auto slice = [&](std::uint32_t z) {
    std::size_t i = std::size_t{z} * grid.size.y * grid.size.x;
    for (std::uint32_t y = 0; y < grid.size.y; ++y) {
      for (std::uint32_t x = 0; x < grid.size.x; ++x, ++i) {
        const Field::Value value = field.evaluate(centre_of(grid, {x, y, z}));
        grid.values[i] = value.value <= 0.0 ? static_cast<float>(value.value) : above_zero(value.value);
        if (!value.finite) ++not_finite;
      }
    }
  };
  for_each_slice(grid.size.z, options.threads, slice, progress, 0, grid.size.z);
  report.not_finite = not_finite;
}

// ---- distances to the triangles ----

/// Which triangle is nearest to each sample: exactly within two voxels of the boundary. Beyond, the nearest of those
/// that are nearest to a neighbour, in eight sweeps over the grid, one from each of its corners (Danielsson 1980;
/// Bridson's SDFGen), and from there on, over the boundary, to where no nearer one is next to it. Distances go to
/// grid.values.
class NearestTriangles {
 public:
  NearestTriangles(voml::Grid& grid, const std::vector<Corners>& triangles)
      : grid_(grid), size_(grid.size), nearest_(grid.values.size(), none) {
    std::ranges::fill(grid_.values, std::numeric_limits<float>::infinity());
    triangles_.reserve(triangles.size());
    for (const Corners& corners : triangles) {
      triangles_.emplace_back(corners);
      ask_near(static_cast<std::uint32_t>(triangles_.size() - 1), corners);
    }
  }

  static constexpr int sweeps = 8;

  /// One slice of a sweep. Slices go upwards in sweeps 0..3, downwards in 4..7.
  void sweep_slice(int sweep, std::uint32_t slice) {
    const bool down_x = sweep & 1, down_y = sweep & 2, down_z = sweep & 4;
    const std::uint32_t z = down_z ? size_.z - 1 - slice : slice;
    for (std::uint32_t j = 0; j < size_.y; ++j) {
      const std::uint32_t y = down_y ? size_.y - 1 - j : j;
      for (std::uint32_t i = 0; i < size_.x; ++i) {
        const std::uint32_t x = down_x ? size_.x - 1 - i : i;
        const std::size_t here = index(x, y, z);
        if (i > 0) ask_neighbour(here, index(down_x ? x + 1 : x - 1, y, z), {x, y, z});
        if (j > 0) ask_neighbour(here, index(x, down_y ? y + 1 : y - 1, z), {x, y, z});
        if (slice > 0) ask_neighbour(here, index(x, y, down_z ? z + 1 : z - 1), {x, y, z});
      }
    }
  }

  /// After all sweeps; slices in any order, at the same time too: what is read, next to the boundary, is not written.
  void refine_slice(std::uint32_t z) {
    for (std::uint32_t y = 0; y < size_.y; ++y) {
      for (std::uint32_t x = 0; x < size_.x; ++x) {
        const std::size_t here = index(x, y, z);
        if (grid_.values[here] <= 2.0f * shortest_step_) continue;
        const glm::dvec3 centre = centre_of(grid_, {x, y, z});
        for (std::uint32_t last = none; nearest_[here] != last;) {
          last = nearest_[here];
          ask_beside(last, here, centre);
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{z} * size_.y + y) * size_.x + x;
  }

  void ask(std::size_t here, std::uint32_t triangle, const glm::dvec3& centre) {
    const double limit = static_cast<double>(grid_.values[here]) * grid_.values[here];
    const double distance2 = triangles_[triangle].squared_distance(centre, limit);
    const auto distance = static_cast<float>(std::sqrt(distance2));
    if (!(distance < grid_.values[here])) return;  // as rounded: equal ones would take turns for ever
    grid_.values[here] = distance;
    nearest_[here] = triangle;
  }

  void ask_neighbour(std::size_t here, std::size_t neighbour, const glm::dvec3& sample) {
    const std::uint32_t triangle = nearest_[neighbour];
    if (triangle == none || triangle == nearest_[here]) return;
    if (grid_.values[neighbour] - longest_step_ > grid_.values[here]) return;
    ask(here, triangle, centre_of(grid_, sample));
  }

  /// What is nearest to the samples around a triangle.
  void ask_beside(std::uint32_t triangle, std::size_t here, const glm::dvec3& centre) {
    const glm::dvec3 at = (triangles_[triangle].centroid() - grid_.box_lo) / step_of(grid_) - 0.5;
    const glm::ivec3 middle(glm::round(at)), last(size_ - 1u);
    const glm::ivec3 from = glm::clamp(middle - 1, glm::ivec3(0), last),
                     to = glm::clamp(middle + 1, glm::ivec3(0), last);
    for (int z = from.z; z <= to.z; ++z) {
      for (int y = from.y; y <= to.y; ++y) {
        for (int x = from.x; x <= to.x; ++x) {
          const std::size_t beside = index(x, y, z);
          if (grid_.values[beside] > 2.0f * shortest_step_ || nearest_[beside] == nearest_[here]) continue;
          ask(here, nearest_[beside], centre);
        }
      }
    }
  }

  /// All samples within two voxels of the triangle's box.
  void ask_near(std::uint32_t triangle, const Corners& corners) {
    const glm::dvec3 step = step_of(grid_);
    const glm::dvec3 lo = glm::min(glm::min(corners[0], corners[1]), corners[2]);
    const glm::dvec3 hi = glm::max(glm::max(corners[0], corners[1]), corners[2]);
    const glm::dvec3 last(size_ - 1u);
    const glm::uvec3 from(glm::clamp(glm::ceil((lo - grid_.box_lo) / step - 2.5), glm::dvec3(0.0), last));
    const glm::uvec3 to(glm::clamp(glm::floor((hi - grid_.box_lo) / step + 1.5), glm::dvec3(0.0), last));
    for (std::uint32_t z = from.z; z <= to.z; ++z) {
      for (std::uint32_t y = from.y; y <= to.y; ++y) {
        for (std::uint32_t x = from.x; x <= to.x; ++x) ask(index(x, y, z), triangle, centre_of(grid_, {x, y, z}));
      }
    }
  }

  voml::Grid& grid_;
  glm::uvec3 size_;
  float longest_step_ = static_cast<float>(1.001 * std::max({step_of(grid_).x, step_of(grid_).y, step_of(grid_).z}));
  float shortest_step_ = static_cast<float>(std::min({step_of(grid_).x, step_of(grid_).y, step_of(grid_).z}));
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> nearest_;
};

/// False if there is no boundary.
bool bake_distances(const Field& field, const BakeOptions& options, voml::Grid& grid, BakeReport& report,
                    const Progress& progress) {
  Lattice lattice;
  lattice.step = step_of(grid);
  lattice.origin = grid.box_lo - 0.5 * lattice.step;
  lattice.size = grid.size + 2u;
  lattice.values.resize(std::size_t{lattice.size.x} * lattice.size.y * lattice.size.z);
  const std::size_t before_distances = 2 * std::size_t{lattice.size.z} - 1;
  const std::size_t total = before_distances + std::size_t{NearestTriangles::sweeps + 1} * grid.size.z;

  std::atomic<std::size_t> not_finite{0};
  const auto evaluate_slice = [&](std::uint32_t z) {
    for (std::uint32_t y = 0; y < lattice.size.y; ++y) {
      for (std::uint32_t x = 0; x < lattice.size.x; ++x) {
        const Field::Value value = field.evaluate(lattice.place({x, y, z}));
        lattice.values[lattice.index({x, y, z})] = static_cast<float>(value.value);
        if (!value.finite) ++not_finite;
      }
    }
  };
  for_each_slice(lattice.size.z, options.threads, evaluate_slice, progress, 0, total);
  report.not_finite = not_finite;

  std::vector<SliceCorners> slices(lattice.size.z - 1);
  for_each_slice(
      lattice.size.z - 1, options.threads, [&](std::uint32_t z) { slices[z] = corners_in_slice(field, lattice, z); },
      progress, lattice.size.z, total);
  std::vector<Corners> triangles = triangles_between(lattice, slices);
  if (triangles.empty()) return false;
  slices = {};
  std::vector<bool> inside;
  inside.reserve(grid.size.x * std::size_t{grid.size.y} * grid.size.z);
  for (glm::uvec3 at(1); at.z <= grid.size.z; ++at.z) {
    for (at.y = 1; at.y <= grid.size.y; ++at.y) {
      for (at.x = 1; at.x <= grid.size.x; ++at.x) inside.push_back(lattice.inside(at));
    }
  }
  lattice.values = {};

  grid.values.resize(inside.size());
  NearestTriangles nearest(grid, triangles);
  triangles = {};
  std::size_t done = before_distances;
  for (int sweep = 0; sweep < NearestTriangles::sweeps; ++sweep) {
    for (std::uint32_t slice = 0; slice < grid.size.z; ++slice) {
      nearest.sweep_slice(sweep, slice);
      if (progress) progress(++done, total);
    }
  }
  for_each_slice(
      grid.size.z, options.threads, [&](std::uint32_t z) { nearest.refine_slice(z); }, progress, done, total);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    grid.values[i] = inside[i] ? 0.0f - grid.values[i] : above_zero(grid.values[i]);
  }
  return true;
}

}  // namespace

Result<voml::Grid> bake(const Field& field, const BakeOptions& options, BakeReport& report,
                        const Progress& progress) try {
  if (const Result<void> checked = check(options); !checked) return tl::unexpected(checked.error());
  const auto inside = field.inside();
  if (!inside) return fail(Fault::input, "the SDF is positive everywhere in its object's cube: nothing is inside");
  voml::Grid grid = empty_grid(*inside, options.resolution, options.padding);
  if (!options.distance) {
    grid.values.resize(std::size_t{grid.size.x} * grid.size.y * grid.size.z);
    bake_values(field, options, grid, report, progress);
    if (std::ranges::none_of(grid.values, [](float value) { return value <= 0.0f; })) {
      return fail(Fault::input, "no sample of the grid lies inside the SDF, which is thinner than a voxel",
                  {"a higher resolution finds more"});
    }
  } else if (!bake_distances(field, options, grid, report, progress)) {
    return fail(Fault::input, "the SDF has no boundary among the samples: there is nothing to measure distances to",
                {"a higher resolution may find one"});
  }
  return grid;
} catch (const std::bad_alloc&) {
  return fail(Fault::environment,
              fmt::format("there is not enough memory for a distance grid of resolution {}", options.resolution),
              {"choose a lower resolution"});
}

}  // namespace dmvv::authoring
