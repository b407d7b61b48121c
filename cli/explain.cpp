#include "cli/explain.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/context.h"

namespace dmvv::cli {
namespace {

using compiler::AskedCandidate;
using compiler::AskedCell;
using compiler::AskedDecision;
using compiler::AskedGroup;
using compiler::AskedPlacement;
using compiler::Explanation;
using compiler::Module;
using compiler::Visit;
using Json = nlohmann::ordered_json;

constexpr std::size_t most_listed = 8;  // of those that do not hold the point

std::string text(const glm::dvec3& v) { return fmt::format("({:.6g} {:.6g} {:.6g})", v.x, v.y, v.z); }

// ---- for people ----

class Tree {
 public:
  Tree(const Module& module, const compiler::ReferenceAnswer& answer) : module_(module), answer_(answer) {}

  void print(const Visit& visit, std::size_t level) {
    for (const AskedDecision& decision : visit.decisions) print(decision, level);
    const compiler::Region& region = at(module_.regions, visit.region);
    // Only one region answers by itself: its colour is the answer's.
    const std::string own = visit.answers ? "its colour: " + colour() : "empty: nothing here";
    if (visit.groups.empty()) return line(level, fmt::format("region {}, {}", region.name, own));
    line(level, fmt::format("region {}", region.name));
    bool candidate_answers = false;
    for (std::size_t g = 0; g < visit.groups.size(); ++g) {
      candidate_answers |= print(visit.groups[g], region.groups[g], level + 1);
    }
    if (!candidate_answers) line(level + 1, fmt::format("nobody answers; {}", own));
  }

  std::string take() { return std::move(text_); }

  void line(std::size_t level, const std::string& words) { text_ += std::string(2 + 2 * level, ' ') + words + '\n'; }

 private:
  std::string colour() const {
    const glm::vec4 c(answer_.rgba);
    return fmt::format("{} {} {}{}", c.r, c.g, c.b, c.a == 1.0f ? "" : fmt::format(", opacity {}", c.a));
  }

  static std::string doubt(bool certain) { return certain ? "" : " (too near to be certain)"; }

  static std::string cell_text(const std::optional<AskedCell>& cell, std::size_t all, std::string_view noun) {
    if (!cell) return plural(all, noun) + ", asked one by one";
    const glm::uvec3 c = cell->cell, s = cell->size;
    return fmt::format("cell {} {} {} of {} x {} x {} lists {} of {}", c.x, c.y, c.z, s.x, s.y, s.z, cell->entries,
                       plural(all, noun));
  }

  static std::string outcome(const AskedPlacement& asked, double iso) {
    if (!asked.held) return "outside its box";
    const double value = asked.value.value_or(0.0);
    return fmt::format("{:.6g} {} {:.6g}", value,
                       asked.value && value <= iso ? "<="
                       : value > iso               ? ">"
                                                   : "against",
                       iso);
  }

  void print(const AskedDecision& decision, std::size_t level) {
    const compiler::Sdf& sdf = at(module_.sdfs, decision.sdf);
    const std::string side = (decision.negative ? "NEGATIVE" : "POSITIVE") + doubt(decision.certain);
    const std::size_t count = sdf.local_from_object.size();
    if (sdf.placement != voml::Placement::seeded && !decision.placements.empty()) {
      const AskedPlacement& only = decision.placements.front();
      return line(level, fmt::format("SDF {} at {}: {}: {}", sdf.name, text(only.local), outcome(only, sdf.iso), side));
    }
    line(level, fmt::format("SDF {}: {}: {}", sdf.name, cell_text(decision.cell, count, "seed"), side));
    std::size_t misses = 0;
    for (const AskedPlacement& asked : decision.placements) {
      if (!asked.negative && ++misses > most_listed) continue;
      line(level + 1, fmt::format("seed {} at {}: {}{}", asked.placement, text(asked.local), outcome(asked, sdf.iso),
                                  doubt(asked.certain)));
    }
    if (misses > most_listed) line(level + 1, fmt::format("and {} more that do not hold it", misses - most_listed));
  }

