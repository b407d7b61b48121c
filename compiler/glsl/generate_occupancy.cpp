// Whether anything is at a point, and nothing else: what rays ask on their way. Boundaries between regions are not
// looked for, so answers hold farther, and what only tells regions apart is not there.
#include "compiler/glsl/generator.h"

namespace dmvv::compiler {

void Generator::emit_occupancy() {
  asks_whether_ = true;
  emit_occupied(module_.root);
  asks_whether_ = false;
  open("void occupancy(vec3 p)");
  line("hit_number = {}(p, true) ? 1u : 0u;", occupied_name(module_.root));
  close();
  line("");
  add("occupancy");
}

bool Generator::is_told_by_decisions(Id<Object> id) const {
  const ObjectParts& parts = plan_.parts[id.index];
  return !parts.has_flat_tree && std::ranges::all_of(parts.regions, [&](Id<Region> region) {
    return at(module_.regions, region).number != 0 || at(module_.regions, region).groups.empty();
  });
}

void Generator::emit_occupied(Id<Object> id) {
  if (families_.knows(occupied_name(id))) return;
  const auto& regions = plan_.parts[id.index].regions;
  const bool is_cut = plan_.cut[id.index], is_told = !is_cut && is_told_by_decisions(id);
  for (const Id<Region> region : regions) {
    if (!is_cut && !is_told) emit_occupied_below(at(module_.regions, region));
  }
  line("// {}", at(module_.objects, id).name);
  open(fmt::format("bool {}(vec3 p, bool entered)", occupied_name(id)));
  if (is_cut) {
    line("hit_number = 0u;");
    line("if (entered) walk({}u, p, 0u);", fmt::format("{}", id.index));
    line("return hit_number != 0u;");
  } else if (is_told) {
    line("bool answers = false;");
    open("if (entered)");
    line("Limits outer = take_limits();");
    emit_told(at(module_.objects, id).root, "answers");
    line("keep(outer);");
    close();
    line("return answers;");
  } else {
    emit_occupied_regions(id);
  }
  close();
  line("");
  add(occupied_name(id));
}

void Generator::emit_told(Id<Node> id, const std::string& result) {
  if (const Outcome outcome = outcome_of(id); outcome != Outcome::either) {
    line("{} = {};", result, outcome == Outcome::answers ? "true" : "false");
    return;
  }
  const auto& decision = std::get<Decision>(at(module_.nodes, id).content);
  const Outcome negative = outcome_of(decision.negative), positive = outcome_of(decision.positive);
  const SeedChain* const before = asked_chain_;
  open("");
  emit_asked(decision.sdf);
  const SeedChain* const asked = asked_chain_;
  const auto emit_side = [&](Id<Node> side) {
    asked_chain_ = asked;
    emit_told(side, result);
  };
  if (negative != Outcome::either && positive != Outcome::either) {
    line("{} = {}negative;", result, negative == Outcome::answers ? "" : "!");
    line("keep(asked);");
  } else if (negative == Outcome::either && positive == Outcome::either) {
    open("if (negative)");
    emit_side(decision.negative);
    otherwise();
    emit_side(decision.positive);
    close();
    line("keep(asked);");
  } else {  // the side that is not known is asked in any case: if it comes to the same, either of both suffices
    const bool on_negative = negative != Outcome::either;
    emit_side(on_negative ? decision.positive : decision.negative);
    const char* const known = (on_negative ? negative : positive) == Outcome::answers ? "true" : "false";
    line("choose(asked, {}negative, {} == {});", on_negative ? "" : "!", result, known);
    line("if ({}negative) {} = {};", on_negative ? "" : "!", result, known);
  }
  asked_chain_ = before;
  close();
}

void Generator::emit_asked(Id<Sdf> sdf) {
  const Link* const link = link_of(sdf);
  const bool is_first = link == nullptr || link->chain != asked_chain_;
  line("bool negative = {};", decision_test(sdf));
  // Those that share a search share what it was limited by.
  if (link == nullptr) return line("Limits asked = take_limits();");
  const std::string searched = chain_name(*link->chain) + "_limits";
  if (is_first) line("Limits {} = take_limits();", searched);
  line("Limits asked = {};", searched);
}

void Generator::emit_occupied_below(const Region& region) {
  if (region.number != 0) return;
  for (const CandidateGroup& group : region.groups) {
    if (group.candidates.size() == 1) emit_occupied(group.candidates.front().object);
  }
}

void Generator::emit_occupied_regions(Id<Object> id) {
  const auto& parts = plan_.parts[id.index];
  const bool one_region = parts.regions.size() == 1;
  guard_ = "entered";
  if (!one_region) emit_decisions(at(module_.objects, id).root, parts.has_flat_tree);
  line("bool occupied = false;");
  for (const Id<Region> region : parts.regions) {
    if (at(module_.regions, region).number != 0)
      line("if ({}) occupied = true;", guarded(one_region ? "" : fmt::format("region == {}u", region.index)));
  }
  for (const Id<Region> region : parts.regions) {
    if (at(module_.regions, region).number == 0) emit_candidates(region, one_region);
  }
  guard_.clear();
  line("return occupied;");
}

}  // namespace dmvv::compiler
