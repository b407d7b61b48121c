#include "compiler/passes/passes.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <string_view>
#include <tuple>

namespace dmvv::compiler {

namespace {

/// 64-bit FNV-1a; equal hashes are compared byte by byte before they count as equal.
std::uint64_t hash_bytes(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  return hash;
}

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

bool same(const voml::Grid& a, const voml::Grid& b) {
  return a.size == b.size && a.box_lo == b.box_lo && a.box_hi == b.box_hi && bytes_of(a.values) == bytes_of(b.values);
}
bool same(const voml::Bitmap& a, const voml::Bitmap& b) {
  return a.n == b.n && bytes_of(a.texels) == bytes_of(b.texels);
}
const std::vector<float>& content(const voml::Grid& grid) { return grid.values; }
const std::vector<glm::u8vec4>& content(const voml::Bitmap& bitmap) { return bitmap.texels; }

/// For each asset the first one that equals it. Large assets of different sizes are told apart without hashing.
template <class Asset>
std::vector<Id<Asset>> first_equals(const std::vector<Asset>& assets) {
  std::map<std::size_t, std::vector<std::uint32_t>> by_size;
  for (std::uint32_t i = 0; i < assets.size(); ++i) by_size[content(assets[i]).size()].push_back(i);
  std::vector<Id<Asset>> first(assets.size());
  for (const auto& [size, indices] : by_size) {
    std::map<std::uint64_t, std::vector<std::uint32_t>> by_hash;
    for (const std::uint32_t i : indices) {
      auto& bucket = by_hash[indices.size() == 1 ? 0 : hash_bytes(bytes_of(content(assets[i])))];
      const auto twin = std::find_if(bucket.begin(), bucket.end(), [&](auto j) { return same(assets[i], assets[j]); });
      first[i] = {twin == bucket.end() ? i : *twin};
      if (twin == bucket.end()) bucket.push_back(i);
    }
  }
  return first;
}

/// Removes the elements that are not kept and returns where the others went.
template <class T>
std::vector<Id<T>> compact(std::vector<T>& elements, const std::vector<bool>& kept) {
  std::vector<Id<T>> to(elements.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (!kept[i]) continue;
    to[i] = {next};
    if (next != i) elements[next] = std::move(elements[i]);
    ++next;
  }
  elements.erase(elements.begin() + next, elements.end());
  return to;
}

struct Reached {
  explicit Reached(const Module& m)
      : objects(m.objects.size()),
        nodes(m.nodes.size()),
        sdfs(m.sdfs.size()),
        regions(m.regions.size()),
        grids(m.grids.size()),
        bitmaps(m.bitmaps.size()),
        functions(m.functions.size()) {}
  std::vector<bool> objects, nodes, sdfs, regions, grids, bitmaps, functions;
};

void reach_sdf(const Module& module, Id<Sdf> id, Reached& reached) {
  reached.sdfs[id.index] = true;
  const auto& source = at(module.sdfs, id).source;
  if (const auto* grid = std::get_if<Id<voml::Grid>>(&source)) reached.grids[grid->index] = true;
  if (const auto* function = std::get_if<Id<Function>>(&source)) reached.functions[function->index] = true;
}

void reach_region(const Module& module, Id<Region> id, Reached& reached) {
  reached.regions[id.index] = true;
  const Region& region = at(module.regions, id);
  if (region.kind == voml::RegionKind::bitmap) reached.bitmaps[region.bitmap.index] = true;
  for (const CandidateGroup& group : region.groups) {
    for (const Candidate& candidate : group.candidates) reached.objects[candidate.object.index] = true;
  }
}

void reach_tree(const Module& module, Id<Node> root, Reached& reached) {
  std::vector<Id<Node>> pending{root};
  while (!pending.empty()) {
    const Id<Node> id = pending.back();
    pending.pop_back();
    if (reached.nodes[id.index]) continue;
    reached.nodes[id.index] = true;
    const auto& node = at(module.nodes, id).content;
    if (const auto* region = std::get_if<Id<Region>>(&node)) {
      reach_region(module, *region, reached);
    } else {
      const auto& decision = std::get<Decision>(node);
      reach_sdf(module, decision.sdf, reached);
      pending.push_back(decision.negative);
      pending.push_back(decision.positive);
    }
  }
}

Reached reach(const Module& module) {
  Reached reached(module);
  reached.objects[module.root.index] = true;
  // Parents stand before the objects they embed: one sweep suffices.
  for (std::size_t i = 0; i < module.objects.size(); ++i) {
    if (reached.objects[i]) reach_tree(module, module.objects[i].root, reached);
  }
  return reached;
}

/// Removes grids, bitmaps and functions that nothing refers to any more.
void drop_unused_assets(Module& module) {
  const Reached reached = reach(module);
  const auto grids = compact(module.grids, reached.grids);
  const auto bitmaps = compact(module.bitmaps, reached.bitmaps);
  const auto functions = compact(module.functions, reached.functions);
  for (Sdf& sdf : module.sdfs) {
    if (auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source)) *grid = grids[grid->index];
    if (auto* function = std::get_if<Id<Function>>(&sdf.source)) *function = functions[function->index];
  }
  for (Region& region : module.regions) {
    if (region.kind == voml::RegionKind::bitmap) region.bitmap = bitmaps[region.bitmap.index];
  }
}

/// Snippets are equal if the programs that they were understood as are written out alike.
void merge_functions(Module& module) {
  std::map<std::string, Id<Function>> by_text;
  std::vector<Id<Function>> first(module.functions.size());
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    first[i] = by_text.try_emplace(module.functions[i].snippet.glsl("f", 0), Id<Function>{i}).first->second;
  }
  for (Sdf& sdf : module.sdfs) {
    if (auto* function = std::get_if<Id<Function>>(&sdf.source)) *function = first[function->index];
  }
}

}  // namespace

