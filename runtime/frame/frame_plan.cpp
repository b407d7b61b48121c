#include "runtime/frame/frame_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dmvv::runtime {
namespace {

constexpr std::array<const char*, resource_count> resource_names{"surface", "tiles",  "notes",   "media",  "pixels",
                                                                 "lists",   "known",  "leaders", "queues", "verdicts",
                                                                 "hits",    "faults", "report",  "home"};
constexpr std::array<const char*, DMVV_LISTS_OF_PIXELS> list_names{"open", "left", "leaders", "proven"};

/// Adds the steps that evaluate the pixels of a list.
void evaluate_list(std::uint32_t list, const std::vector<bool>& stages_go_on, std::vector<PlannedStep>& steps) {
  if (stages_go_on.empty()) {
    steps.push_back({Step::evaluate, list});
    return;
  }
  steps.push_back({Step::count_stages, list});
  for (std::uint32_t stage = 0; stage < stages_go_on.size(); ++stage) {
    steps.push_back({Step::stage, list, stage});
    if (!stages_go_on[stage]) continue;
    steps.push_back({Step::distribute, list, stage});
    steps.push_back({Step::count_stages, list});
  }
}

void draw_surface(const FrameRequest& request, std::vector<PlannedStep>& steps) {
  if (request.surface != SurfaceKind::rays) {
    steps.push_back({request.surface == SurfaceKind::slice ? Step::slice : Step::raster});
    return;
  }
  for (const Step step : {Step::set_out, Step::cones, Step::trace}) steps.push_back({step});
  if (request.has_media) steps.push_back({Step::media});
  if (request.wants_normals) steps.push_back({Step::normals});
}

std::vector<PlannedStep> plan_tile(const FrameRequest& request, const KeptTile& kept) {
  const auto& [classifies, leads] = request.strategy;
  std::vector<PlannedStep> steps;
  if (request.passes.keep_picture && kept.picture) {
    if (request.brings_home && !kept.home) steps.push_back({Step::bring_home});
    return steps;
  }
  if (!(request.passes.keep_surface && kept.surface)) {
    draw_surface(request, steps);
  }
  steps.push_back({Step::clear});
  const bool lists = request.passes.pixel_list || !request.stages_go_on.empty();
  if (!lists) {
    steps.push_back({Step::evaluate});
  } else {
    steps.push_back({classifies ? Step::classify : Step::list});
    steps.push_back({Step::count_lists});
    if (classifies) steps.push_back({Step::paint, DMVV_TO_PAINT});
    if (leads) {
      steps.push_back({Step::lead, DMVV_LEADERS_OF_TILES});
      steps.push_back({Step::follow, DMVV_TO_EVALUATE});
      steps.push_back({Step::count_lists});
    }
    const std::uint32_t open = leads ? DMVV_LEFT : DMVV_TO_EVALUATE;
    evaluate_list(open, request.stages_go_on, steps);
    if (classifies) steps.push_back({Step::count_hits, open});
    if (classifies && leads) steps.push_back({Step::count_hits, DMVV_LEADERS_OF_TILES});
  }
  if (request.surface == SurfaceKind::rays && request.has_media) steps.push_back({Step::compose});
  steps.push_back({Step::report});
  if (request.brings_home) steps.push_back({Step::bring_home});
  return steps;
}

/// Uses since the last wait.
class Hazards {
 public:
  bool meet(const StepUse& use) const {
    const auto any = [](const std::vector<Resource>& resources, auto is_hazard) {
      return std::ranges::any_of(resources, [&](Resource r) { return is_hazard(static_cast<std::size_t>(r)); });
    };
    return any(use.reads, [&](std::size_t r) { return added_[r] || written_[r]; }) ||
           any(use.adds, [&](std::size_t r) { return written_[r]; }) ||
           any(use.writes, [&](std::size_t r) { return read_[r] || added_[r] || written_[r]; });
  }
  void add(const StepUse& use) {
    for (const Resource r : use.reads) read_[static_cast<std::size_t>(r)] = true;
    for (const Resource r : use.adds) added_[static_cast<std::size_t>(r)] = true;
    for (const Resource r : use.writes) written_[static_cast<std::size_t>(r)] = true;
  }

 private:
  std::array<bool, resource_count> read_{}, added_{}, written_{};
};

std::string words(const std::vector<Resource>& resources) {
  std::string text;
  for (const Resource r : resources) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", resource_names[static_cast<std::size_t>(r)]);
  }
  return text;
}

