#include "runtime/verdicts.h"

#include <algorithm>
#include <array>
#include <chrono>

namespace dmvv::runtime {
namespace {

constexpr std::size_t most_words = std::size_t{4} << 20;     // 16 MiB, and as much for their hits
constexpr std::size_t most_outcomes = std::size_t{1} << 15;  // 3.5 MiB
constexpr std::size_t enough_cells = 16;  // to be measured
constexpr std::uint32_t least_hits = 8, most_hits = 1u << 20;
constexpr std::array<std::uint32_t, 4> bindings_of_tree{DMVV_BIND_VERDICT_WORDS, DMVV_BIND_VERDICT_HITS, DMVV_BIND_OUTCOMES,
                                      DMVV_BIND_BUSY_CELLS};

template <class T>
std::span<T> mapped(const GpuBuffer& buffer) {
  return {static_cast<T*>(buffer.mapped), static_cast<std::size_t>(buffer.bytes / sizeof(T))};
}

}  // namespace

Verdicts::Verdicts(const Device::Impl& gpu, std::shared_ptr<const compiler::Judge> judge) : judge_(std::move(judge)) {
  constexpr auto storage = vk::BufferUsageFlagBits::eStorageBuffer;
  words_ = gpu.make_buffer(4 * most_words, storage, MemoryUse::upload);
  hits_ = gpu.make_buffer(4 * most_words, storage, MemoryUse::upload);
  outcomes_ = gpu.make_buffer(sizeof(gpu::RegionRecord) * most_outcomes, storage, MemoryUse::upload);
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
  begin_tree();
}

void Verdicts::begin_tree() {
  tree_.emplace(*judge_, judge_->always(),
                compiler::VerdictTree::Memory{mapped<std::uint32_t>(words_), mapped<std::uint32_t>(hits_),
                                              mapped<gpu::RegionRecord>(outcomes_)});
  ++generation_;
}

std::uint32_t Verdicts::hits_to_split() const {
  if (ns_a_pixel_ == 0.0) return most_hits;
  return static_cast<std::uint32_t>(std::clamp(ns_a_cell_ / ns_a_pixel_, double{least_hits}, double{most_hits}));
}

void Verdicts::begin_frame() { mapped<std::uint32_t>(busy_).front() = 0; }

void Verdicts::end_frame(std::size_t evaluated, double ms) {
  using Clock = std::chrono::steady_clock;
  // Few pixels are measured badly: what a frame costs anyway would be counted as theirs.
  if (2 * evaluated >= most_evaluated_ && evaluated != 0) {
    most_evaluated_ = std::max(most_evaluated_, evaluated);
    ns_a_pixel_ = 1e6 * ms / static_cast<double>(evaluated);
  }
  const auto busy = mapped<std::uint32_t>(busy_);
  if (getenv("DBG")) fprintf(stderr, "frame %.1f ms evaluated %zu ns/px %.0f ns/cell %.0f hits %u named %u words %zu\n", ms, evaluated, ns_a_pixel_, ns_a_cell_, hits_to_split(), busy.front(), tree_->word_count());
  const std::size_t named = std::min<std::size_t>(busy.front(), DMVV_MOST_BUSY_CELLS);
  if (named == 0) return;
  if (tree_->is_full()) return begin_tree();
  const auto affordable = static_cast<std::size_t>(1e6 * ms / ns_a_cell_) + 1;
  const auto cells = busy.subspan(1, std::min(named, affordable));
  const auto start = Clock::now();
  const std::size_t split = tree_->split(cells);
  if (split == 0) return;
  ++generation_;
  const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
  if (split >= enough_cells) ns_a_cell_ = ns / static_cast<double>(split);
}

}  // namespace dmvv::runtime
