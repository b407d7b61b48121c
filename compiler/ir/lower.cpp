// Scene -> Module. Walks what the root reaches, composes matrices in double, orders objects by embedding.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "compiler/ir/module.h"
#include "compiler/ir/rounding.h"

namespace dmvv::compiler {

namespace {

/// Entries of a placement's matrix. Products of a few stay finite in float32.
constexpr double largest_entry = 0x1p100;
/// An object is imprecise if float32 moves points by more than this share of its cube's width: a pixel of a picture
/// that shows the cube a thousand pixels wide.
constexpr double imprecise_share = 0x1p-10;

/// Maps ids of a scene's vector to ids of a module's vector; an entry is made when an id is first asked for.
template <class From, class To = From>
class Renumber {
 public:
  explicit Renumber(std::size_t count) : to_(count) {}
  bool known(Id<From> id) const { return to_[id.index].valid(); }
  Id<To>& operator[](Id<From> id) { return to_[id.index]; }

 private:
  std::vector<Id<To>> to_;
};

template <class T>
Id<T> move_once(Renumber<T>& renumber, std::vector<T>& from, std::vector<T>& to, Id<T> id) {
  if (!renumber.known(id)) renumber[id] = append(to, std::move(at(from, id)));
  return renumber[id];
}

class Lowering {
 public:
  Lowering(voml::Scene scene, Diagnostics& diagnostics, const LowerOptions& options)
      : scene_(std::move(scene)),
        diagnostics_(diagnostics),
        options_(options),
        objects_(scene_.objects.size()),
        sdfs_(scene_.sdfs.size()),
        nodes_(scene_.nodes.size()),
        grids_(scene_.grids.size()),
        bitmaps_(scene_.bitmaps.size()),
        functions_(scene_.functions.size()),
        compiled_(scene_.functions.size(), false) {}

  std::optional<Module> run() {
    const bool ordered = order_objects();
    if (ordered) {
      for (const Id<voml::Object> id : parents_first_) lower_object(id);
    }
    if (options_.check_everything) compile_the_rest();
    if (!ordered) return std::nullopt;
    if (diagnostics_.has_errors()) return std::nullopt;
    module_.root = objects_[scene_.root];
    number_regions();
    if (diagnostics_.has_errors()) return std::nullopt;
    check_precision();
    module_.depth = longest_chain();
    return std::move(module_);
  }

 private:
  std::vector<Id<voml::Region>> leaves(Id<voml::Object> object) const {
    std::vector<Id<voml::Region>> found;
    std::vector<Id<voml::Node>> pending{at(scene_.objects, object).root};
    std::vector<bool> seen(scene_.nodes.size());
    while (!pending.empty()) {
      const Id<voml::Node> id = pending.back();
      pending.pop_back();
      if (seen[id.index]) continue;
      seen[id.index] = true;
      const auto& content = at(scene_.nodes, id).content;
      if (const auto* region = std::get_if<Id<voml::Region>>(&content)) {
        found.push_back(*region);
      } else {
        const auto& decision = std::get<voml::Decision>(content);
        pending.push_back(decision.negative);
        pending.push_back(decision.positive);
      }
    }
    return found;
  }