std::string step_text(const PlannedStep& planned) {
  const StepUse& use = use_of(planned.step);
  const bool is_of_stage = planned.step == Step::stage || planned.step == Step::distribute;
  std::string name = is_of_stage ? fmt::format("{} {}", use.name, planned.stage) : use.name;
  if (planned.list != no_list) name += fmt::format(" over {}", list_names[planned.list]);
  std::vector<Resource> made = use.adds;
  made.insert(made.end(), use.writes.begin(), use.writes.end());
  return fmt::format("{:<26} {:<32} -> {}", name, words(use.reads), words(made));
}

}  // namespace

const StepUse& use_of(Step step) {
  using R = Resource;
  static const std::array<StepUse, step_count> uses{{
      {"raster", {}, {}, {R::surface}},
      {"slice", {}, {}, {R::surface}},
      {"set out", {}, {}, {R::tiles, R::surface, R::notes, R::media}},
      {"cones", {}, {}, {R::tiles}},
      {"trace", {}, {}, {R::tiles, R::surface, R::notes}},
      {"media", {}, {}, {R::tiles, R::surface, R::notes, R::media}},
      {"normals", {R::tiles, R::notes}, {}, {R::surface}},
      {"clear", {}, {}, {R::pixels, R::lists, R::leaders, R::queues, R::faults}},
      {"list", {R::surface}, {}, {R::lists}},
      {"classify", {R::surface, R::verdicts}, {}, {R::lists, R::known}},
      {"count lists", {}, {}, {R::lists}},
      {"paint", {R::surface, R::lists, R::known, R::verdicts}, {R::pixels}, {}},
      {"lead", {R::surface, R::lists}, {R::pixels, R::faults}, {R::leaders}},
      {"follow", {R::surface, R::leaders}, {R::pixels}, {R::lists, R::known}},
      {"evaluate", {R::surface, R::lists}, {R::pixels, R::faults}, {}},
      {"count stages", {R::lists}, {}, {R::queues}},
      {"stage", {R::surface, R::lists}, {R::pixels, R::faults}, {R::queues}},
      {"distribute", {R::lists}, {}, {R::queues}},
      {"compose", {R::media}, {}, {R::pixels}},
      {"count hits", {R::lists, R::known, R::verdicts}, {R::hits}, {}},
      {"report", {R::lists, R::faults, R::tiles}, {}, {R::report}},
      {"bring home", {R::surface, R::notes, R::pixels}, {}, {R::home}},
  }};
  return uses[static_cast<std::size_t>(step)];
}

bool is_evaluated(const TilePlan& tile) {
  return std::ranges::find(tile.steps, Step::clear, &PlannedStep::step) != tile.steps.end();
}

bool is_kept(const FrameRequest& request) {
  return request.passes.keep_picture && std::ranges::all_of(request.kept, &KeptTile::picture);
}

FramePlan plan_frame(const FrameRequest& request) {
  FramePlan plan{request.size_px, request.strategy, {}};
  for (std::size_t i = 0; i < request.tiles.size(); ++i) {
    const KeptTile& kept = request.kept[i];
    TilePlan tile{request.tiles[i], false, plan_tile(request, kept)};
    const bool keeps_surface = !tile.steps.empty() && tile.steps.front().step == Step::clear;
    tile.keeps_still = keeps_surface && request.strategy.classifies && request.passes.keep_still && kept.other_time;
    plan.tiles.push_back(std::move(tile));
  }
  return plan;
}

std::vector<bool> waits(std::span<const PlannedStep> steps) {
  std::vector<bool> result;
  Hazards hazards;
  for (const PlannedStep& planned : steps) {
    const StepUse& use = use_of(planned.step);
    result.push_back(hazards.meet(use));
    if (result.back()) hazards = {};
    hazards.add(use);
  }
  return result;
}

std::string to_text(const FramePlan& plan) {
  std::string text = fmt::format("frame {}x{}, {} tile{}{}{}\n", plan.size_px.x, plan.size_px.y, plan.tiles.size(),
                                 plan.tiles.size() == 1 ? "" : "s", plan.strategy.classifies ? ", verdicts" : "",
                                 plan.strategy.leads ? ", leaders" : "");
  for (const TilePlan& tile : plan.tiles) {
    text += fmt::format("tile {} {}, {}x{}{}{}\n", tile.tile.corner_px.x, tile.tile.corner_px.y, tile.tile.size_px.x,
                        tile.tile.size_px.y, is_evaluated(tile) ? "" : ", kept",
                        tile.keeps_still ? ", what stands still is kept" : "");
    const std::vector<bool> waiting = waits(tile.steps);
    for (std::size_t i = 0; i < tile.steps.size(); ++i) {
      text += fmt::format("{} {}\n", waiting[i] ? "  wait " : "       ", step_text(tile.steps[i]));
    }
  }
  return text;
}

}  // namespace dmvv::runtime
