#include "compiler/proofs/verdict_tree.h"

#include <algorithm>
#include <glm/common.hpp>

#include "base/parallel.h"

namespace dmvv::compiler {

namespace {

constexpr double unit = 2.0 / DMVV_VERDICT_UNITS;  // width of the finest cells
constexpr double margin =
    0x1p-23;  // p + 1 is rounded before a device finds the cell: half an ulp of 2, and as much to spare

glm::uvec3 child_place(std::uint32_t child) { return {child % 4, child / 4 % 4, child / 16}; }
std::uint32_t child_at(const glm::uvec3& place) { return (place.z * 4 + place.y) * 4 + place.x; }

}  // namespace

VerdictTree::VerdictTree(const Judge& judge, const Judge::Times& times, const Memory& memory)
    : judge_(judge), times_(times), memory_(memory) {
  const Cell cube{glm::uvec3(0), DMVV_VERDICT_UNITS};
  add_brick(0, cube, judge_brick(cube));
}

VerdictTree::Cell VerdictTree::cell(std::uint32_t word) const {
  const Cell& parent = bricks_[word / DMVV_BRICK_WORDS];
  const std::uint32_t width = parent.width / 4;
  return {parent.corner + width * child_place(word % DMVV_BRICK_WORDS), width};
}

snippet::Box VerdictTree::box_of(const Cell& cell) {
  const glm::dvec3 lo = glm::dvec3(cell.corner) * unit - 1.0 - margin;
  const glm::dvec3 hi = glm::dvec3(cell.corner + cell.width) * unit - 1.0 + margin;
  return {glm::max(lo, glm::dvec3(-1.0)), glm::min(hi, glm::dvec3(1.0))};
}

snippet::Box VerdictTree::box_of(std::uint32_t word) const { return box_of(cell(word)); }

std::uint32_t VerdictTree::cell_of(const glm::vec3& p) const {
  const glm::vec3 scaled = (p + 1.0f) * (0.5f * DMVV_VERDICT_UNITS);
  const glm::uvec3 place(glm::clamp(scaled, 0.0f, DMVV_VERDICT_UNITS - 1.0f));
  std::uint32_t shift = 2 * (DMVV_VERDICT_LEVELS - 1);
  std::uint32_t at = child_at(place >> shift);
  while ((memory_.words[at] & DMVV_VERDICT_INNER) != 0) {
    shift -= 2;
    at = (memory_.words[at] & DMVV_VERDICT_VALUE) + child_at(place >> shift & 3u);
  }
  return at;
}

/// By octants first: most cells near a boundary have some that are decided as a whole.
VerdictTree::Words VerdictTree::judge_brick(const Cell& parent) {
  Words words{};
  const std::uint32_t half = parent.width / 2, quarter = parent.width / 4;
  Inquiry whole(judge_, times_, box_of(parent));
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    const glm::uvec3 place(octant & 1, octant >> 1 & 1, octant >> 2);
    Inquiry eighth(whole, box_of(Cell{parent.corner + half * place, half}));
    const std::uint32_t of_octant = word_for(eighth.verdict(), quarter);
    for (std::uint32_t part = 0; part < 8; ++part) {
      const glm::uvec3 at = 2u * place + glm::uvec3(part & 1, part >> 1 & 1, part >> 2);
      std::uint32_t& word = words[child_at(at)] = of_octant;
      if ((of_octant & DMVV_VERDICT_DECIDED) != 0) continue;
      word = word_for(Inquiry(eighth, box_of(Cell{parent.corner + quarter * at, quarter})).verdict(), quarter);
    }
  }
  return words;
}

std::uint32_t VerdictTree::word_for(const Verdict& verdict, std::uint32_t width) {
  if (verdict.decided) {
    const bool has_bitmap =
        verdict.region.valid() && at(judge_.module().regions, verdict.region).kind == voml::RegionKind::bitmap;
    if (const auto known = outcome(verdict))
      return DMVV_VERDICT_DECIDED | (has_bitmap ? DMVV_VERDICT_BITMAP : 0u) | *known;
  }
  return (verdict.moves ? 0u : DMVV_VERDICT_STILL) | (width == 1 ? DMVV_VERDICT_FINAL : 0u);
}

/// None if there is no room for another one.
std::optional<std::uint32_t> VerdictTree::outcome(const Verdict& verdict) {
  const Affine& a = verdict.texture_from_root;
  std::array<double, 12> texture{};
  for (int column = 0; column < 4; ++column) {
    const glm::dvec3& v = column < 3 ? a.linear[column] : a.translation;
    for (int row = 0; row < 3; ++row) texture[static_cast<std::size_t>(3 * column + row)] = v[row];
  }
  const std::lock_guard lock(outcome_mutex_);
  const auto [place, is_new] =
      outcomes_.try_emplace({verdict.region.index, texture}, static_cast<std::uint32_t>(outcome_count_));
  if (!is_new) return place->second;
  if (outcome_count_ == memory_.outcomes.size()) {
    outcomes_.erase(place);
    return std::nullopt;
  }
  gpu::RegionRecord& record = memory_.outcomes[outcome_count_++];
  record = {};
  if (verdict.region.valid()) {
    record = judge_.records().regions[verdict.region.index];
    record.texture_from_object = rows(a);
  }
  return place->second;
}

void VerdictTree::add_brick(std::uint32_t parent, const Cell& cell, const Words& words) {
  if (is_full()) return;
  const auto first = static_cast<std::ptrdiff_t>(first_free_);
  std::ranges::copy(words, memory_.words.begin() + first);
  std::fill_n(memory_.hits.begin() + first, DMVV_BRICK_WORDS, 0u);
  if (first != 0) memory_.words[parent] = DMVV_VERDICT_INNER | static_cast<std::uint32_t>(first);
  bricks_.push_back(cell);
  first_free_ += DMVV_BRICK_WORDS;
}

std::size_t VerdictTree::split(std::span<const std::uint32_t> cells) {
  std::vector<std::uint32_t> open;
  for (const std::uint32_t i : cells) {
    const bool is_open =
        i < first_free_ && (word(i) & (DMVV_VERDICT_DECIDED | DMVV_VERDICT_INNER | DMVV_VERDICT_FINAL)) == 0;
    if (is_open) open.push_back(i);
  }
  std::ranges::sort(open);
  open.erase(std::unique(open.begin(), open.end()), open.end());
  const std::size_t room = (memory_.words.size() - first_free_) / DMVV_BRICK_WORDS;
  open.resize(std::min(open.size(), room));
  std::vector<Words> bricks(open.size());
  in_parallel(open.size(), [&](std::size_t i) { bricks[i] = judge_brick(cell(open[i])); });
  for (std::size_t i = 0; i < open.size(); ++i) add_brick(open[i], cell(open[i]), bricks[i]);
  return open.size();
}

}  // namespace dmvv::compiler
