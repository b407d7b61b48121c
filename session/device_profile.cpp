// Each figure is the difference between two programs that differ in one thing, divided by how often that is in there.
#include "session/device_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "compiler/snippet/program.h"

namespace dmvv::session {

namespace {

using compiler::Affine;
using compiler::Codegen;
using compiler::DeviceCosts;

constexpr std::uint32_t version = 2;  // of the measuring, in the cache's key
constexpr glm::uvec2 size_px{256, 256};
constexpr double points = 256.0 * 256.0;
constexpr int repeats = 3;
constexpr std::size_t many = 16;  // decisions, candidates
constexpr std::size_t long_lines = 200;

/// f = p.x, then `lines` times f = f * p.y + 1: nothing that a compiler could fold.
compiler::Function chain_function(std::size_t lines) {
  using compiler::snippet::Op, compiler::snippet::Program, compiler::snippet::Type;
  auto program = std::make_shared<Program>();
  program->constants = {{Type::real, std::bit_cast<std::uint32_t>(1.0f)}};
  const auto first = static_cast<compiler::snippet::Register>(Program::input_count + 1);
  compiler::snippet::Register value = Program::p_x;
  for (std::size_t i = 0; i < lines; ++i) {
    const auto next = first + static_cast<compiler::snippet::Register>(2 * i);
    program->temporaries.insert(program->temporaries.end(), 2, Type::real);
    program->instructions.push_back({Op::f_mul, next, {value, Program::p_y}});
    program->instructions.push_back({Op::f_add, next + 1, {next, Program::input_count}});
    value = next + 1;
  }
  program->result = value;
  compiler::snippet::Node run;
  run.count = static_cast<std::uint32_t>(program->instructions.size());
  program->body.push_back(std::move(run));
  return {"CHAIN", compiler::snippet::Snippet(std::move(program))};
}

/// A scene of one object, made by hand; regions are red where a decision is negative, empty at the end.
struct Scene {
  compiler::Module module;

  Scene() {
    module.root = {0};
    module.objects.push_back({"ROOT", {}, {}});
  }

  Id<compiler::Region> region(std::uint32_t number) {
    compiler::Region region;
    region.object = {0};
    region.number = number;
    region.kind = number == 0 ? voml::RegionKind::empty : voml::RegionKind::color;
    module.regions.push_back(std::move(region));
    return {static_cast<std::uint32_t>(module.regions.size() - 1)};
  }
  Id<compiler::Node> leaf(Id<compiler::Region> region) { return node({region}); }
  Id<compiler::Node> node(compiler::Node node) {
    module.nodes.push_back(std::move(node));
    return {static_cast<std::uint32_t>(module.nodes.size() - 1)};
  }
  /// A decision that is negative below `iso`.
  Id<compiler::Node> decision(std::variant<Id<voml::Grid>, Id<compiler::Function>> source, double iso,
                              Id<compiler::Node> positive, Id<compiler::Node> negative) {
    compiler::Sdf sdf;
    sdf.source = source;
    sdf.iso = iso;
    sdf.local_from_object = {Affine{}};
    module.sdfs.push_back(std::move(sdf));
    return node({compiler::Decision{{static_cast<std::uint32_t>(module.sdfs.size() - 1)}, positive, negative}});
  }
};

/// `count` decisions after one another; no point is below any iso, so all are asked.
compiler::Module decisions(std::size_t count, std::size_t lines) {
  Scene scene;
  scene.module.functions.push_back(chain_function(lines));
  const Id<compiler::Node> inside = scene.leaf(scene.region(1));
  Id<compiler::Node> next = scene.leaf(scene.region(0));
  for (std::size_t i = 0; i < count; ++i)
    next = scene.decision(Id<compiler::Function>{0}, -100.0 - static_cast<double>(i), next, inside);
  scene.module.objects[0].root = next;
  return std::move(scene.module);
}

/// As many grids, each asked once.
compiler::Module grids(std::size_t count) {
  Scene scene;
  voml::Grid grid;
  grid.size = glm::uvec3(8);
  grid.box_lo = glm::dvec3(-1.0);
  grid.box_hi = glm::dvec3(1.0);
  const Id<compiler::Node> inside = scene.leaf(scene.region(1));
  Id<compiler::Node> next = scene.leaf(scene.region(0));
  for (std::size_t i = 0; i < count; ++i) {
    grid.values.assign(512, 1.0f + static_cast<float>(i));
    scene.module.grids.push_back(grid);
    next = scene.decision(Id<voml::Grid>{static_cast<std::uint32_t>(i)}, 0.0, next, inside);
  }
  scene.module.objects[0].root = next;
  return std::move(scene.module);
}

/// A long function behind a decision that no point takes.
compiler::Module skipped(std::size_t lines) {
  Scene scene;
  scene.module.functions = {chain_function(0), chain_function(lines)};
  const Id<compiler::Node> empty = scene.leaf(scene.region(0)), inside = scene.leaf(scene.region(1));
  const Id<compiler::Node> hidden = scene.decision(Id<compiler::Function>{1}, -100.0, empty, inside);
  scene.module.objects[0].root = scene.decision(Id<compiler::Function>{0}, -100.0, empty, hidden);
  return std::move(scene.module);
}

/// An object that all points ask `count` times and that holds none of them.
compiler::Module candidates(std::size_t count) {
  Scene scene;
  const Id<compiler::Region> region = scene.region(0);
  scene.module.objects[0].root = scene.leaf(region);
  scene.module.objects.push_back({"TINY", scene.leaf(scene.region(1)), {}});
  compiler::CandidateGroup group;
  for (std::size_t i = 0; i < count; ++i) {
    const double away = 1e4 + static_cast<double>(i);
    group.candidates.push_back({{1}, Affine{glm::dmat3(1e4), glm::dvec3(away)}, false});
  }
  scene.module.regions[region.index].groups.push_back(std::move(group));
  scene.module.depth = 2;
  return std::move(scene.module);
}

class Calibration {
 public:
  explicit Calibration(runtime::Device& device) : device_(device) {}

