#include "runtime/frame/points.h"

#include <algorithm>
#include <array>
#include <bit>

#include "shaders/records.h"

namespace dmvv::runtime {
namespace {

using compiler::PointAnswer;

constexpr std::array<SetBinding, 2> io_bindings{
    {{DMVV_BIND_POINTS, vk::DescriptorType::eStorageBuffer}, {DMVV_BIND_ANSWERS, vk::DescriptorType::eStorageBuffer}}};

std::size_t answer_words(std::uint32_t depth) { return DMVV_ANSWER_HEADER + 2 * std::size_t{depth}; }

/// Reads the answer that starts at `words`; empty if the device's path is longer than the program can have.
std::optional<PointAnswer> decode_answer(const std::uint32_t* words, std::uint32_t depth) {
  PointAnswer answer;
  answer.number = words[0];
  answer.finished = words[0] != DMVV_UNFINISHED;
  if (words[1] > depth) return std::nullopt;
  for (int i = 0; i < 4; ++i) answer.rgba[i] = std::bit_cast<float>(words[2 + i]);
  for (std::uint32_t level = 0; level < words[1]; ++level) {
    const std::uint32_t* step = words + DMVV_ANSWER_HEADER + 2 * level;
    answer.path.push_back({step[0], step[1]});
  }
  return answer;
}

}  // namespace

/// Points and answers are read and written in place.
struct PointProbe::Batch {
  std::size_t points;
  GpuBuffer positions, answers;
  DescriptorSet set;

  Batch(const Device::Impl& gpu, const vk::raii::DescriptorSetLayout& layout, std::size_t wanted, std::uint32_t depth)
      : points(most_points(wanted, depth)), set(gpu, layout, io_bindings) {
    const auto storage = vk::BufferUsageFlagBits::eStorageBuffer;
    positions = gpu.make_buffer(points * sizeof(glm::vec4), storage, MemoryUse::upload);
    answers = gpu.make_buffer(points * answer_words(depth) * 4, storage, MemoryUse::readback);
    set.write(DMVV_BIND_POINTS, positions);
    set.write(DMVV_BIND_ANSWERS, answers);
  }

 private:
  static std::size_t most_points(std::size_t wanted, std::uint32_t depth) {
    constexpr std::size_t answer_budget = std::size_t{32} << 20, largest = std::size_t{1} << 18;
    const std::size_t affordable = std::max<std::size_t>(1, answer_budget / (4 * answer_words(depth)));
    return std::min({largest, affordable, std::max<std::size_t>(1, wanted)});
  }
};

PointProbe::PointProbe(const Device::Impl& gpu, const SceneOnDevice& scene, const compiler::Program& program)
    : gpu_(gpu), scene_(scene), depth_(program.depth) {
  if (const auto* kernel = program.find_kernel(compiler::points_kernel.name)) code_ = kernel->shaders.front().spirv;
}

Result<void> PointProbe::make_kernel() {
  if (code_.empty()) return fail(Fault::environment, "the program was compiled without its kernel 'points'");
  io_layout_ = make_set_layout(gpu_, io_bindings);
  layout_ = make_pipeline_layout(gpu_, std::array{*scene_.layout(), *io_layout_}, sizeof(gpu::PointsParams));
  pipeline_ = make_compute_pipeline(gpu_, code_, layout_);
  return {};
}

double PointProbe::dispatch(const Batch& batch, std::uint32_t count) const {
  return gpu_.run([&](const vk::raii::CommandBuffer& commands) {
    const auto compute = vk::PipelineBindPoint::eCompute;
    const gpu::PointsParams params{.count = count, .pad0 = 0, .pad1 = 0, .pad2 = 0};
    commands.bindPipeline(compute, **pipeline_);
    commands.bindDescriptorSets(compute, *layout_, 0, {scene_.set(), *batch.set}, nullptr);
    commands.pushConstants<gpu::PointsParams>(*layout_, vk::ShaderStageFlagBits::eCompute, 0, params);
    commands.dispatch(std::max(1u, (count + DMVV_POINTS_GROUP_SIZE - 1) / DMVV_POINTS_GROUP_SIZE), 1, 1);
    const vk::MemoryBarrier visible{.srcAccessMask = vk::AccessFlagBits::eShaderWrite,
                                    .dstAccessMask = vk::AccessFlagBits::eHostRead};
    commands.pipelineBarrier(vk::PipelineStageFlagBits::eComputeShader, vk::PipelineStageFlagBits::eHost, {}, visible,
                             nullptr, nullptr);
  });
}

Result<std::vector<PointAnswer>> PointProbe::probe(std::span<const glm::dvec3> positions, Timings* timings) {
  // ---- the kernel, compiled by the driver in an empty dispatch ----
  const bool first_use = !pipeline_;
  std::optional<Batch> batch;
  {
    const Stopwatch watch(first_use ? timings : nullptr, "pipeline");
    if (first_use) {
      if (auto made = make_kernel(); !made) return tl::unexpected(std::move(made.error()));
    }
    batch.emplace(gpu_, io_layout_, positions.size(), depth_);
    if (first_use) dispatch(*batch, 0);
  }

  // ---- batch after batch ----
  const Stopwatch watch(timings, "probe");
  std::vector<PointAnswer> answers;
  answers.reserve(positions.size());
  std::vector<std::size_t> unfinished;
  double gpu_ms = 0.0;
  for (std::size_t begin = 0; begin < positions.size(); begin += batch->points) {
    const std::size_t count = std::min(batch->points, positions.size() - begin);
    auto* texels = static_cast<glm::vec4*>(batch->positions.mapped);
    for (std::size_t i = 0; i < count; ++i) texels[i] = glm::vec4(glm::vec3(positions[begin + i]), 1.0f);
    gpu_ms += dispatch(*batch, static_cast<std::uint32_t>(count));
    const auto* words = static_cast<const std::uint32_t*>(batch->answers.mapped);
    for (std::size_t i = 0; i < count; ++i) {
      auto answer = decode_answer(words + i * answer_words(depth_), depth_);
      if (!answer)
        return fail(Fault::environment, fmt::format("the device's answer for point {} makes no sense", begin + i));
      if (!answer->finished) unfinished.push_back(begin + i);
      answers.push_back(std::move(*answer));
    }
  }
  if (timings != nullptr && gpu_.queue.is_timed()) timings->push_back({gpu_step, gpu_ms});
  if (!unfinished.empty()) {
    return fail(
        Fault::input,
        fmt::format("{} of {} points needed more loop rounds than this device grants (65,535); the first is point {}",
                    unfinished.size(), positions.size(), unfinished.front()),
        {"use the reference backend, or split the scene's longest lists of seeds"});
  }
  return answers;
}

}  // namespace dmvv::runtime
