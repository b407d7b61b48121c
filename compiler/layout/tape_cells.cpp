#include "compiler/layout/tape_cells.h"

#include <algorithm>
#include <functional>
#include <unordered_map>

#include "base/parallel.h"
#include "shaders/records.h"

namespace dmvv::compiler {

namespace {

using snippet::BoxValue;
using snippet::Interval;
using snippet::StraightLine;

constexpr std::uint32_t first_line = 2;  // of the numbers in cells; those below are known sides
constexpr std::size_t cells_a_batch = 512;
/// The device finds a point's cell by (q + 1) * side / 2, each operation rounded: off by less than this.
constexpr double cell_margin = 0x1p-22;

/// The axes on which a line depends, in order: the others need not be divided. A text depends on two.
std::vector<int> axes_of(const StraightLine& line) {
  std::vector<int> axes;
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_used = std::ranges::any_of(line.steps, [&](const snippet::Step& step) {
      return step.kind == snippet::Step::Kind::point && step.operands[0] == static_cast<std::uint32_t>(axis);
    });
    if (is_used) axes.push_back(axis);
  }
  return axes;
}

/// A cell of the grid with 2^level cells a side; along the axes that are not divided it is as long as the cube, at 0.
struct Cell {
  glm::uvec3 at{0};
  std::uint32_t level = 0;
  std::uint32_t content = 0;  ///< as in TapeCells::cells
};

struct Refined {
  std::uint32_t side = first_line;  ///< below first_line: it is known
  StraightLine line;
};

std::uint64_t hash_of(const StraightLine& line) {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a, a word at a time
  const auto add = [&](std::uint64_t word) { hash = (hash ^ word) * 0x100000001b3u; };
  for (const snippet::Step& step : line.steps) {
    add(static_cast<std::uint64_t>(step.kind) | static_cast<std::uint64_t>(step.type) << 8 |
        static_cast<std::uint64_t>(step.op) << 16);
    for (const std::uint32_t operand : step.operands) add(operand);
  }
  return hash ^ hash >> 29;
}

class Refiner {
 public:
  Refiner(std::span<const BoxValue> hoisted, const IsoRange& iso, const TapeOptions& options)
      : hoisted_(hoisted), iso_(iso), options_(options) {}

  TapeCells run(const StraightLine& whole) {
    axes_ = axes_of(whole);
    std::vector<Cell> open{{{}, 0, number(whole)}};
    if (options_.shorten) {
      const std::uint32_t root = open.front().content;
      open = refined(open);
      release(root);
    }
    while (options_.shorten && !axes_.empty() && !open.empty() &&
           cells_of(open.front().level + 1) <= options_.most_cells)
      open = halved(open);
    closed_.insert(closed_.end(), open.begin(), open.end());
    drop_unused_lines();
    fill_grid();
    return std::move(out_);
  }

 private:
  static std::uint64_t cells_of(std::uint32_t level) { return std::uint64_t{1} << 3 * level; }

  const StraightLine& line(std::uint32_t content) const { return out_.lines[content - first_line]; }

  /// The number of a line, with one more use of it. Equal lines have one number.
  std::uint32_t number(StraightLine line) {
    std::vector<std::uint32_t>& known = numbers_[hash_of(line)];
    for (const std::uint32_t n : known) {
      if (this->line(n) != line) continue;
      ++uses_[n - first_line];
      return n;
    }
    steps_ += line.steps.size();
    out_.lines.push_back(std::move(line));
    uses_.push_back(1);
    known.push_back(static_cast<std::uint32_t>(out_.lines.size()) - 1 + first_line);
    return known.back();
  }

  /// One use less. A line that nobody uses any more makes room for others.
  void release(std::uint32_t content) {
    if (--uses_[content - first_line] != 0) return;
    StraightLine& unused = out_.lines[content - first_line];
    std::erase(numbers_[hash_of(unused)], content);
    steps_ -= unused.steps.size();
    unused = {};
  }

  /// Numbers the lines in use anew, in their order.
  void drop_unused_lines() {
    std::deque<StraightLine> used;
    std::vector<std::uint32_t> new_number(out_.lines.size());
    for (std::size_t i = 0; i < out_.lines.size(); ++i) {
      if (uses_[i] == 0) continue;
      new_number[i] = static_cast<std::uint32_t>(used.size()) + first_line;
      used.push_back(std::move(out_.lines[i]));
    }
    for (Cell& cell : closed_) {
      if (cell.content >= first_line) cell.content = new_number[cell.content - first_line];
    }
    out_.lines = std::move(used);
  }