void merge_assets(Module& module) {
  const auto grids = first_equals(module.grids);
  const auto bitmaps = first_equals(module.bitmaps);
  for (Sdf& sdf : module.sdfs) {
    if (auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source)) *grid = grids[grid->index];
  }
  for (Region& region : module.regions) {
    if (region.kind == voml::RegionKind::bitmap) region.bitmap = bitmaps[region.bitmap.index];
  }
  merge_functions(module);
  drop_unused_assets(module);
}

void prune_sides(Module& module) {
  // Value numbering: two nodes get the same number if they are the same leaf or the same decision over equal sides.
  // Children stand after their parents, so a backward sweep meets the sides first.
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  std::vector<std::uint32_t> number(module.nodes.size());
  std::vector<Id<Node>> to(module.nodes.size());
  for (std::uint32_t i = static_cast<std::uint32_t>(module.nodes.size()); i-- > 0;) {
    auto& node = module.nodes[i].content;
    std::tuple<std::uint32_t, std::uint32_t, std::uint32_t> key;
    to[i] = {i};
    if (const auto* region = std::get_if<Id<Region>>(&node)) {
      key = {Id<Sdf>::invalid_index, region->index, 0};
    } else {
      auto& decision = std::get<Decision>(node);
      decision.positive = to[decision.positive.index];
      decision.negative = to[decision.negative.index];
      const std::uint32_t positive = number[decision.positive.index];
      const std::uint32_t negative = number[decision.negative.index];
      if (positive == negative) {
        to[i] = decision.positive;
        number[i] = positive;
        continue;
      }
      key = {decision.sdf.index, positive, negative};
    }
    number[i] = numbers.try_emplace(key, static_cast<std::uint32_t>(numbers.size())).first->second;
  }
  for (Object& object : module.objects) object.root = to[object.root.index];
}

void drop_unreachable(Module& module) {
  const Reached reached = reach(module);
  const auto objects = compact(module.objects, reached.objects);
  const auto nodes = compact(module.nodes, reached.nodes);
  const auto sdfs = compact(module.sdfs, reached.sdfs);
  const auto regions = compact(module.regions, reached.regions);
  module.root = objects[module.root.index];
  for (Object& object : module.objects) object.root = nodes[object.root.index];
  for (Node& node : module.nodes) {
    if (auto* region = std::get_if<Id<Region>>(&node.content)) {
      *region = regions[region->index];
    } else {
      auto& decision = std::get<Decision>(node.content);
      decision = {sdfs[decision.sdf.index], nodes[decision.positive.index], nodes[decision.negative.index]};
    }
  }
  for (Region& region : module.regions) {
    region.object = objects[region.object.index];
    for (CandidateGroup& group : region.groups) {
      for (Candidate& candidate : group.candidates) candidate.object = objects[candidate.object.index];
    }
  }
  drop_unused_assets(module);
}

}  // namespace dmvv::compiler
