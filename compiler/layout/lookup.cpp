#include "compiler/layout/lookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <numeric>

#include "compiler/ir/placements.h"
#include "compiler/ir/rounding.h"

namespace dmvv::compiler {

namespace {

constexpr std::uint64_t max_cells = 1u << 21;
constexpr double cells_a_placement = 64.0;
constexpr double smallest_cell = 0.1;  // of the placements' mean edge: finer cells only repeat the same lists

struct Box {
  glm::dvec3 lo;
  glm::dvec3 hi;
};

/// Axis-aligned bounds of a placed box in the frame, clipped to the cube; empty (lo > hi) if they do not meet.
Box frame_bounds(const PlacedBox& placed) {
  if (placed.everywhere) return {glm::dvec3(-1.0), glm::dvec3(1.0)};
  const Affine frame_from_local = inverse(placed.local_from_frame);
  const glm::dvec3 center = frame_from_local(0.5 * (placed.lo + placed.hi));
  const glm::dvec3 half = abs_times(frame_from_local.linear, 0.5 * (placed.hi - placed.lo) + placed.local_error);
  return {glm::max(center - half, glm::dvec3(-1.0)), glm::min(center + half, glm::dvec3(1.0))};
}

bool is_empty(const Box& box) { return glm::any(glm::greaterThan(box.lo, box.hi)); }

/// False only if a face plane of the placed box separates it from the cell.
bool may_meet(const PlacedBox& placed, const glm::dvec3& cell_center, const glm::dvec3& cell_half) {
  const glm::dvec3 center = placed.local_from_frame(cell_center);
  const glm::dvec3 half = abs_times(placed.local_from_frame.linear, cell_half) + placed.local_error;
  return glm::all(glm::lessThanEqual(center - half, placed.hi)) &&
         glm::all(glm::greaterThanEqual(center + half, placed.lo));
}

Box union_of(std::span<const Box> boxes) {
  Box all{glm::dvec3(1.0), glm::dvec3(-1.0)};
  for (const Box& box : boxes) {
    if (is_empty(box)) continue;
    all = {glm::min(all.lo, box.lo), glm::max(all.hi, box.hi)};
  }
  if (is_empty(all)) all = {glm::dvec3(-1.0), glm::dvec3(1.0)};
  // A flat extent would divide by zero; the cube is 2 wide, so a thousandth costs nothing.
  const glm::dvec3 grow = glm::max(glm::dvec3(1e-3) - (all.hi - all.lo), glm::dvec3(0.0)) * 0.5;
  return {all.lo - grow, all.hi + grow};
}

/// Cubic cells, small against the placements: a point then meets hardly more candidates than hold it. Measured on the
/// orange's juice sacs, 64 cells a placement are four times as fast as 4, for some 12 bytes a cell.
glm::uvec3 choose_size(std::span<const Box> boxes, const Box& extent) {
  const glm::dvec3 width = extent.hi - extent.lo;
  double mean_edge = 0.0;
  std::size_t count = 0;
  for (const Box& box : boxes) {
    if (is_empty(box)) continue;
    const glm::dvec3 w = box.hi - box.lo;
    mean_edge += std::cbrt(w.x * w.y * w.z);
    ++count;
  }
  if (count <= 4) return glm::uvec3(1);
  mean_edge /= static_cast<double>(count);
  const double by_count = std::cbrt(width.x * width.y * width.z / (cells_a_placement * static_cast<double>(count)));
  const double edge = std::max(by_count, smallest_cell * mean_edge);
  return glm::uvec3(glm::clamp(glm::ceil(width / edge), glm::dvec3(1.0), glm::dvec3(256.0)));
}

std::uint64_t cells_of(const glm::uvec3& size) { return std::uint64_t{size.x} * size.y * size.z; }

glm::uvec3 wanted_size(std::span<const Box> boxes, const Box& extent, const glm::uvec3& wish, bool refine) {
  if (wish != glm::uvec3(0) && (!refine || wish == glm::uvec3(1))) return wish;
  const glm::uvec3 chosen = choose_size(boxes, extent);
  return cells_of(chosen) >= cells_of(wish) ? chosen : wish;
}

glm::uvec3 within_budget(glm::uvec3 size) {
  size = glm::max(size, glm::uvec3(1));
  while (static_cast<std::uint64_t>(size.x) * size.y > max_cells ||
         std::uint64_t{size.x} * size.y * size.z > max_cells) {
    std::uint32_t& largest = size.x >= size.y && size.x >= size.z ? size.x : size.y >= size.z ? size.y : size.z;
    largest = (largest + 1) / 2;
  }
  return size;
}

struct CellRange {
  glm::uvec3 first{0};
  glm::uvec3 end{0};
};

glm::dvec3 cell_margin(const Lookup& grid, const glm::dvec3& frame_error, double widened) {
  // The shader rounds lo, p - lo and the product with cells a unit: four half ulps of numbers up to 2, and ulps of u.
  const glm::dvec3 cell = (grid.hi - grid.lo) / glm::dvec3(grid.size);
  return frame_error + 8.0 * float_unit * (glm::abs(grid.lo) + 2.0) + (1e-6 + widened) * cell;
}

CellRange cell_range(const Lookup& grid, const Box& box, const glm::dvec3& margin) {
  if (is_empty(box)) return {};
  const glm::dvec3 cell = (grid.hi - grid.lo) / glm::dvec3(grid.size);
  const glm::dvec3 last = glm::dvec3(grid.size) - 1.0;
  const auto index = [&](const glm::dvec3& p) {
    return glm::uvec3(glm::clamp(glm::floor((p - grid.lo) / cell), glm::dvec3(0.0), last));
  };
  return {index(box.lo - margin), index(box.hi + margin) + 1u};
}

/// Calls visit(cell index) for each cell that the placement can meet, in ascending order.
template <class Visit>
void for_each_cell(const Lookup& grid, const PlacedBox& placed, const Box& box, const glm::dvec3& margin,
                   Visit&& visit) {
  const glm::dvec3 cell = (grid.hi - grid.lo) / glm::dvec3(grid.size);
  const auto [first, end] = cell_range(grid, box, margin);
  for (std::uint32_t z = first.z; z < end.z; ++z) {
    for (std::uint32_t y = first.y; y < end.y; ++y) {
      for (std::uint32_t x = first.x; x < end.x; ++x) {
        const glm::dvec3 center = grid.lo + (glm::dvec3(x, y, z) + 0.5) * cell;
        if (!placed.everywhere && !may_meet(placed, center, 0.5 * cell + margin)) continue;
        visit((z * grid.size.y + y) * grid.size.x + x);
      }
    }
  }
}

/// Cells that the placements' bounds touch: the work of one sweep, and a bound of the entries.
std::uint64_t touched_cells(const Lookup& grid, std::span<const Box> boxes, const glm::dvec3& margin) {
  std::uint64_t touched = 0;
  for (const Box& box : boxes) {
    const auto [first, end] = cell_range(grid, box, margin);
    const glm::u64vec3 width(end - first);
    touched += width.x * width.y * width.z;
  }
  return touched;
}

/// Entries of cell c into cells[c + 1].
void count_entries(Lookup& grid, std::span<const PlacedBox> placements, std::span<const Box> boxes,
                   const glm::dvec3& margin) {
  grid.cells.assign(std::size_t{grid.size.x} * grid.size.y * grid.size.z + 1, 0);
  for (std::size_t i = 0; i < placements.size(); ++i) {
    for_each_cell(grid, placements[i], boxes[i], margin, [&](std::uint32_t cell) { ++grid.cells[cell + 1]; });
  }
}

/// Chebyshev distances to the nearest cell with a list: along each axis forth and back. Behind the grid's walls there
/// is none.
void measure_gaps(Lookup& grid) {
  constexpr std::uint32_t far = 255;
  const glm::uvec3& n = grid.size;
  grid.gaps.resize(grid.cells.size() - 1);
  for (std::size_t c = 0; c < grid.gaps.size(); ++c) grid.gaps[c] = grid.cells[c] == grid.cells[c + 1] ? far : 0;
  // One axis after the other: the least over the row of max(distance along it, distance so far).
  const std::array<std::size_t, 3> steps{1, n.x, std::size_t{n.x} * n.y};
  std::vector<std::uint32_t> row;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t length = n[axis], across = n[(axis + 1) % 3], up = n[(axis + 2) % 3];
    const std::size_t step = steps[static_cast<std::size_t>(axis)];
    const std::size_t step_across = steps[static_cast<std::size_t>((axis + 1) % 3)];
    const std::size_t step_up = steps[static_cast<std::size_t>((axis + 2) % 3)];
    row.resize(length);
    for (std::uint32_t j = 0; j < up; ++j) {
      for (std::uint32_t i = 0; i < across; ++i) {
        std::uint32_t* const first = grid.gaps.data() + j * step_up + i * step_across;
        for (std::uint32_t x = 0; x < length; ++x) row[x] = first[x * step];
        for (std::uint32_t x = 0; x < length; ++x) {
          std::uint32_t least = row[x];
          for (std::uint32_t d = 1; d < least && (x >= d || x + d < length); ++d) {
            if (x >= d) least = std::min(least, std::max(d, row[x - d]));
            if (x + d < length) least = std::min(least, std::max(d, row[x + d]));
          }
          first[x * step] = least;
        }
      }
    }
  }
}

std::uint64_t sum(std::span<const std::uint32_t> counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::uint64_t most_touched(std::size_t placements) { return std::max<std::uint64_t>(1u << 25, 8 * placements); }

std::uint64_t most_entries(std::size_t placements) {
  return std::min<std::uint64_t>((1u << 16) + 512 * placements, 1u << 24);
}

}  // namespace

glm::uvec3 Lookup::cell_of(const glm::dvec3& p) const {
  const glm::dvec3 u = (p - lo) / (hi - lo) * glm::dvec3(size);
  return glm::uvec3(glm::clamp(glm::floor(u), glm::dvec3(0.0), glm::dvec3(size) - 1.0));
}

std::span<const std::uint32_t> Lookup::at(const glm::dvec3& p) const {
  const glm::uvec3 c = cell_of(p);
  const std::size_t cell = (std::size_t{c.z} * size.y + c.y) * size.x + c.x;
  return std::span(lists).subspan(cells[cell], cells[cell + 1] - cells[cell]);
}

Lookup build_lookup(std::span<const PlacedBox> placements, const glm::uvec3& wish, const glm::dvec3& frame_error,
                    bool refine, double widened) {
  std::vector<Box> boxes;
  boxes.reserve(placements.size());
  for (const PlacedBox& placed : placements) boxes.push_back(frame_bounds(placed));

  Lookup grid;
  const Box extent = union_of(boxes);
  grid.lo = extent.lo;
  grid.hi = extent.hi;
  grid.size = within_budget(wanted_size(boxes, extent, wish, refine));

  // Step 1: coarser cells while placements overlap so much that the work or the lists would be huge.
  // Step 2: counts of entries become starts. Step 3: fill, placements ascending.
  glm::dvec3 margin = cell_margin(grid, frame_error, widened);
  const auto coarsen = [&] {
    grid.size = (grid.size + 1u) / 2u;
    margin = cell_margin(grid, frame_error, widened);
  };
  while (grid.size != glm::uvec3(1) && touched_cells(grid, boxes, margin) > most_touched(placements.size())) coarsen();
  count_entries(grid, placements, boxes, margin);
  while (grid.size != glm::uvec3(1) && sum(grid.cells) > most_entries(placements.size())) {
    coarsen();
    count_entries(grid, placements, boxes, margin);
  }
  grid.longest = *std::max_element(grid.cells.begin(), grid.cells.end());
  std::partial_sum(grid.cells.begin(), grid.cells.end(), grid.cells.begin());
  grid.lists.resize(grid.cells.back());
  std::vector<std::uint32_t> next(grid.cells.begin(), grid.cells.end() - 1);
  for (std::uint32_t i = 0; i < placements.size(); ++i) {
    for_each_cell(grid, placements[i], boxes[i], margin, [&](std::uint32_t cell) { grid.lists[next[cell]++] = i; });
  }
  if (widened > 0.0) measure_gaps(grid);
  return grid;
}

}  // namespace dmvv::compiler
