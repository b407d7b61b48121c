// Objects as GLSL: decisions, and whether and what an object answers.
#include "compiler/glsl/generator.h"
#include "compiler/passes/seed_chains.h"

namespace dmvv::compiler {

std::string Generator::call(Id<Object> object, const std::string& p, const std::string& level,
                            const std::string& guard) const {
  if (plan_.cut[object.index]) {
    return fmt::format("{}walk({}u, {}, {})", guard == "true" ? "" : "if (" + guard + ") ", object.index, p, level);
  }
  if (guarded_[object.index]) return fmt::format("{}({}, {}, {})", object_name(object), p, level, guard);
  return fmt::format("{}({}, {})", object_name(object), p, level);
}

void Generator::emit_object(Id<Object> id) {
  const ObjectParts& parts = plan_.parts[id.index];
  for (const Id<Sdf> sdf : parts.sdfs) emit_sdf(sdf);
  line("// {}", at(module_.objects, id).name);
  guard_ = guarded_[id.index] ? "entered" : "";
  open(fmt::format("void {}(vec3 p, uint level{})", object_name(id), guard_.empty() ? "" : ", bool entered"));
  const bool one_region = parts.regions.size() == 1;
  if (!one_region) emit_decisions(at(module_.objects, id).root, parts.has_flat_tree);
  for (const Id<Region> region : parts.regions) emit_candidates(region, one_region);
  emit_own_answer(parts.regions, one_region);
  close();
  line("");
  add(object_name(id));
  if (sinks(id)) emit_in_two_steps(id);
}

Generator::Outcome Generator::outcome_of(Id<Node> id) {
  if (const auto known = outcomes_.find(id); known != outcomes_.end()) return known->second;
  const auto& content = at(module_.nodes, id).content;
  Outcome outcome = Outcome::either;
  if (const auto* leaf = std::get_if<Id<Region>>(&content)) {
    const Region& region = at(module_.regions, *leaf);
    if (region.number != 0)
      outcome = Outcome::answers;  // its own colour at least
    else if (region.groups.empty())
      outcome = Outcome::misses;
  } else {
    const auto& decision = std::get<Decision>(content);
    const Outcome negative = outcome_of(decision.negative), positive = outcome_of(decision.positive);
    if (negative == positive) outcome = negative;
  }
  outcomes_.emplace(id, outcome);
  return outcome;
}

bool Generator::sinks(Id<Object> id) {
  if (!options_.sink_answers || plan_.cut[id.index]) return false;
  return is_told_by_decisions(id) && outcome_of(at(module_.objects, id).root) != Outcome::misses;
}

void Generator::emit_in_two_steps(Id<Object> id) {
  const ObjectParts& parts = plan_.parts[id.index];
  const Id<Node> root = at(module_.objects, id).root;
  const bool one_region = parts.regions.size() == 1;
  guard_.clear();
  line("// {}", at(module_.objects, id).name);
  open(fmt::format("bool {}(vec3 p, uint level, bool inside)", listed_name(id)));
  line("bool answers = inside || {};", entrance(root));
  open("if (inside)");
  is_inside_ = true;
  if (!one_region) emit_decisions(root, false);
  is_inside_ = false;
  for (const Id<Region> region : parts.regions) emit_candidates(region, one_region);
  emit_own_answer(parts.regions, one_region);
  close();
  line("return answers;");
  close();
  line("");
  add(listed_name(id));
}

std::string Generator::entrance(Id<Node> id) {
  const Outcome outcome = outcome_of(id);
  if (outcome != Outcome::either) return outcome == Outcome::answers ? "true" : "false";
  const auto& decision = std::get<Decision>(at(module_.nodes, id).content);
  const SeedChain* const before = asked_chain_;
  const std::string test = decision_test(decision.sdf);
  const SeedChain* const asked = asked_chain_;
  const std::string negative = entrance(decision.negative);
  asked_chain_ = asked;
  const std::string positive = entrance(decision.positive);
  asked_chain_ = before;
  if (negative == "true") return positive == "false" ? test : fmt::format("({} || {})", test, positive);
  if (negative == "false") return positive == "true" ? "!" + test : fmt::format("(!{} && {})", test, positive);
  if (positive == "true") return fmt::format("(!{} || {})", test, negative);
  if (positive == "false") return fmt::format("({} && {})", test, negative);
  return fmt::format("({} ? {} : {})", test, negative, positive);
}

std::string Generator::guarded(const std::string& condition) const {
  if (guard_.empty() || condition.empty()) return guard_ + condition;
  return guard_ + " && " + condition;
}

void Generator::emit_decisions(Id<Node> root, bool flat) {
  if (flat) {
    emit_flat_tree(root);
    return;
  }
  line("uint region{};", guard_.empty() ? "" : " = DMVV_NO_REGION");
  if (!guard_.empty()) open(fmt::format("if ({})", guard_));
  emit_tree(root);
  if (!guard_.empty()) close();
}

void Generator::emit_flat_tree(Id<Node> root) {
  std::vector<Id<Node>> order;
  std::map<Id<Node>, std::uint32_t> parents;  // that are not yet in order
  std::vector<Id<Node>> pending{root};
  const auto children = [&](Id<Node> node) -> std::vector<Id<Node>> {
    const auto* decision = std::get_if<Decision>(&at(module_.nodes, node).content);
    return decision ? std::vector<Id<Node>>{decision->negative, decision->positive} : std::vector<Id<Node>>{};
  };
  for (std::set<Id<Node>> seen{root}; !pending.empty();) {
    const Id<Node> node = pending.back();
    pending.pop_back();
    for (const Id<Node> child : children(node)) {
      ++parents[child];
      if (seen.insert(child).second) pending.push_back(child);
    }
  }
  pending = {root};
  while (!pending.empty()) {
    const Id<Node> node = pending.back();
    pending.pop_back();
    if (!children(node).empty()) order.push_back(node);
    for (const Id<Node> child : children(node)) {
      if (--parents[child] == 0) pending.push_back(child);
    }
  }

  std::map<Id<Node>, std::uint32_t> number;
  for (const Id<Node> node : order) number.emplace(node, static_cast<std::uint32_t>(number.size()));
  const auto reference = [&](Id<Node> node) {
    const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, node).content);
    return region ? fmt::format("DMVV_REGION_BIT | {}u", region->index) : fmt::format("{}u", number.at(node));
  };
  line("uint at = {};", guard_.empty() ? "0u" : guard_ + " ? 0u : DMVV_NO_REGION");
  for (const Id<Node> node : order) {
    const auto& decision = std::get<Decision>(at(module_.nodes, node).content);
    const Link* const link = link_of(decision.sdf);
    line("if (at == {}u) at = {} ? {} : {};", fmt::format("{}", number.at(node)),
         decision_test(decision.sdf, link == nullptr || link->is_first()), reference(decision.negative),
         reference(decision.positive));
  }
  line("uint region = at & ~DMVV_REGION_BIT;");
}

