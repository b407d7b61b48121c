#include "compiler/grids/grid_range.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

namespace dmvv::compiler {

namespace {

constexpr int most_voxels = 2;  // along an axis, for the exact range
constexpr int most_blocks = 4;  // along an axis, of the pyramid

std::size_t index(const glm::uvec3& size, const glm::ivec3& i) {
  return (static_cast<std::size_t>(i.z) * size.y + static_cast<std::size_t>(i.y)) * size.x +
         static_cast<std::size_t>(i.x);
}

Range joined(const Range& a, const Range& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }

constexpr Range nothing{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

int widest(const glm::ivec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

GridRange::GridRange(const voml::Grid& grid) : grid_(grid), bounds_(grid_bounds(grid)) {
  glm::uvec3 size = grid.size;
  const std::vector<float>* least = &grid.values;
  const std::vector<float>* most = &grid.values;
  while (size != glm::uvec3(1)) {
    Level level{(size + 1u) / 2u, {}, {}};
    const std::size_t count = std::size_t{level.size.x} * level.size.y * level.size.z;
    level.least.assign(count, std::numeric_limits<float>::infinity());
    level.most.assign(count, -std::numeric_limits<float>::infinity());
    std::size_t from = 0;
    for (std::uint32_t z = 0; z < size.z; ++z) {
      for (std::uint32_t y = 0; y < size.y; ++y) {
        for (std::uint32_t x = 0; x < size.x; ++x, ++from) {
          const std::size_t to = index(level.size, glm::ivec3(x / 2, y / 2, z / 2));
          level.least[to] = std::min(level.least[to], (*least)[from]);
          level.most[to] = std::max(level.most[to], (*most)[from]);
        }
      }
    }
    size = level.size;
    levels_.push_back(std::move(level));
    least = &levels_.back().least;
    most = &levels_.back().most;
  }
}

Range GridRange::over(const glm::dvec3& lo, const glm::dvec3& hi) const {
  const glm::dvec3 end(grid_.size - 1u);
  const glm::dvec3 a = glm::clamp(lo, glm::dvec3(0.0), end), b = glm::clamp(hi, glm::dvec3(0.0), end);
  const glm::ivec3 outermost = glm::max(glm::ivec3(grid_.size) - 2, glm::ivec3(0));
  const glm::ivec3 first = glm::min(glm::ivec3(glm::floor(a)), outermost),
                   last = glm::min(glm::ivec3(glm::floor(b)), outermost);
  if (widest(last - first) < most_voxels) return of_voxels(a, b, first, last);
  return of_samples(first, glm::min(last + 1, glm::ivec3(grid_.size) - 1));
}

double GridRange::at(const glm::dvec3& c) const {
  const glm::ivec3 end = glm::ivec3(grid_.size) - 1;
  const glm::ivec3 lo = glm::clamp(glm::ivec3(glm::floor(c)), glm::ivec3(0), glm::max(end - 1, glm::ivec3(0)));
  const glm::ivec3 hi = glm::min(lo + 1, end);
  const glm::dvec3 w = c - glm::dvec3(lo);
  const auto row = [&](int y, int z) {
    const double v0 = grid_.values[index(grid_.size, {lo.x, y, z})], v1 = grid_.values[index(grid_.size, {hi.x, y, z})];
    return v0 + (v1 - v0) * w.x;
  };
  const double near = glm::mix(row(lo.y, lo.z), row(hi.y, lo.z), w.y);
  return glm::mix(near, glm::mix(row(lo.y, hi.z), row(hi.y, hi.z), w.y), w.z);
}

Range GridRange::of_voxels(const glm::dvec3& lo, const glm::dvec3& hi, const glm::ivec3& first,
                           const glm::ivec3& last) const {
  // Corners of the box and where it crosses from voxel to voxel.
  double stops[3][most_voxels + 1];
  int counts[3];
  for (int axis = 0; axis < 3; ++axis) {
    int& count = counts[axis] = 0;
    stops[axis][count++] = lo[axis];
    for (int i = first[axis] + 1; i <= last[axis]; ++i) stops[axis][count++] = i;
    if (hi[axis] > lo[axis]) stops[axis][count++] = hi[axis];
  }
  Range range = nothing;
  for (int z = 0; z < counts[2]; ++z) {
    for (int y = 0; y < counts[1]; ++y) {
      for (int x = 0; x < counts[0]; ++x) {
        const double value = at({stops[0][x], stops[1][y], stops[2][z]});
        range = joined(range, {value, value});
      }
    }
  }
  return range;
}

Range GridRange::of_samples(const glm::ivec3& first, const glm::ivec3& last) const {
  std::size_t level = 0;
  const auto block = [&](const glm::ivec3& i) { return i >> static_cast<int>(level); };
  while (widest(block(last) - block(first)) >= most_blocks) ++level;
  const glm::uvec3& size = level == 0 ? grid_.size : levels_[level - 1].size;
  const float* least = level == 0 ? grid_.values.data() : levels_[level - 1].least.data();
  const float* most = level == 0 ? grid_.values.data() : levels_[level - 1].most.data();
  const glm::ivec3 from = block(first), to = block(last);
  Range range = nothing;
  for (int z = from.z; z <= to.z; ++z) {
    for (int y = from.y; y <= to.y; ++y) {
      for (int x = from.x; x <= to.x; ++x) {
        const std::size_t i = index(size, {x, y, z});
        range = joined(range, {least[i], most[i]});
      }
    }
  }
  return range;
}

}  // namespace dmvv::compiler
