// The evaluation in parts (compiler/plan/stage_plan.h).
#include "compiler/glsl/generator.h"

namespace dmvv::compiler {

void Generator::emit_stages() {
  if (options_.stages) stages_ = plan_stages(module_, plan_, *options_.stages);
  out_.stage_count = stages_.numbers.empty() ? 0 : static_cast<std::uint32_t>(stages_.numbers.size() + 1);
  if (stages_.numbers.empty() || !options_.write_stages) return;
  emit_stage(0, [&] {
    const std::string root = emit_divided({}, module_.root);
    open("void stage_0(vec3 p)");
    line("{}(p, 0u);", root);
    close();
  });
  for (const auto& stage : stages_.numbers) {
    emit_stage(stage.second, [&] { emit_stage_from(stage.second, stage.first.first, stage.first.second); });
  }
  stage_.reset();
}

void Generator::emit_stage(std::uint32_t number, const std::function<void()>& emit) {
  stage_ = number;
  divided_ = 0;
  emit();
  line("");
  add(stage_name(number));
  out_.stages.emplace_back();
}

void Generator::emit_stage_from(std::uint32_t number, const Way& way, std::size_t group) {
  Continuation continued{.first = group, .way = &way, .last = emit_last(way)};
  guard_.clear();
  open(fmt::format("void {}(vec3 p)", stage_name(number)));
  line("uint level = {}u;", fmt::format("{}", way.size() - 1));
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    line("vec3 p_{} = p;", fmt::format("{}", i));
    const Affine& affine = at(module_.regions, way[i]).groups.back().candidates.front().local_from_parent;
    line("p = {};", affine_expression(affine, "p", options_.fold_affine));
  }
  emit_candidates(way.back(), true, continued);
  for (std::size_t i = way.size(); i-- > 0;) {
    const std::uint32_t answered = at(module_.regions, way[i]).number;
    const std::string p = i + 1 == way.size() ? "p" : fmt::format("p_{}", i);
    if (answered != 0)
      line("{}", fmt::format("if ({}) answer({}u, {}u, {}, {}u);", nobody(), way[i].index, answered, p, i));
  }
  close();
}

std::string Generator::emit_last(const Way& way) {
  const auto object = last_object(module_, plan_, way.back());
  return object ? emit_divided(way, *object) : "";
}

std::string Generator::emit_divided(const Way& way, Id<Object> id) {
  const ObjectParts& parts = plan_.parts[id.index];
  const bool one_region = parts.regions.size() == 1;
  std::vector<Way> ways(parts.regions.size(), way);
  for (std::size_t r = 0; r < ways.size(); ++r) ways[r].push_back(parts.regions[r]);
  const std::string last = one_region ? emit_last(ways.front()) : "";
  const std::string name = fmt::format("divided_{}_{}", *stage_, divided_++);
  guard_ = way.empty() ? "" : "entered";
  line("// {}", at(module_.objects, id).name);
  open(fmt::format("void {}(vec3 p, uint level{})", name, guard_.empty() ? "" : ", bool entered"));
  if (!one_region) emit_decisions(at(module_.objects, id).root, parts.has_flat_tree);
  for (std::size_t r = 0; r < ways.size(); ++r) {
    const Id<Region> region = parts.regions[r];
    const auto later = one_region ? std::nullopt : stages_.stage_at(ways[r], 0);
    if (later) {
      line("if ({}) next_stage = {}u;", guarded(fmt::format("region == {}u", region.index)), fmt::format("{}", *later));
    } else {
      emit_candidates(region, one_region, {.asks_first = false, .way = one_region ? &ways[r] : nullptr, .last = last});
    }
  }
  emit_own_answer(parts.regions, one_region);
  close();
  line("");
  add(name);
  return name;
}

}  // namespace dmvv::compiler
