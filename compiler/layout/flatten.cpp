#include "compiler/layout/flatten.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <glm/common.hpp>

#include "base/parallel.h"
#include "compiler/grids/storage.h"
#include "compiler/ir/placements.h"

namespace dmvv::compiler {

namespace {

glm::vec4 vec(const glm::dvec3& v, double w = 0.0) { return glm::vec4(glm::dvec4(v, w)); }

/// How far a box reaches from the middle along each axis, in 1024ths less one, rounded up: 10 bits each.
std::uint32_t packed_extent(const LocalBox& box) {
  const glm::dvec3 reach = glm::max(glm::abs(box.lo), glm::abs(box.hi));
  const glm::uvec3 steps = glm::uvec3(glm::clamp(glm::ceil(reach * 1024.0), glm::dvec3(1.0), glm::dvec3(1024.0))) - 1u;
  return steps.x | steps.y << 10 | steps.z << 20;
}

class Flattening {
 public:
  Flattening(const Module& module, const Atlas& grid_atlas, const Atlas& bitmap_atlas, IndexOptions index,
             std::vector<SeedChain> chains)
      : module_(module), grid_atlas_(grid_atlas), bitmap_atlas_(bitmap_atlas), index_(index) {
    out_.chains = std::move(chains);
  }

  Records run() {
    number_decisions();
    order_sdfs();
    build_lookups();
    for (const Object& object : module_.objects) out_.objects.push_back(references_[object.root.index]);
    for (const Node& node : module_.nodes) {
      if (const auto* decision = std::get_if<Decision>(&node.content)) out_.nodes.push_back(flatten_node(*decision));
    }
    for (const auto& [id, chain] : sdfs_) flatten_sdf(id, chain);
    for (const Region& region : module_.regions) out_.regions.push_back(flatten_region(region));
    return std::move(out_);
  }

 private:
  /// Only decisions become records; a reference to a leaf names its region.
  void number_decisions() {
    std::uint32_t decisions = 0;
    for (const Node& node : module_.nodes) {
      const auto* region = std::get_if<Id<Region>>(&node.content);
      references_.push_back(region ? (region->index | DMVV_REGION_BIT) : decisions++);
    }
  }

  /// Rows of a chain stand one after the other: its SDFs follow its first one.
  void order_sdfs() {
    std::vector<const SeedChain*> chain_of(module_.sdfs.size(), nullptr);
    for (const SeedChain& chain : out_.chains) {
      for (const Id<Sdf> sdf : chain) chain_of[sdf.index] = &chain;
    }
    for (std::uint32_t i = 0; i < module_.sdfs.size(); ++i) {
      const SeedChain* const chain = chain_of[i];
      if (chain == nullptr)
        sdfs_.emplace_back(Id<Sdf>{i}, nullptr);
      else if (chain->front() == Id<Sdf>{i})
        for (const Id<Sdf> sdf : *chain) sdfs_.emplace_back(sdf, chain);
    }
    out_.sdfs.resize(module_.sdfs.size());
    out_.first_scaling.resize(module_.sdfs.size(), no_scaling);
    out_.first_seed.resize(module_.sdfs.size(), 0);
  }
  static bool has_own_lookup(Id<Sdf> id, const SeedChain* chain) { return chain == nullptr || chain->front() == id; }

  gpu::NodeRecord flatten_node(const Decision& decision) const {
    return {decision.sdf.index, references_[decision.positive.index], references_[decision.negative.index], 0};
  }

  void flatten_sdf(Id<Sdf> id, const SeedChain* chain) {
    const Sdf& sdf = at(module_.sdfs, id);
    gpu::SdfRecord& record = out_.sdfs[id.index];
    const LocalBox box = local_box(sdf, module_);
    record.box_lo = vec(box.lo, sdf.iso);
    record.box_hi = vec(box.hi);
    if (const auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source)) {
      const Affine atlas = lookup_from_local(at(module_.grids, *grid), *grid, grid_atlas_);
      record.box_lo.w = static_cast<float>(sdf.iso / grid_atlas_.scales[grid->index]);
      record.atlas_scale = vec({atlas.linear[0][0], atlas.linear[1][1], atlas.linear[2][2]});
      record.atlas_offset = vec(atlas.translation);
      record.function = DMVV_NO_FUNCTION;
    } else {
      record.function = std::get<Id<Function>>(sdf.source).index;
    }
    record.kind = static_cast<std::uint32_t>(sdf.placement);
    record.first_placement = static_cast<std::uint32_t>(out_.placements.size());
    for (const Affine& affine : sdf.local_from_object) out_.placements.push_back({rows(affine), 0, 0, 0, 0});
    if (only_scale(sdf)) append_scalings(id);
    if (sdf.placement != voml::Placement::seeded) return;
    if (has_own_lookup(id, chain)) {
      record.lookup = append_lookup();
      return;
    }
    const gpu::SdfRecord& first = out_.sdfs[chain->front().index];
    record.lookup = first.lookup;
    out_.first_seed[id.index] = record.first_placement - first.first_placement;
  }

