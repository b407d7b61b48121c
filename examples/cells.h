// Points in space, found by their neighbourhood.
#pragma once

#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <vector>

namespace assets {

class Cells {
 public:
  explicit Cells(double cell_size) : cell_size_(cell_size) {}

  void add(glm::dvec3 p, std::uint32_t index) { cells_[cell_of(p)].push_back(index); }

  /// Calls visit(index) for every point nearer to p than the cell size, and for some that are farther.
  template <class Visit>
  void visit_near(glm::dvec3 p, Visit visit) const {
    const Cell c = cell_of(p);
    for (int i = 0; i < 27; ++i) {
      const auto near = cells_.find({c[0] + i % 3 - 1, c[1] + i / 3 % 3 - 1, c[2] + i / 9 - 1});
      if (near == cells_.end()) continue;
      for (const std::uint32_t index : near->second) visit(index);
    }
  }

 private:
  using Cell = std::array<int, 3>;
  Cell cell_of(glm::dvec3 p) const {
    const glm::dvec3 c = glm::floor(p / cell_size_);
    return {static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z)};
  }

  double cell_size_;
  std::map<Cell, std::vector<std::uint32_t>> cells_;
};

}  // namespace assets
