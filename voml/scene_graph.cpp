#include "voml/scene_graph.h"

#include <fmt/format.h>

#include <unordered_set>

#include "base/text.h"

namespace dmvv::voml {

TreeUses uses_of_tree(const Scene& scene, Id<Object> object) {
  TreeUses uses;
  std::unordered_set<std::uint32_t> seen_sdfs, seen_regions;
  std::vector<Id<Node>> open = {at(scene.objects, object).root};
  while (!open.empty()) {
    const Id<Node> id = open.back();
    open.pop_back();
    if (!id.valid()) continue;
    if (const auto* decision = std::get_if<Decision>(&at(scene.nodes, id).content)) {
      if (decision->sdf.valid() && seen_sdfs.insert(decision->sdf.index).second) uses.sdfs.push_back(decision->sdf);
      open.push_back(decision->negative);
      open.push_back(decision->positive);
    } else {
      const auto region = std::get<Id<Region>>(at(scene.nodes, id).content);
      if (region.valid() && seen_regions.insert(region.index).second) uses.regions.push_back(region);
    }
  }
  return uses;
}

Needed needed_by(const Scene& scene, Id<Object> root) {
  Needed needed{std::vector<bool>(scene.sdfs.size()), std::vector<bool>(scene.regions.size())};
  std::vector<bool> seen(scene.objects.size());
  std::vector<Id<Object>> open;
  const auto visit = [&](Id<Object> object) {
    if (!object.valid() || seen[object.index]) return;
    seen[object.index] = true;
    open.push_back(object);
  };
  visit(root);
  while (!open.empty()) {
    const TreeUses uses = uses_of_tree(scene, open.back());
    open.pop_back();
    for (const Id<Sdf> sdf : uses.sdfs) needed.sdfs[sdf.index] = true;
    for (const Id<Region> region : uses.regions) {
      if (needed.regions[region.index]) continue;
      needed.regions[region.index] = true;
      for (const EmbeddingGroup& group : at(scene.regions, region).groups) {
        for (const Embedded& embedded : group.embedded) visit(embedded.object);
      }
    }
  }
  return needed;
}

namespace {

/// Depth-first search over objects and the regions of their trees. Regions are vertices of their own, so that a region
/// used by many trees is walked once.
class CycleSearch {
 public:
  CycleSearch(const Scene& scene, Diagnostics& diagnostics)
      : scene_(scene),
        diagnostics_(diagnostics),
        object_state_(scene.objects.size(), State::unseen),
        region_state_(scene.regions.size(), State::unseen),
        object_depth_(scene.objects.size()),
        region_depth_(scene.regions.size()) {}

  void run() {
    for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
      if (object_state_[i] == State::unseen) search(Id<Object>{i});
    }
  }

 private:
  enum class State : std::uint8_t { unseen, on_path, done };

  /// An object on the path from the start, and how far its embeddings have been followed.
  struct Step {
    Id<Object> object;
    Span embedded_at;  ///< the EMBEDDED that leads here
    std::vector<Id<Region>> regions;
    std::size_t region = 0, group = 0, embedded = 0;
  };

  void enter(Id<Object> object, Span embedded_at) {
    object_state_[object.index] = State::on_path;
    object_depth_[object.index] = path_.size();
    path_.push_back({object, embedded_at, uses_of_tree(scene_, object).regions});
    for (const Id<Region> region : path_.back().regions) {
      // A region that is being walked stands in this tree too: what it embeds now embeds itself by way of it.
      if (region_state_[region.index] != State::on_path) continue;
      const std::size_t first = region_depth_[region.index] + 1;
      report(first, path_[first].embedded_at);
    }
  }

  /// The next embedding of the last object on the path; null when there is none left.
  const Embedded* next() {
    Step& step = path_.back();
    for (; step.region < step.regions.size(); ++step.region) {
      const Id<Region> region = step.regions[step.region];
      State& state = region_state_[region.index];
      if (state == State::unseen) {
        state = State::on_path;
        region_depth_[region.index] = path_.size() - 1;
        step.group = step.embedded = 0;
      }
      const bool walked_here = state == State::on_path && region_depth_[region.index] == path_.size() - 1;
      if (!walked_here) continue;  // walked before, or further up
      const auto& groups = at(scene_.regions, region).groups;
      for (; step.group < groups.size(); ++step.group, step.embedded = 0) {
        if (step.embedded < groups[step.group].embedded.size()) return &groups[step.group].embedded[step.embedded++];
      }
      state = State::done;
    }
    return nullptr;
  }

  void search(Id<Object> start) {
    enter(start, Span{});
    while (!path_.empty()) {
      const Embedded* embedded = next();
      if (embedded == nullptr) {
        object_state_[path_.back().object.index] = State::done;
        path_.pop_back();
      } else if (embedded->object.valid() && object_state_[embedded->object.index] == State::unseen) {
        enter(embedded->object, embedded->span);
      } else if (embedded->object.valid() && object_state_[embedded->object.index] == State::on_path) {
        report(object_depth_[embedded->object.index], embedded->span);
      }
    }
  }

  /// The objects on the path from step `first` on form a cycle, closed by the embedding at `closed_at`.
  void report(std::size_t first, Span closed_at) {
    std::vector<std::string_view> chain;
    for (std::size_t i = first; i < path_.size(); ++i) chain.push_back(at(scene_.objects, path_[i].object).name);
    chain.push_back(chain.front());
    std::vector<Note> notes;
    constexpr std::size_t most_notes = 8;
    for (std::size_t i = first + 1; i < path_.size() && notes.size() < most_notes; ++i) {
      notes.push_back({path_[i].embedded_at, fmt::format("{} is embedded here", in_quotes(chain[i - first]))});
    }
    diagnostics_.report(
        Code::embedding_cycle, closed_at,
        fmt::format("the object {} embeds itself: {}", in_quotes(chain.front()), shortened_chain(chain)),
        std::move(notes));
  }

  const Scene& scene_;
  Diagnostics& diagnostics_;
  std::vector<State> object_state_;
  std::vector<State> region_state_;
  std::vector<std::size_t> object_depth_;  // of objects and regions on the path: which step
  std::vector<std::size_t> region_depth_;
  std::vector<Step> path_;
};

}  // namespace

void report_embedding_cycles(const Scene& scene, Diagnostics& diagnostics) { CycleSearch(scene, diagnostics).run(); }

}  // namespace dmvv::voml