  /// A quarter of the loads of a placement.
  void append_scalings(Id<Sdf> id) {
    out_.first_scaling[id.index] = static_cast<std::uint32_t>(out_.scalings.size());
    for (const Affine& a : at(module_.sdfs, id).local_from_object)
      out_.scalings.push_back(vec(a.translation, a.linear[0].x));
  }

  gpu::RegionRecord flatten_region(const Region& region) {
    gpu::RegionRecord record{};
    record.color = vec(region.rgb, region.opacity);
    record.texture_from_object = rows(region.texture_from_object);
    if (region.kind == voml::RegionKind::bitmap) {
      const glm::dvec3 extent(bitmap_atlas_.texture.extent);
      const glm::dvec3 slot(bitmap_atlas_.slots[region.bitmap.index]);
      record.slot_scale = vec(glm::dvec3(at(module_.bitmaps, region.bitmap).n) / extent, 1.0);
      record.slot_offset = vec(slot / extent);
    }
    record.number = region.number;
    record.first_group = static_cast<std::uint32_t>(out_.groups.size());
    record.group_count = static_cast<std::uint32_t>(region.groups.size());
    for (const CandidateGroup& group : region.groups) out_.groups.push_back(flatten_group(group));
    return record;
  }

  gpu::GroupRecord flatten_group(const CandidateGroup& group) {
    gpu::GroupRecord record{};
    record.has_box = group.box_from_object.has_value();
    record.box_from_object = rows(group.box_from_object.value_or(Affine{}));
    record.first_placement = static_cast<std::uint32_t>(out_.placements.size());
    record.first_number = group.first_number;
    for (const Candidate& candidate : group.candidates) {
      const std::uint32_t extent = packed_extent(at(module_.objects, candidate.object).content);
      out_.placements.push_back(
          {rows(candidate.local_from_parent), candidate.object.index, candidate.tiled, extent, 0});
    }
    record.lookup = append_lookup();
    return record;
  }

  /// All lists' lookup grids, in the order in which append_lookup takes them, on all cores: each is built by itself.
  void build_lookups() {
    std::vector<std::function<Lookup()>> jobs;
    const auto wish = [&](const glm::uvec3& authors) { return index_.use ? authors : glm::uvec3(1); };
    for (const auto& [id, chain] : sdfs_) {
      const Sdf& sdf = at(module_.sdfs, id);
      if (sdf.placement != voml::Placement::seeded || !has_own_lookup(id, chain)) continue;
      jobs.emplace_back([&, all = chain] {
        return build_lookup(all != nullptr ? placed_boxes(*all, module_) : placed_boxes(sdf, module_),
                            wish(all != nullptr ? index_size(*all, module_) : sdf.index_size), glm::dvec3(0.0),
                            index_.refine, index_.widened);
      });
    }
    for (const Region& region : module_.regions) {
      for (const CandidateGroup& group : region.groups) {
        jobs.emplace_back([&] {
          return build_lookup(placed_boxes(group, module_), wish(group.index_size), lookup_frame_error(group),
                              index_.refine, index_.widened);
        });
      }
    }
    lookups_.resize(jobs.size());
    in_parallel(jobs.size(), [&](std::size_t i) { lookups_[i] = jobs[i](); });
  }

  gpu::LookupRecord append_lookup() {
    const Lookup lookup = std::move(lookups_[next_lookup_++]);
    gpu::LookupRecord record{};
    record.lo = vec(lookup.lo);
    record.cells_per_unit = vec(glm::dvec3(lookup.size) / (lookup.hi - lookup.lo));
    record.size_x = lookup.size.x;
    record.size_y = lookup.size.y;
    record.size_z = lookup.size.z;
    record.first_cell = static_cast<std::uint32_t>(out_.cells.size());
    const auto first_entry = static_cast<std::uint32_t>(out_.lists.size());
    if (!lookup.gaps.empty()) {
      out_.gaps.insert(out_.gaps.end(), lookup.gaps.begin(), lookup.gaps.end());
      out_.gaps.push_back(0);  // cells have an end
    }
    for (const std::uint32_t start : lookup.cells) out_.cells.push_back(first_entry + start);
    out_.lists.insert(out_.lists.end(), lookup.lists.begin(), lookup.lists.end());
    return record;
  }

  const Module& module_;
  const Atlas& grid_atlas_;
  const Atlas& bitmap_atlas_;
  IndexOptions index_;
  std::vector<std::uint32_t> references_;                   // of each node
  std::vector<std::pair<Id<Sdf>, const SeedChain*>> sdfs_;  // in the order of their rows
  std::vector<Lookup> lookups_;
  std::size_t next_lookup_ = 0;
  Records out_;
};

}  // namespace

