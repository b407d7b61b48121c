#include "compiler/plan/cost_model.h"

#include <algorithm>
#include <glm/matrix.hpp>
#include <map>
#include <numeric>
#include <set>

#include "compiler/plan/code_plan.h"

namespace dmvv::compiler {

namespace {

constexpr double lines_of_decision = 8.0;
constexpr double most_found = 4.0;  // candidates that hold a point, on average

class Expectation {
 public:
  Expectation(const Module& module, const SourceSizes& sizes, const std::vector<Id<Object>>& alike,
              const DeviceCosts& device)
      : module_(module),
        sizes_(sizes),
        alike_(alike),
        device_(device),
        all_function_lines_(std::accumulate(sizes.function_lines.begin(), sizes.function_lines.end(), 0.0)),
        costs_(module.objects.size()) {}

  std::vector<ObjectCost> run() {
    for (std::size_t i = costs_.size(); i-- > 0;)
      costs_[i] = cost(module_.objects[i]);  // the embedded ones stand behind
    return std::move(costs_);
  }

 private:
  /// As code, everything counts that is executed; walked, the way through the tree that costs most: which one points
  /// take is not known, and where they are is where the scene is dense.
  ObjectCost cost(const Object& object) const {
    std::vector<Id<Node>> order;
    visit(object.root, order);
    std::map<Id<Node>, double> shares{{object.root, 1.0}};  // of the points that come to a node
    ObjectCost cost;
    for (auto node = order.rbegin(); node != order.rend(); ++node) {
      const double share = shares[*node];
      cost.specialised += (1.0 - device_.skipping * (1.0 - share)) * specialised_node(*node);
      if (const auto* decision = std::get_if<Decision>(&at(module_.nodes, *node).content)) {
        shares[decision->positive] += 0.5 * share;
        shares[decision->negative] += 0.5 * share;
      }
    }
    std::map<Id<Node>, double> walked;
    for (const Id<Node> node : order) {
      walked[node] = walked_node(node);
      if (const auto* decision = std::get_if<Decision>(&at(module_.nodes, node).content)) {
        walked[node] += std::max(walked[decision->positive], walked[decision->negative]);
      }
    }
    cost.walked = device_.visit + walked[object.root];
    return cost;
  }

  double specialised_node(Id<Node> node) const {
    if (const auto* decision = std::get_if<Decision>(&at(module_.nodes, node).content)) {
      return specialised_decision(at(module_.sdfs, decision->sdf));
    }
    double sum = 0.0;
    for (const CandidateGroup& group : groups_of(node)) sum += group_cost(group).specialised;
    return sum;
  }

  double walked_node(Id<Node> node) const {
    if (const auto* decision = std::get_if<Decision>(&at(module_.nodes, node).content)) {
      return walked_decision(at(module_.sdfs, decision->sdf));
    }
    double sum = 0.0;
    for (const CandidateGroup& group : groups_of(node)) sum += group_cost(group).walked;
    return sum;
  }

  const std::vector<CandidateGroup>& groups_of(Id<Node> leaf) const {
    return at(module_.regions, std::get<Id<Region>>(at(module_.nodes, leaf).content)).groups;
  }

  /// Depth first, a node after all that follow from it.
  void visit(Id<Node> root, std::vector<Id<Node>>& order) const {
    std::set<Id<Node>> seen;
    std::vector<std::pair<Id<Node>, bool>> pending{{root, false}};
    while (!pending.empty()) {
      const auto [node, is_done] = pending.back();
      pending.pop_back();
      if (is_done) order.push_back(node);
      if (is_done || !seen.insert(node).second) continue;
      pending.push_back({node, true});
      const auto* decision = std::get_if<Decision>(&at(module_.nodes, node).content);
      if (decision == nullptr) continue;
      pending.push_back({decision->positive, false});
      pending.push_back({decision->negative, false});
    }
  }

  double source(const Sdf& sdf) const {
    const auto* function = std::get_if<Id<Function>>(&sdf.source);
    return function ? device_.line * sizes_.function_lines[function->index]
                    : device_.sample + device_.line * sizes_.filter_lines;
  }

  /// Rounds of the search for a seed that is negative.
  static double seeds_asked(const Sdf& sdf) { return sdf.placement == voml::Placement::seeded ? 2.0 : 0.0; }

  double specialised_decision(const Sdf& sdf) const {
    const double once = device_.line * lines_of_decision + source(sdf);
    return once + seeds_asked(sdf) * (device_.search + once);
  }

  /// A walker calls all functions where branches do not skip, and samples the atlas.
  double walked_decision(const Sdf& sdf) const {
    const double all =
        device_.line * (all_function_lines_ + sizes_.filter_lines) + (module_.grids.empty() ? 0.0 : device_.sample);
    const double once = device_.step + device_.skipping * source(sdf) + (1.0 - device_.skipping) * all;
    return once + seeds_asked(sdf) * (device_.search + once);
  }

  ObjectCost group_cost(const CandidateGroup& group) const {
    double found = 0.0, walked_each = 0.0;
    std::set<Id<Object>> shapes;
    for (const Candidate& candidate : group.candidates) {
      const double volume = std::abs(glm::determinant(candidate.local_from_parent.linear));
      const double share = candidate.tiled || volume <= 1.0 ? 1.0 : 1.0 / volume;
      found += share;
      walked_each += share * costs_[candidate.object.index].walked;
      shapes.insert(alike_[candidate.object.index]);
    }
    walked_each /= found;
    found = std::min(found, most_found);
    const double asked = std::min<double>(static_cast<double>(group.candidates.size()), 2.0 * std::max(found, 0.5));
    double code = 0.0;
    for (const Id<Object> shape : shapes) {
      const ObjectCost& inside = costs_[shape.index];
      const double paid = 1.0 - device_.skipping * (1.0 - 1.0 / static_cast<double>(shapes.size()));
      code += paid * std::min(inside.specialised, inside.walked);
    }
    // A loop's body is executed once where nothing is found, unless branches skip.
    const double rounds = found + (1.0 - device_.skipping) * std::max(1.0 - found, 0.0);
    return {asked * device_.search + rounds * code, (1.0 + asked) * device_.visit + found * walked_each};
  }

  const Module& module_;
  const SourceSizes& sizes_;
  const std::vector<Id<Object>>& alike_;
  const DeviceCosts& device_;
  double all_function_lines_;
  std::vector<ObjectCost> costs_;
};

}  // namespace

DeviceCosts costs_of_cpu() { return {}; }

DeviceCosts costs_of_gpu() {
  return {.line = 0.001, .sample = 0.02, .search = 0.03, .step = 0.05, .visit = 0.1, .skipping = 0.9};
}

std::vector<ObjectCost> expected_costs(const Module& module, const SourceSizes& sizes,
                                       const std::vector<Id<Object>>& alike, const DeviceCosts& device) {
  return Expectation(module, sizes, alike, device).run();
}

}  // namespace dmvv::compiler
