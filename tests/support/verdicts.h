// Trees of verdicts grown at points, and what they claim there.
#pragma once

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compiler/proofs/verdict_tree.h"
#include "compiler/reference/reference.h"

namespace dmvv::tests {

/// A tree in memory of its own.
class GrownTree {
 public:
  GrownTree(const compiler::Judge& judge, const compiler::Judge::Times& times, std::size_t bricks = 4096,
            std::size_t outcomes = 4096)
      : words_(bricks * DMVV_BRICK_WORDS),
        hits_(words_.size()),
        outcomes_(outcomes),
        tree_(judge, times, {words_, hits_, outcomes_}) {}

  /// Splits the cells of the points, again and again.
  void grow(std::span<const glm::dvec3> points, int rounds) {
    for (int round = 0; round < rounds; ++round) {
      std::vector<std::uint32_t> cells;
      for (const glm::dvec3& p : points) cells.push_back(tree_.cell_of(glm::vec3(p)));
      tree_.split(cells);
    }
  }

  compiler::VerdictTree& tree() { return tree_; }
  std::uint32_t word_at(const glm::dvec3& p) const { return tree_.word(tree_.cell_of(glm::vec3(p))); }
  /// The outcome that is proven at a point; none where the tree is open.
  const gpu::RegionRecord* outcome_at(const glm::dvec3& p) const {
    if (glm::any(glm::greaterThan(glm::abs(p), glm::dvec3(1.0)))) return nullptr;
    const std::uint32_t word = word_at(p);
    return (word & DMVV_VERDICT_DECIDED) != 0 ? &outcomes_[word & DMVV_VERDICT_VALUE] : nullptr;
  }

 private:
  std::vector<std::uint32_t> words_, hits_;
  std::vector<gpu::RegionRecord> outcomes_;
  compiler::VerdictTree tree_;
};

/// Does an outcome agree with a certain answer? Colours of bitmaps are looked up by a device, and not compared.
inline bool agrees(const gpu::RegionRecord& outcome, const compiler::PointAnswer& expected) {
  bool same = outcome.number == expected.number;
  for (int c = 0; c < 4 && expected.number != 0 && outcome.slot_scale.w == 0.0f; ++c) {
    same = same && std::abs(outcome.color[c] - expected.rgba[c]) < 1e-3;
  }
  return same;
}

}  // namespace dmvv::tests