gpu::AffineRows rows(const Affine& affine) {
  const glm::dmat3& m = affine.linear;
  const glm::dvec3& t = affine.translation;
  return {vec({m[0].x, m[1].x, m[2].x}, t.x), vec({m[0].y, m[1].y, m[2].y}, t.y), vec({m[0].z, m[1].z, m[2].z}, t.z)};
}

Affine atlas_from_local(const voml::Grid& grid, const glm::uvec3& slot, const glm::uvec3& atlas_extent) {
  const glm::dvec3 texels_per_unit = glm::dvec3(grid.size) / (grid.box_hi - grid.box_lo);
  const glm::dvec3 scale = texels_per_unit / glm::dvec3(atlas_extent);
  const glm::dvec3 offset = (glm::dvec3(slot) - grid.box_lo * texels_per_unit) / glm::dvec3(atlas_extent);
  return {glm::dmat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z), offset};
}

Affine lookup_from_local(const voml::Grid& grid, Id<voml::Grid> id, const Atlas& atlas) {
  const glm::uvec3& slot = atlas.slots[id.index];
  if (atlas.filter == Filter::hardware) return atlas_from_local(grid, slot, atlas.texture.extent);
  Affine texels = atlas_from_local(grid, slot, glm::uvec3(1));
  texels.translation -= 0.5;
  return texels;
}

std::vector<PlacedBox> placed_boxes(const SeedChain& chain, const Module& module) {
  std::vector<PlacedBox> boxes;
  for (const Id<Sdf> sdf : chain) {
    const std::vector<PlacedBox> own = placed_boxes(at(module.sdfs, sdf), module);
    boxes.insert(boxes.end(), own.begin(), own.end());
  }
  return boxes;
}

glm::uvec3 index_size(const SeedChain& chain, const Module& module) {
  glm::uvec3 size(0);
  for (const Id<Sdf> sdf : chain) size = glm::max(size, at(module.sdfs, sdf).index_size);
  return size;
}

Records flatten(const Module& module, const Atlas& grid_atlas, const Atlas& bitmap_atlas, IndexOptions index,
                std::vector<SeedChain> chains) {
  return Flattening(module, grid_atlas, bitmap_atlas, index, std::move(chains)).run();
}

namespace {

std::string text(const glm::vec4& v) { return fmt::format("({} {} {} | {})", v.x, v.y, v.z, v.w); }
std::string text(const gpu::AffineRows& a) { return fmt::format("[{} {} {}]", text(a.x), text(a.y), text(a.z)); }
std::string text(const gpu::LookupRecord& l) {
  return fmt::format("lookup {}x{}x{} lo {} per_unit {} first_cell {}", l.size_x, l.size_y, l.size_z, text(l.lo),
                     text(l.cells_per_unit), l.first_cell);
}
std::string reference_text(std::uint32_t reference) {
  return reference & DMVV_REGION_BIT ? fmt::format("region {}", reference & ~DMVV_REGION_BIT)
                                     : fmt::format("node {}", reference);
}

}  // namespace

std::string to_text(const Records& records) {
  std::string out;
  const auto line = [&](const char* kind, std::size_t index, const std::string& rest) {
    out += fmt::format("{} {}: {}\n", kind, index, rest);
  };
  for (std::size_t i = 0; i < records.objects.size(); ++i) line("object", i, reference_text(records.objects[i]));
  for (std::size_t i = 0; i < records.nodes.size(); ++i) {
    const auto& n = records.nodes[i];
    line("node", i, fmt::format("sdf {} + {} - {}", n.sdf, reference_text(n.positive), reference_text(n.negative)));
  }
  for (std::size_t i = 0; i < records.sdfs.size(); ++i) {
    const auto& s = records.sdfs[i];
    line("sdf", i,
         fmt::format("kind {} function {} first_placement {} box {} {} atlas {} {} {}", s.kind,
                     static_cast<std::int32_t>(s.function), s.first_placement, text(s.box_lo), text(s.box_hi),
                     text(s.atlas_scale), text(s.atlas_offset), text(s.lookup)));
  }
  for (std::size_t i = 0; i < records.regions.size(); ++i) {
    const auto& r = records.regions[i];
    line("region", i,
         fmt::format("number {} groups {}+{} color {} slot {} {} texture {}", r.number, r.first_group, r.group_count,
                     text(r.color), text(r.slot_scale), text(r.slot_offset), text(r.texture_from_object)));
  }
  for (std::size_t i = 0; i < records.groups.size(); ++i) {
    const auto& g = records.groups[i];
    line("group", i,
         fmt::format("box {} {} first_placement {} first_number {} {}", g.has_box, text(g.box_from_object),
                     g.first_placement, g.first_number, text(g.lookup)));
  }
  for (std::size_t i = 0; i < records.placements.size(); ++i) {
    const auto& p = records.placements[i];
    line("placement", i, fmt::format("object {} tiled {} {}", p.object, p.tiled, text(p.local_from_object)));
  }
  out += fmt::format("cells {}\nlists {}\n", records.cells.size(), records.lists.size());
  return out;
}

}  // namespace dmvv::compiler
