#include "runtime/frame/verdicts.h"

#include <algorithm>
#include <array>
#include <chrono>

namespace dmvv::runtime {
namespace {

constexpr std::size_t most_words = std::size_t{4} << 20;     // of each tree: 16 MiB, and as much for their hits
constexpr std::size_t most_outcomes = std::size_t{1} << 15;  // of each tree: 3.5 MiB
constexpr double memory_of_splits = 0.9;
constexpr double share_of_evaluation = 0.5;   // of a frame that draws the surface as well: a guess
constexpr double share_for_splitting = 0.25;  // of a frame's time, beside it: no frame shows that there is more to prove
constexpr std::uint32_t least_hits = 8, most_hits = 1u << 20;
constexpr double frames_a_span = 16.0;
constexpr std::uint32_t longest_pause = 256;
constexpr std::uint32_t most_frames_full = 600;
constexpr std::array<std::uint32_t, 4> bindings_of_tree{DMVV_BIND_VERDICT_WORDS, DMVV_BIND_VERDICT_HITS, DMVV_BIND_OUTCOMES,
                                      DMVV_BIND_BUSY_CELLS};

template <class T>
std::span<T> mapped(const GpuBuffer& buffer) {
  return {static_cast<T*>(buffer.mapped), static_cast<std::size_t>(buffer.bytes / sizeof(T))};
}

}  // namespace

Verdicts::Verdicts(const Device::Impl& gpu, std::shared_ptr<const compiler::Judge> judge) : judge_(std::move(judge)) {
  constexpr auto storage = vk::BufferUsageFlagBits::eStorageBuffer;
  words_ = gpu.make_buffer(2 * 4 * most_words, storage, MemoryUse::upload);
  hits_ = gpu.make_buffer(2 * 4 * most_words, storage, MemoryUse::upload);
  outcomes_ = gpu.make_buffer(2 * sizeof(gpu::RegionRecord) * most_outcomes, storage, MemoryUse::upload);
  busy_ = gpu.make_buffer(4 * (1 + DMVV_MOST_BUSY_CELLS), storage, MemoryUse::readback);

  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (const std::uint32_t binding : bindings_of_tree) {
    bindings.push_back({.binding = binding,
                        .descriptorType = vk::DescriptorType::eStorageBuffer,
                        .descriptorCount = 1,
                        .stageFlags = vk::ShaderStageFlagBits::eCompute});
  }
  layout_ = gpu.device.createDescriptorSetLayout(vk::DescriptorSetLayoutCreateInfo{}.setBindings(bindings));
  const vk::DescriptorPoolSize size{vk::DescriptorType::eStorageBuffer, bindings_of_tree.size()};
  pool_ = gpu.device.createDescriptorPool({.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                           .maxSets = 1,
                                           .poolSizeCount = 1,
                                           .pPoolSizes = &size});
  const vk::DescriptorSetLayout handle = *layout_;
  set_ = std::move(gpu.device.allocateDescriptorSets({.descriptorPool = *pool_, .descriptorSetCount = 1, .pSetLayouts = &handle})[0]);
  const std::array buffers{&words_, &hits_, &outcomes_, &busy_};
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const vk::DescriptorBufferInfo info{*buffers[i]->buffer, 0, VK_WHOLE_SIZE};
    gpu.device.updateDescriptorSets(vk::WriteDescriptorSet{.dstSet = *set_,
                                                           .dstBinding = bindings_of_tree[i],
                                                           .descriptorCount = 1,
                                                           .descriptorType = vk::DescriptorType::eStorageBuffer,
                                                           .pBufferInfo = &info},
                                    nullptr);
  }
  const auto part = [&](std::size_t i) {
    return compiler::VerdictTree::Memory{mapped<std::uint32_t>(words_).subspan(i * most_words, most_words),
                                         mapped<std::uint32_t>(hits_).subspan(i * most_words, most_words),
                                         mapped<gpu::RegionRecord>(outcomes_).subspan(i * most_outcomes, most_outcomes)};
  };
  always_.memory = part(0);
  span_.memory = part(1);
  always_.tree.emplace(*judge_, judge_->always(), always_.memory);
}

// ---- spans of time ----

/// While the time stands still a span is that moment; while it goes on, some frames.
void Verdicts::begin_frame(double time_ms) {
  mapped<std::uint32_t>(busy_).front() = 0;
  if (!judge_->is_animated()) return;
  const bool is_within = times_ && times_->span_ms().lo <= time_ms && time_ms <= times_->span_ms().hi;
  if (!is_within) begin_span(time_ms);
  last_time_ms_ = time_ms;
  has_time_ = true;
}