  std::vector<Id<voml::Object>> embedded_in(Id<voml::Object> object) const {
    std::vector<Id<voml::Object>> found;
    for (const auto region : leaves(object)) {
      for (const auto& group : at(scene_.regions, region).groups) {
        for (const auto& embedded : group.embedded) found.push_back(embedded.object);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Depth-first with an explicit stack; the reverse of the order in which objects are finished has parents first.
  bool order_objects() {
    enum class Mark : std::uint8_t { unseen, open, done };
    struct Visit {
      Id<voml::Object> object;
      std::vector<Id<voml::Object>> children;
      std::size_t next = 0;
    };
    std::vector<Mark> marks(scene_.objects.size(), Mark::unseen);
    std::vector<Visit> stack;
    const auto enter = [&](Id<voml::Object> object) {
      marks[object.index] = Mark::open;
      stack.push_back({object, embedded_in(object)});
    };
    enter(scene_.root);
    while (!stack.empty()) {
      Visit& visit = stack.back();
      if (visit.next == visit.children.size()) {
        marks[visit.object.index] = Mark::done;
        parents_first_.push_back(visit.object);
        stack.pop_back();
        continue;
      }
      const Id<voml::Object> child = visit.children[visit.next++];
      if (marks[child.index] == Mark::open) {
        report_cycle(stack, child);
        return false;
      }
      if (marks[child.index] == Mark::unseen) enter(child);
    }
    std::reverse(parents_first_.begin(), parents_first_.end());
    return true;
  }

  template <class Stack>
  void report_cycle(const Stack& stack, Id<voml::Object> closes_at) {
    const auto first =
        std::find_if(stack.begin(), stack.end(), [&](const auto& visit) { return visit.object == closes_at; });
    std::string cycle;
    for (auto visit = first; visit != stack.end(); ++visit) cycle += at(scene_.objects, visit->object).name + " -> ";
    const auto& object = at(scene_.objects, closes_at);
    diagnostics_.report(Code::embedding_cycle, object.span, "objects embed each other: " + cycle + object.name);
  }

  void lower_object(Id<voml::Object> id) {
    current_ = id;
    objects_[id] = append(module_.objects, Object{at(scene_.objects, id).name, {}, {}});
    const Id<Node> root = lower_tree(at(scene_.objects, id).root);
    at(module_.objects, objects_[id]).root = root;
  }

  /// Nodes in preorder; shared subtrees stay shared. The pending list holds the scene's node and the place in the
  /// module that refers to it.
  Id<Node> lower_tree(Id<voml::Node> root) {
    enum class Side : std::uint8_t { positive, negative };
    struct Pending {
      Id<voml::Node> node;
      Id<Node> parent;
      Side side;
    };
    std::vector<Pending> pending{{root, {}, Side::positive}};
    while (!pending.empty()) {
      const auto [node, parent, side] = pending.back();
      pending.pop_back();
      if (!nodes_.known(node)) {
        const auto& content = at(scene_.nodes, node).content;
        if (const auto* region = std::get_if<Id<voml::Region>>(&content)) {
          nodes_[node] = append(module_.nodes, Node{lower_region(*region)});
        } else {
          const auto& decision = std::get<voml::Decision>(content);
          const Id<Sdf> sdf = lower_sdf(decision.sdf);
          sdf_users_.emplace(sdf, objects_[current_]);
          nodes_[node] = append(module_.nodes, Node{Decision{sdf, {}, {}}});
          pending.push_back({decision.negative, nodes_[node], Side::negative});
          pending.push_back({decision.positive, nodes_[node], Side::positive});
        }
      }
      if (!parent.valid()) continue;
      auto& refers = std::get<Decision>(at(module_.nodes, parent).content);
      (side == Side::positive ? refers.positive : refers.negative) = nodes_[node];
    }
    return nodes_[root];
  }

  /// Reports a placement that float32 cannot hold.
  void check_placement(const Affine& affine, Span span) {
    double largest =
        std::max({std::abs(affine.translation.x), std::abs(affine.translation.y), std::abs(affine.translation.z)});
    for (int column = 0; column < 3; ++column) {
      const glm::dvec3 entries = glm::abs(affine.linear[column]);
      largest = std::max({largest, entries.x, entries.y, entries.z});
    }
    if (largest <= largest_entry) return;
    diagnostics_.report(
        Code::placement_too_small, span,
        fmt::format("a placement magnifies by {:.3g}; shaders compute in float32, and can follow up to {:.3g}", largest,
                    largest_entry));
  }

  Affine placement_of(const voml::Transform& transform, Span span) {
    const Affine affine = local_from_object(transform);
    check_placement(affine, span);
    return affine;
  }

  std::vector<Affine> placements(voml::Placement placement, const voml::Transform& transform, Id<voml::SeedList> seeds,
                                 Span span) {
    if (placement != voml::Placement::seeded) return {placement_of(transform, span)};
    std::vector<Affine> result;
    const auto& list = at(scene_.seed_lists, seeds).seeds;
    result.reserve(list.size());
    for (const auto& seed : list) result.push_back(placement_of(combine(transform, seed), span));
    return result;
  }

  /// A function that does not compile leaves an invalid id; the errors that it reported end the lowering.
  Id<Function> lower_function(Id<voml::Function> id, const std::string& name) {
    if (compiled_[id.index]) return functions_[id];
    compiled_[id.index] = true;
    auto snippet = compiled(id);
    if (!snippet) return {};
    return functions_[id] = append(module_.functions, Function{name, std::move(*snippet)});
  }

  void compile_the_rest() {
    for (std::size_t i = 0; i < compiled_.size(); ++i) {
      if (!compiled_[i]) compiled(Id<voml::Function>{static_cast<std::uint32_t>(i)});
    }
  }

  std::optional<snippet::Snippet> compiled(Id<voml::Function> id) {
    auto snippet = snippet::compile_snippet(at(scene_.functions, id), diagnostics_, options_.cache);
    ++compiled_count_;
    if (options_.progress) options_.progress(compiled_count_, scene_.functions.size());
    return snippet;
  }

  Id<Sdf> lower_sdf(Id<voml::Sdf> id) {
    if (sdfs_.known(id)) return sdfs_[id];
    const voml::Sdf& from = at(scene_.sdfs, id);
    Sdf sdf;
    sdf.name = from.name;
    sdf.span = from.span;
    if (const auto* grid = std::get_if<Id<voml::Grid>>(&from.source)) {
      sdf.source = move_once(grids_, scene_.grids, module_.grids, *grid);
    } else {
      sdf.source = lower_function(std::get<Id<voml::Function>>(from.source), from.name);
    }
    sdf.placement = from.placement;
    sdf.local_from_object = placements(from.placement, from.transform, from.seeds, from.span);
    sdf.index_size = from.index_size.value_or(glm::uvec3(0));
    sdf.iso = from.offset;
    return sdfs_[id] = append(module_.sdfs, std::move(sdf));
  }

  /// A region that two objects use becomes two: paths name the object that the point is in.
  Id<Region> lower_region(Id<voml::Region> id) {
    const RegionUse use{id, current_};
    if (const auto known = regions_.find(use); known != regions_.end()) return known->second;
    const voml::Region& from = at(scene_.regions, id);
    Region region;
    region.name = from.name;
    region.object = objects_[current_];
    region.kind = from.kind;
    region.rgb = from.rgb;
    region.opacity = from.opacity;
    if (from.kind == voml::RegionKind::bitmap) {
      region.bitmap = move_once(bitmaps_, scene_.bitmaps, module_.bitmaps, from.bitmap);
      region.texture_from_object = placement_of(from.transform, from.span);
    }
    return regions_[use] = append(module_.regions, std::move(region));
  }

  /// Numbers follow the document (the map's order); groups are filled here, when every object has its id.
  void number_regions() {
    std::uint32_t number = 0;
    for (const auto& [use, id] : regions_) {
      Region& region = at(module_.regions, id);
      if (region.kind != voml::RegionKind::empty) region.number = ++number;
      const voml::Region& from = at(scene_.regions, use.first);
      std::uint32_t first_number = 0;
      for (const auto& group : from.groups) lower_group(group, id, first_number);
    }
  }

  void lower_group(const voml::EmbeddingGroup& from, Id<Region> id, std::uint32_t& first_number) {
    Region& region = at(module_.regions, id);
    CandidateGroup group;
    if (from.index) {
      group.box_from_object =
          placement_of(from.index->transform, from.embedded.empty() ? Span{} : from.embedded.front().span);
      group.index_size = from.index->size;
    }
    group.first_number = first_number;
    for (const auto& embedded : from.embedded) {
      const bool tiled = embedded.placement == voml::Placement::tiled;
      const std::size_t first = group.candidates.size();
      for (const Affine& affine : placements(embedded.placement, embedded.transform, embedded.seeds, embedded.span)) {
        group.candidates.push_back({objects_[embedded.object], affine, tiled});
      }
      origins_.push_back({region.object, objects_[embedded.object], embedded.span, id, region.groups.size(), first,
                          group.candidates.size() - first});
    }
    first_number += static_cast<std::uint32_t>(group.candidates.size());
    if (!group.candidates.empty()) region.groups.push_back(std::move(group));
  }

  // ---- how far float32 carries (spec/accuracy.md) ----

  /// One EMBEDDED element.
  struct Origin {
    Id<Object> parent;
    Id<Object> child;
    Span span;
    Id<Region> region;
    std::size_t group, first, count;  ///< its candidates
  };

  static double share(const ErrorBound& error) {
    return 0.5 * std::max({error.component.x, error.component.y, error.component.z});
  }

  static ErrorBound worse(const ErrorBound& a, const ErrorBound& b) {
    return {glm::max(a.component, b.component), std::max(a.length, b.length)};
  }

  void report_imprecise(Span span, const std::string& what, double share_of_cube) {
    diagnostics_.report(
        Code::imprecise_placement, span,
        fmt::format(
            "float32 coordinates in {} may be off by {:.2g} of its cube's width, and its boundaries in pictures "
            "with them; a larger scale, or dmvv probe, which computes in double, would tell",
            what, share_of_cube));
  }

  /// Warns where an object's frame, or an SDF's, becomes too small for float32: there, not again below.
  void check_precision() {
    std::stable_sort(origins_.begin(), origins_.end(),
                     [](const Origin& a, const Origin& b) { return a.parent < b.parent; });
    std::vector<ErrorBound> error(module_.objects.size());
    error[module_.root.index] = rounded(glm::dvec3(1.0)).bound;
    std::vector<bool> reported(module_.objects.size(), false);
    for (const Origin& origin : origins_) {  // parents stand before children
      const ErrorBound before = error[origin.parent.index];
      ErrorBound after;
      if (origin.count == 0) continue;
      const auto& candidates = at(module_.regions, origin.region).groups[origin.group].candidates;
      for (std::size_t i = origin.first; i < origin.first + origin.count; ++i) {
        after = worse(after, carry_anywhere(candidates[i].local_from_parent, candidates[i].tiled, before));
      }
      error[origin.child.index] = worse(error[origin.child.index], after);
      if (share(after) <= imprecise_share || share(before) > imprecise_share || reported[origin.child.index]) continue;
      reported[origin.child.index] = true;
      report_imprecise(origin.span, fmt::format("the object '{}'", at(module_.objects, origin.child).name),
                       share(after));
    }
    for (const auto& [sdf, object] : sdf_users_) check_sdf_precision(at(module_.sdfs, sdf), error[object.index]);
  }

  void check_sdf_precision(const Sdf& sdf, const ErrorBound& error) {
    if (share(error) > imprecise_share) return;  // said of the object
    double worst = 0.0;
    for (const Affine& affine : sdf.local_from_object) {
      worst = std::max(worst, share(carry_anywhere(affine, sdf.placement == voml::Placement::tiled, error)));
    }
    if (worst > imprecise_share) report_imprecise(sdf.span, fmt::format("the SDF '{}'", sdf.name), worst);
  }

  std::uint32_t longest_chain() const {
    // Objects stand before those they embed: going backwards, children are known first.
    std::vector<std::uint32_t> below(module_.objects.size(), 1);
    std::vector<std::vector<const Region*>> regions_of(module_.objects.size());
    for (const Region& region : module_.regions) regions_of[region.object.index].push_back(&region);
    for (std::size_t i = module_.objects.size(); i-- > 0;) {
      for (const Region* region : regions_of[i]) {
        for (const auto& group : region->groups) {
          for (const auto& candidate : group.candidates) {
            below[i] = std::max(below[i], below[candidate.object.index] + 1);
          }
        }
      }
    }
    return below[module_.root.index];
  }

  voml::Scene scene_;
  Diagnostics& diagnostics_;
  LowerOptions options_;
  Module module_;
  std::vector<Id<voml::Object>> parents_first_;
  Id<voml::Object> current_;
  Renumber<voml::Object, Object> objects_;
  Renumber<voml::Sdf, Sdf> sdfs_;
  using RegionUse = std::pair<Id<voml::Region>, Id<voml::Object>>;
  std::map<RegionUse, Id<Region>> regions_;
  Renumber<voml::Node, Node> nodes_;
  Renumber<voml::Grid> grids_;
  Renumber<voml::Bitmap> bitmaps_;
  Renumber<voml::Function, Function> functions_;
  std::vector<Origin> origins_;
  std::set<std::pair<Id<Sdf>, Id<Object>>> sdf_users_;
  std::vector<bool> compiled_;  ///< functions, with or without errors
  std::size_t compiled_count_ = 0;
};

}  // namespace

std::optional<Module> lower(voml::Scene scene, Diagnostics& diagnostics, const LowerOptions& options) {
  return Lowering(std::move(scene), diagnostics, options).run();
}

}  // namespace dmvv::compiler
