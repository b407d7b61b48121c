// Verdict grids: what is proven of the cells of the standard cube, split finer where somebody asks again and again.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "compiler/proofs/judge.h"
#include "shaders/records.h"

namespace dmvv::compiler {

/// A sparse tree of cells over the root's cube, in memory that a device reads (shaders/verdicts.glsl walks it). It
/// begins with one level and grows by `split` only, so it is as fine as it pays, where it pays.
class VerdictTree {
 public:
  /// Where it is written; all outlive the tree.
  struct Memory {
    std::span<std::uint32_t> words;         ///< at least DMVV_BRICK_WORDS: bounds the tree
    std::span<std::uint32_t> hits;          ///< as many; the hits of a new brick's cells are set to 0
    std::span<gpu::RegionRecord> outcomes;  ///< texture_from_object is texture_from_root there
  };

  /// Cost: splits the cube once. `judge` and `times` outlive the tree.
  VerdictTree(const Judge& judge, const Judge::Times& times, const Memory& memory);

  /// Splits open cells, given by their words' indices; others are left as they are. On all cores. Stops where the
  /// memory ends. Returns how many were split. Cost: 8 to 72 inquiries a cell.
  std::size_t split(std::span<const std::uint32_t> cells);

  bool is_full() const { return first_free_ + DMVV_BRICK_WORDS > memory_.words.size(); }
  std::size_t word_count() const { return first_free_; }
  std::size_t outcome_count() const { return outcome_count_; }

  /// The index of the word of the cell in which a point lies, as a device finds it.
  std::uint32_t cell_of(const glm::vec3& p) const;
  std::uint32_t word(std::uint32_t cell) const { return memory_.words[cell]; }
  /// The points that a device may find in a cell.
  snippet::Box box_of(std::uint32_t cell) const;

 private:
  struct Cell {
    glm::uvec3 corner;    ///< in units of the finest cells
    std::uint32_t width;  ///< likewise
  };
  using Words = std::array<std::uint32_t, DMVV_BRICK_WORDS>;

  Cell cell(std::uint32_t word) const;
  static snippet::Box box_of(const Cell& cell);
  Words judge_brick(const Cell& parent);
  std::uint32_t word_for(const Verdict& verdict, std::uint32_t width);
  std::optional<std::uint32_t> outcome(const Verdict& verdict);
  void add_brick(std::uint32_t parent, const Cell& cell, const Words& words);

  const Judge& judge_;
  const Judge::Times& times_;
  Memory memory_;
  std::vector<Cell> bricks_;  ///< the cell that each brick splits
  std::size_t first_free_ = 0;
  std::mutex outcome_mutex_;
  std::size_t outcome_count_ = 0;
  /// By region and texture_from_root, its matrix column by column.
  std::map<std::pair<std::uint32_t, std::array<double, 12>>, std::uint32_t> outcomes_;
};

}  // namespace dmvv::compiler