void Verdicts::begin_span(double time_ms) {
  judge_span();
  span_.tree.reset();
  span_.busy.clear();
  times_.reset();
  const double end = has_time_ ? time_ms + (frames_a_span - 1.0) * (time_ms - last_time_ms_) : time_ms;
  if (pause_ > 0 && end != time_ms) {
    --pause_;
    return;
  }
  times_ = judge_->times({std::min(time_ms, end), std::max(time_ms, end)});
  span_.tree.emplace(*judge_, *times_, span_.memory);
}

/// Was the span worth it? If not, the next ones are left out, more and more.
void Verdicts::judge_span() {
  if (!times_) return;
  if (saved_ns_ < spent_ns_) {
    pause_ = next_pause_;
    next_pause_ = std::min(2 * next_pause_, longest_pause);
  } else {
    next_pause_ = 1;
  }
  spent_ns_ = saved_ns_ = 0.0;
  first_count_ = 0;
}

// ---- splitting ----

std::uint32_t Verdicts::hits_to_split() const {
  if (ns_a_pixel_ == 0.0) return most_hits;
  return static_cast<std::uint32_t>(std::clamp(0.5 * ns_a_cell() / ns_a_pixel_, double{least_hits}, double{most_hits}));
}

void Verdicts::fill(gpu::PixelsParams& params) const {
  params.hits_to_split = hits_to_split();
  params.first_span_word = span_.tree ? most_words : 0;
  params.first_span_outcome = most_outcomes;
  // While time goes on, what is found to stand still or to be the same for ever is worth more than what holds for a span.
  params.counts_both = judge_->is_animated() && (!times_ || times_->span_ms().lo < times_->span_ms().hi);
}

double Verdicts::end_frame(std::uint32_t evaluated, double ms, bool drew) {
  // Few pixels are measured badly: what a frame costs anyway would be counted as theirs.
  if (2 * evaluated >= most_evaluated_ && evaluated != 0 && !(drew && is_pixel_measured_)) {
    most_evaluated_ = std::max<std::size_t>(most_evaluated_, evaluated);
    is_pixel_measured_ = !drew;
    ns_a_pixel_ = 1e6 * ms / evaluated * (drew ? share_of_evaluation : 1.0);
  }
  // What the span's verdicts save is seen against its first frame, which has few of them.
  first_count_ = std::max(first_count_, evaluated);
  saved_ns_ += ns_a_pixel_ * (first_count_ - evaluated);
  const auto busy = mapped<std::uint32_t>(busy_);
  const auto hits = mapped<std::uint32_t>(hits_);
  for (const std::uint32_t cell : busy.subspan(1, std::min<std::size_t>(busy.front(), DMVV_MOST_BUSY_CELLS))) {
    if ((hits[cell] & DMVV_VERDICT_NOTED) != 0) continue;
    hits[cell] |= DMVV_VERDICT_NOTED;
    const bool is_of_span = cell >= most_words;
    (is_of_span ? span_ : always_).busy.push_back(is_of_span ? cell - static_cast<std::uint32_t>(most_words) : cell);
  }
  const auto affordable = static_cast<std::size_t>(share_for_splitting * 1e6 * ms / ns_a_cell()) + 1;
  const std::size_t for_always = std::min(affordable, always_.busy.size());
  return split(always_, for_always) + split(span_, affordable - for_always);
}

double Verdicts::split(Grove& grove, std::size_t most_cells) {
  using Clock = std::chrono::steady_clock;
  const std::vector<std::uint32_t> cells(grove.busy.begin(), grove.busy.begin() + static_cast<std::ptrdiff_t>(std::min(most_cells, grove.busy.size())));
  if (cells.empty()) return 0.0;
  grove.busy.erase(grove.busy.begin(), grove.busy.begin() + static_cast<std::ptrdiff_t>(cells.size()));
  if (grove.tree->is_full()) {  // after a while, what is looked at is worth more than what was
    if (++grove.frames_full < most_frames_full) return 0.0;
    grove.frames_full = 0;
    grove.busy.clear();
    const compiler::Judge::Times& times = &grove == &span_ ? *times_ : judge_->always();
    grove.tree.emplace(*judge_, times, grove.memory);
    return 0.0;
  }
  const auto start = Clock::now();
  const std::size_t count = grove.tree->split(cells);
  const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
  split_ns_ = memory_of_splits * split_ns_ + ns;
  split_cells_ = memory_of_splits * split_cells_ + static_cast<double>(count);
  if (&grove == &span_) spent_ns_ += ns;
  return 1e-6 * ns;
}

}  // namespace dmvv::runtime
