#include "runtime/frame/verdicts.h"

#include <algorithm>
#include <chrono>

namespace dmvv::runtime {
namespace {

constexpr std::size_t most_words = std::size_t{4} << 20;     // of each tree: 16 MiB, and as much for their hits
constexpr std::size_t most_outcomes = std::size_t{1} << 15;  // of each tree: 3.5 MiB
constexpr std::uint32_t most_frames_full = 600;

template <class T>
std::span<T> mapped(const GpuBuffer& buffer) {
  return {static_cast<T*>(buffer.mapped), static_cast<std::size_t>(buffer.bytes / sizeof(T))};
}

}  // namespace

Verdicts::Verdicts(const Device::Impl& gpu, std::shared_ptr<const compiler::Judge> judge,
                   const vk::raii::DescriptorSetLayout& layout)
    : judge_(std::move(judge)), set_(gpu, layout, verdict_bindings) {
  constexpr auto storage = vk::BufferUsageFlagBits::eStorageBuffer;
  words_ = gpu.make_buffer(2 * 4 * most_words, storage, MemoryUse::upload);
  hits_ = gpu.make_buffer(2 * 4 * most_words, storage, MemoryUse::upload);
  outcomes_ = gpu.make_buffer(2 * sizeof(gpu::RegionRecord) * most_outcomes, storage, MemoryUse::upload);
  busy_ = gpu.make_buffer(4 * (1 + DMVV_MOST_BUSY_CELLS), storage, MemoryUse::readback);
  set_.write(DMVV_BIND_VERDICT_WORDS, words_);
  set_.write(DMVV_BIND_VERDICT_HITS, hits_);
  set_.write(DMVV_BIND_OUTCOMES, outcomes_);
  set_.write(DMVV_BIND_BUSY_CELLS, busy_);
  const auto part = [&](std::size_t i) {
    return compiler::VerdictTree::Memory{
        mapped<std::uint32_t>(words_).subspan(i * most_words, most_words),
        mapped<std::uint32_t>(hits_).subspan(i * most_words, most_words),
        mapped<gpu::RegionRecord>(outcomes_).subspan(i * most_outcomes, most_outcomes)};
  };
  always_.memory = part(0);
  span_.memory = part(1);
  always_.tree.emplace(*judge_, judge_->always(), always_.memory);
}

void Verdicts::begin_frame(double time_ms) {
  mapped<std::uint32_t>(busy_).front() = 0;
  if (!judge_->is_animated()) return;
  const bool is_within = times_ && TimeSpan{times_->span_ms().lo, times_->span_ms().hi}.contains(time_ms);
  if (!is_within) {
    span_.tree.reset();
    span_.busy.clear();
    times_.reset();
    if (const auto span = budget_.begin_span(time_ms)) {
      times_ = judge_->times({span->lo, span->hi});
      span_.tree.emplace(*judge_, *times_, span_.memory);
    }
  }
  budget_.note_time(time_ms);
}

void Verdicts::fill(gpu::FrameParams& params) const {
  params.hits_to_split = budget_.hits_to_split();
  params.first_span_word = span_.tree ? most_words : 0;
  params.first_span_outcome = most_outcomes;
  // While time goes on, what is found to stand still or to be the same for ever is worth more than what holds for a
  // span.
  params.counts_both = judge_->is_animated() && (!times_ || times_->span_ms().lo < times_->span_ms().hi);
}

double Verdicts::end_frame(std::uint32_t evaluated, double ms, bool drew) {
  budget_.note_frame(evaluated, ms, drew);
  note_busy_cells();
  const std::size_t affordable = budget_.affordable_cells(ms);
  const std::size_t for_always = std::min(affordable, always_.busy.size());
  return split(always_, for_always) + split(span_, affordable - for_always);
}

/// Cells that were hit often enough in this frame, each once.
void Verdicts::note_busy_cells() {
  const auto busy = mapped<std::uint32_t>(busy_);
  const auto hits = mapped<std::uint32_t>(hits_);
  for (const std::uint32_t cell : busy.subspan(1, std::min<std::size_t>(busy.front(), DMVV_MOST_BUSY_CELLS))) {
    if ((hits[cell] & DMVV_VERDICT_NOTED) != 0) continue;
    hits[cell] |= DMVV_VERDICT_NOTED;
    const bool is_of_span = cell >= most_words;
    (is_of_span ? span_ : always_).busy.push_back(is_of_span ? cell - static_cast<std::uint32_t>(most_words) : cell);
  }
}

void Verdicts::renew_if_full(PlacedTree& placed) {
  if (++placed.frames_full < most_frames_full) return;
  placed.frames_full = 0;
  placed.busy.clear();
  const compiler::Judge::Times& times = &placed == &span_ ? *times_ : judge_->always();
  placed.tree.emplace(*judge_, times, placed.memory);
}

double Verdicts::split(PlacedTree& placed, std::size_t most_cells) {
  using Clock = std::chrono::steady_clock;
  const auto end = placed.busy.begin() + static_cast<std::ptrdiff_t>(std::min(most_cells, placed.busy.size()));
  const std::vector<std::uint32_t> cells(placed.busy.begin(), end);
  if (cells.empty()) return 0.0;
  placed.busy.erase(placed.busy.begin(), end);
  if (placed.tree->is_full()) {
    renew_if_full(placed);
    return 0.0;
  }
  const auto start = Clock::now();
  const std::size_t count = placed.tree->split(cells);
  const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
  budget_.note_splitting(count, ns, &placed == &span_);
  return 1e-6 * ns;
}

}  // namespace dmvv::runtime