void Generator::emit_tree(Id<Node> id) {
  if (const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, id).content)) {
    line("region = {};  // {}", fmt::format("{}u", region->index), at(module_.regions, *region).name);
    return;
  }
  const auto& decision = std::get<Decision>(at(module_.nodes, id).content);
  if (is_inside_ && outcome_of(decision.positive) == Outcome::misses) return emit_tree(decision.negative);
  if (is_inside_ && outcome_of(decision.negative) == Outcome::misses) return emit_tree(decision.positive);
  const SeedChain* const before = asked_chain_;
  open(fmt::format("if ({})", decision_test(decision.sdf)));
  const SeedChain* const asked = asked_chain_;
  emit_tree(decision.negative);
  asked_chain_ = asked;
  otherwise();
  emit_tree(decision.positive);
  asked_chain_ = before;
  close();
}

void Generator::emit_own_answer(const std::vector<Id<Region>>& regions, bool one_region) {
  const bool may_be_found = std::any_of(regions.begin(), regions.end(),
                                        [&](Id<Region> region) { return !at(module_.regions, region).groups.empty(); });
  if (one_region) {
    const Region& region = at(module_.regions, regions.front());
    if (region.number == 0) return;
    const std::string condition = guarded(may_be_found ? nobody() : "");
    line("{}answer({}u, {}u, p, level);", condition.empty() ? "" : "if (" + condition + ") ",
         fmt::format("{}", regions.front().index), fmt::format("{}", region.number));
    return;
  }
  line("uint number = 0u;");  // numbers need not follow the order of the regions; choices within choices would nest
  for (const Id<Region> region : regions) {
    const std::uint32_t n = at(module_.regions, region).number;
    if (n != 0) line("if (region == {}u) number = {}u;", fmt::format("{}", region.index), fmt::format("{}", n));
  }
  line("if ({}) answer(region, number, p, level);",
       guarded(may_be_found ? nobody() + " && number != 0u" : "number != 0u"));
}

}  // namespace dmvv::compiler