  /// True if one of the candidates answers.
  bool print(const AskedGroup& asked, const compiler::CandidateGroup& group, std::size_t level) {
    if (asked.in_box) {
      line(level, fmt::format("INDEX: at {}: {}{}", text(*asked.in_box),
                              asked.held ? "inside" : "outside, nobody is asked", doubt(asked.certain)));
      if (!asked.held) return false;
    }
    line(level, cell_text(asked.cell, group.candidates.size(), "embedded object"));
    std::size_t misses = 0;
    bool answers = false;
    for (const AskedCandidate& candidate : asked.candidates) {
      if (!candidate.held && ++misses > most_listed) continue;
      line(level,
           fmt::format("[{}] {} at {}{}{}", candidate.number, at(module_.objects, candidate.object).name,
                       text(candidate.local), candidate.held ? "" : ": outside its cube", doubt(candidate.certain)));
      for (const Visit& inside : candidate.visit) {
        print(inside, level + 1);
        answers |= inside.answers;
      }
    }
    if (misses > most_listed) line(level, fmt::format("and {} more whose cubes do not hold it", misses - most_listed));
    return answers;
  }

  const Module& module_;
  const compiler::ReferenceAnswer& answer_;
  std::string text_;
};

// ---- for programs ----

Json json(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }
Json json(const std::optional<AskedCell>& asked) {
  if (!asked) return nullptr;
  return {{"cell", {asked->cell.x, asked->cell.y, asked->cell.z}},
          {"size", {asked->size.x, asked->size.y, asked->size.z}},
          {"entries", asked->entries}};
}

Json json(const Module& module, const AskedDecision& decision) {
  const compiler::Sdf& sdf = at(module.sdfs, decision.sdf);
  Json placements = Json::array();
  for (const AskedPlacement& p : decision.placements) {
    placements.push_back({{"seed", p.placement},
                          {"local", json(p.local)},
                          {"held", p.held},
                          {"value", p.value ? Json(*p.value) : Json(nullptr)},
                          {"negative", p.negative},
                          {"certain", p.certain},
                          {"distance", p.distance}});
  }
  return {{"sdf", sdf.name},
          {"iso", sdf.iso},
          {"side", decision.negative ? "NEGATIVE" : "POSITIVE"},
          {"certain", decision.certain},
          {"distance", decision.distance},
          {"lookup", json(decision.cell)},
          {"asked", placements}};
}

Json json(const Module& module, const Visit& visit);

Json json(const Module& module, const AskedGroup& group) {
  Json candidates = Json::array();
  for (const AskedCandidate& c : group.candidates) {
    candidates.push_back({{"candidate", c.number},
                          {"object", at(module.objects, c.object).name},
                          {"local", json(c.local)},
                          {"held", c.held},
                          {"certain", c.certain},
                          {"distance", c.distance},
                          {"visit", c.visit.empty() ? Json(nullptr) : json(module, c.visit.front())}});
  }
  return {{"index", group.in_box ? json(*group.in_box) : Json(nullptr)},
          {"held", group.held},
          {"certain", group.certain},
          {"lookup", json(group.cell)},
          {"asked", candidates}};
}

Json json(const Module& module, const Visit& visit) {
  Json decisions = Json::array(), groups = Json::array();
  for (const AskedDecision& decision : visit.decisions) decisions.push_back(json(module, decision));
  for (const AskedGroup& group : visit.groups) groups.push_back(json(module, group));
  return {{"object", at(module.objects, visit.object).name}, {"p", json(visit.p)}, {"decisions", decisions},
          {"region", at(module.regions, visit.region).name}, {"groups", groups},   {"answers", visit.answers}};
}

}  // namespace

std::string explanation_text(const Module& module, const Explanation& explanation) {
  Tree tree(module, explanation.answer);
  tree.line(0, fmt::format("{}; nearest to another outcome: {}, about {:.3g} away",
                           explanation.answer.certain ? "certain" : "not certain in float32", explanation.nearest.what,
                           explanation.nearest.distance));
  const std::string& root = at(module.objects, module.root).name;
  if (explanation.visit.empty()) tree.line(0, fmt::format("{}: outside its cube", root));
  for (const Visit& visit : explanation.visit) {
    tree.line(0, fmt::format("{} at {}", root, text(visit.p)));
    tree.print(visit, 1);
  }
  return tree.take();
}

std::string explanation_json(const Module& module, const Explanation& explanation) {
  const Json members{{"certain", explanation.answer.certain},
                     {"nearest", {{"test", explanation.nearest.what}, {"distance", explanation.nearest.distance}}},
                     {"visit", explanation.visit.empty() ? Json(nullptr) : json(module, explanation.visit.front())}};
  const std::string object = members.dump(-1, ' ', false, Json::error_handler_t::replace);
  return object.substr(1, object.size() - 2);
}

}  // namespace dmvv::cli
