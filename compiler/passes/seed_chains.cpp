#include "compiler/passes/seed_chains.h"

#include <optional>

namespace dmvv::compiler {

namespace {

bool searched_alike(const Sdf& a, const Sdf& b) {
  const auto is_searched = [](const Sdf& sdf) {
    return sdf.placement == voml::Placement::seeded && sdf.index_size != glm::uvec3(1);
  };
  return is_searched(a) && is_searched(b) && a.source == b.source && a.iso == b.iso && a.content == b.content;
}

class Search {
 public:
  explicit Search(const Module& module) : module_(module), uses_(module.sdfs.size(), 0), ways_(module.nodes.size(), 0) {
    for (const Object& object : module.objects) ++ways_[object.root.index];
    for (const Node& node : module.nodes) {
      const auto* decision = std::get_if<Decision>(&node.content);
      if (decision == nullptr) continue;
      ++uses_[decision->sdf.index];
      ++ways_[decision->positive.index];
      ++ways_[decision->negative.index];
    }
  }

  std::vector<SeedChain> run() {
    std::vector<bool> follows(module_.nodes.size(), false);
    for (std::uint32_t i = 0; i < module_.nodes.size(); ++i) {
      if (const auto next = next_of({i})) follows[next->index] = true;
    }
    std::vector<SeedChain> chains;
    for (std::uint32_t i = 0; i < module_.nodes.size(); ++i) {
      if (follows[i] || !next_of({i})) continue;
      SeedChain& chain = chains.emplace_back();
      for (std::optional<Id<Node>> node = Id<Node>{i}; node; node = next_of(*node))
        chain.push_back(decision_at(*node)->sdf);
    }
    return chains;
  }

 private:
  const Decision* decision_at(Id<Node> id) const { return std::get_if<Decision>(&at(module_.nodes, id).content); }

  std::optional<Id<Node>> next_of(Id<Node> id) const {
    const Decision* decision = decision_at(id);
    const Decision* next = decision != nullptr ? decision_at(decision->positive) : nullptr;
    if (next == nullptr || ways_[decision->positive.index] != 1) return std::nullopt;
    if (uses_[decision->sdf.index] != 1 || uses_[next->sdf.index] != 1) return std::nullopt;
    if (!searched_alike(at(module_.sdfs, decision->sdf), at(module_.sdfs, next->sdf))) return std::nullopt;
    return decision->positive;
  }

  const Module& module_;
  std::vector<std::uint32_t> uses_;  // of each SDF, by decisions
  std::vector<std::uint32_t> ways_;  // to each node
};

}  // namespace

std::vector<SeedChain> find_seed_chains(const Module& module) { return Search(module).run(); }

}  // namespace dmvv::compiler