  // ---- one level ----

  /// The children that are still open. Cells for which a budget does not suffice are closed as they are.
  std::vector<Cell> halved(std::vector<Cell> open) {
    std::ranges::stable_sort(open, std::ranges::greater(),
                             [&](const Cell& cell) { return line(cell.content).steps.size(); });
    std::vector<Cell> next;
    for (std::size_t first = 0; first < open.size(); first += cells_a_batch) {
      const std::span batch = std::span(open).subspan(first, std::min(cells_a_batch, open.size() - first));
      std::vector<Cell> children;
      std::uint64_t work = 0;
      for (const Cell& cell : batch) {
        const std::uint32_t count = 1u << axes_.size();
        work += count * line(cell.content).steps.size();
        for (std::uint32_t k = 0; k < count; ++k) {
          Cell child{2u * cell.at, cell.level + 1, cell.content};
          for (std::size_t i = 0; i < axes_.size(); ++i) child.at[axes_[i]] += k >> i & 1u;
          children.push_back(child);
        }
      }
      if (work_ + work > options_.most_work || steps_ > options_.most_steps) {
        closed_.insert(closed_.end(), open.begin() + static_cast<std::ptrdiff_t>(first), open.end());
        break;
      }
      work_ += work;
      const std::vector<Cell> left = refined(children);
      next.insert(next.end(), left.begin(), left.end());
      for (const Cell& cell : batch) release(cell.content);
    }
    return next;
  }

  /// Evaluates each cell's line over the cell: closes those whose side is known, shortens the others.
  std::vector<Cell> refined(const std::vector<Cell>& cells) {
    std::vector<Refined> results(cells.size());
    in_parallel(cells.size(), [&](std::size_t i) { results[i] = refine(cells[i]); });
    std::vector<Cell> open;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool is_known = results[i].side < first_line;
      Cell cell = cells[i];
      cell.content = is_known ? results[i].side : number(std::move(results[i].line));
      (is_known ? closed_ : open).push_back(cell);
    }
    return open;
  }

  Refined refine(const Cell& cell) const {
    thread_local std::vector<BoxValue> values;
    const double edge = 2.0 / static_cast<double>(1u << cell.level);
    glm::dvec3 lo(-1.0), hi(1.0);
    for (const int axis : axes_) {
      lo[axis] = cell.at[axis] * edge - 1.0;
      hi[axis] = lo[axis] + edge;
    }
    const StraightLine& parent = line(cell.content);
    snippet::evaluate_steps(parent, {lo - cell_margin, hi + cell_margin}, hoisted_, values);
    const Interval& f = values.back().f;
    if (f.lo > iso_.hi) return {DMVV_TAPE_POSITIVE, {}};  // a NaN counts as positive too
    if (f.hi <= iso_.lo && !f.maybe_nan) return {DMVV_TAPE_NEGATIVE, {}};
    return {first_line, snippet::shorten(parent, values)};
  }

  // ---- the grid ----

  void fill_grid() {
    std::uint32_t finest = 0;
    for (const Cell& cell : closed_) finest = std::max(finest, cell.level);
    const std::uint32_t side = out_.cells_a_side = 1u << finest;
    out_.cells.resize(std::size_t{side} * side * side);
    for (const Cell& cell : closed_) {
      glm::uvec3 first(0), width(side);
      for (const int axis : axes_) {
        width[axis] = 1u << (finest - cell.level);
        first[axis] = cell.at[axis] * width[axis];
      }
      for (std::uint32_t z = first.z; z < first.z + width.z; ++z) {
        for (std::uint32_t y = first.y; y < first.y + width.y; ++y) {
          const std::size_t row = (std::size_t{z} * side + y) * side + first.x;
          std::fill_n(out_.cells.begin() + static_cast<std::ptrdiff_t>(row), width.x, cell.content);
        }
      }
    }
  }

  std::vector<int> axes_;  ///< along which cells are halved
  std::span<const BoxValue> hoisted_;
  IsoRange iso_;
  const TapeOptions& options_;
  TapeCells out_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> numbers_;
  std::vector<Cell> closed_;
  std::uint64_t work_ = 0;
  std::vector<std::uint32_t> uses_;  ///< of each line, by open and closed cells
  std::uint64_t steps_ = 0;          ///< of the lines in use
};

}  // namespace

TapeCells shorten_for_cells(const StraightLine& whole, std::span<const BoxValue> hoisted, const IsoRange& iso,
                            const TapeOptions& options) {
  return Refiner(hoisted, iso, options).run(whole);
}

}  // namespace dmvv::compiler