  /// Nothing if a program could not be measured.
  std::optional<DeviceCosts> run(DeviceCosts costs) {
    const double base = cost(decisions(1, 1), Codegen::specialised);
    const double lines = cost(decisions(1, long_lines), Codegen::specialised) - base;
    const double hidden = cost(skipped(long_lines), Codegen::specialised) - base;
    const double sampled = cost(grids(many), Codegen::specialised) - base;
    const double walked = cost(decisions(many, 1), Codegen::table) - cost(decisions(1, 1), Codegen::table);
    const double asked = cost(candidates(many), Codegen::specialised) - base;
    const double visited = cost(candidates(many), Codegen::table) - cost(decisions(1, 1), Codegen::table);
    if (failed_) return std::nullopt;
    costs.line = std::max(lines / long_lines, costs.line * 0.1);
    costs.skipping = std::clamp(1.0 - hidden / std::max(lines, 1e-9), 0.0, 1.0);
    costs.sample = std::max(sampled / many, costs.line);
    costs.step = std::max(walked / (many - 1), costs.line);
    costs.search = std::max(asked / many, costs.line);
    costs.visit = std::max(visited / many, costs.step);
    return costs;
  }

 private:
  /// Nanoseconds a point: the least of some tries.
  double cost(compiler::Module module, Codegen codegen) {
    Diagnostics diagnostics;
    compiler::CompileOptions options;
    fit_to(device_, options);
    options.codegen = codegen;
    options.disabled_passes = {"index", "merge-assets", "prune-sides", "drop-unreachable"};
    auto program = compiler::compile(std::move(module), options, diagnostics);
    if (!program || !compiler::to_spirv(*program, compiler::Source::surface)) return fail();
    auto evaluator = runtime::Evaluator::create(device_, *program);
    if (!evaluator) return fail();
    runtime::View view;
    view.size_px = size_px;
    view.slice = runtime::Plane{{0.0, 0.0, 1.0}, 0.1};
    view.colors = runtime::Colors::bytes;
    view.disabled_passes = {"keep-picture"};
    double least_ms = 1e9;
    for (int i = 0; i < repeats; ++i) {
      runtime::Timings timings;
      if (!evaluator->render(view, &timings)) return fail();
      const auto gpu = std::ranges::find(timings, runtime::gpu_step, &runtime::Timing::step);
      if (gpu == timings.end()) return fail();
      least_ms = std::min(least_ms, gpu->ms);
    }
    return 1e6 * least_ms / points;
  }

  double fail() {
    failed_ = true;
    return 0.0;
  }

  runtime::Device& device_;
  bool failed_ = false;
};

std::string key_of(const runtime::DeviceInfo& device) {
  return fmt::format("device costs {}\n{}\n{}\n{}", version, device.name, device.driver, device.api_version);
}

DeviceCosts costs_of_kind(const runtime::DeviceInfo& device) {
  return device.kind == "cpu" ? compiler::costs_of_cpu() : compiler::costs_of_gpu();
}

std::optional<DeviceCosts> find(const runtime::Device& device) {
  const std::shared_ptr<const runtime::DiskCache> cache = device.cache();
  const auto kept = cache ? cache->find(key_of(device.info())) : std::nullopt;
  if (!kept || kept->size() != sizeof(DeviceCosts)) return std::nullopt;
  DeviceCosts costs;
  std::memcpy(&costs, kept->data(), sizeof costs);
  return costs;
}

}  // namespace

DeviceCosts costs_of(const runtime::Device& device) { return find(device).value_or(costs_of_kind(device.info())); }

void fit_to(const runtime::Device& device, compiler::CompileOptions& options) {
  const runtime::DeviceInfo& info = device.info();
  options.max_extent_3d = info.max_extent_3d;
  options.max_storage_buffer = info.max_storage_buffer;
  options.max_texel_buffer_elements = info.kind == "cpu" ? info.max_texel_buffer_elements : 0;
  options.costs = costs_of(device);
}

void calibrate(runtime::Device& device) {
  const std::shared_ptr<const runtime::DiskCache> cache = device.cache();
  if (!cache || find(device)) return;
  const auto measured = Calibration(device).run(costs_of_kind(device.info()));
  if (!measured) return;
  static_assert(std::is_trivially_copyable_v<DeviceCosts>);
  cache->keep(key_of(device.info()), std::string(reinterpret_cast<const char*>(&*measured), sizeof *measured));
}

}  // namespace dmvv::session
