#include "compiler/thesis/thesis.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <numeric>

#include "compiler/grids/storage.h"
#include "compiler/grids/texels.h"

namespace dmvv::compiler {

namespace {

// Index coordinates run from 0 to 1; the published program moves them by a thousandth before it looks for the cell.
constexpr double shrink = 0.001;

std::size_t texel_count(const glm::uvec3& extent) { return std::size_t{extent.x} * extent.y * extent.z; }

std::size_t cell_count(const glm::uvec3& size) { return std::size_t{size.x} * size.y * size.z; }

struct CellRange {
  glm::ivec3 first;
  glm::ivec3 last;  ///< included; before first: no cell
};

/// The cells that a placed cube is entered in: those between the cells of its corners, cut to the grid.
CellRange cells_of(const Affine& local_from_object, const Affine& index_from_object, const glm::uvec3& size) {
  const Affine index_from_local = index_from_object * inverse(local_from_object);
  glm::dvec3 lo(1e300), hi(-1e300);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 local(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const glm::dvec3 cell = glm::floor((index_from_local(local) * 0.5 + 0.5 - shrink) * glm::dvec3(size));
    lo = glm::min(lo, cell);
    hi = glm::max(hi, cell);
  }
  const glm::dvec3 last = glm::dvec3(size) - 1.0;
  return {glm::ivec3(glm::clamp(lo, glm::dvec3(0.0), last + 1.0)), glm::ivec3(glm::clamp(hi, glm::dvec3(-1.0), last))};
}

/// A list that the published program searches through one index grid.
struct Index {
  glm::uvec3 size{1};
  Affine index_from_object;
  bool entered_by_corners = true;  ///< else everything stands in the only cell
  struct Entry {
    Affine local_from_object;
    std::uint32_t object = 0, tiled = 0, candidate = 0;
  };
  std::vector<Entry> entries;
};

std::vector<std::vector<std::uint32_t>> fill_cells(const Index& index) {
  std::vector<std::vector<std::uint32_t>> cells(cell_count(index.size));
  for (std::uint32_t i = 0; i < index.entries.size(); ++i) {
    if (!index.entered_by_corners) {
      cells[0].push_back(i);
      continue;
    }
    const CellRange range = cells_of(index.entries[i].local_from_object, index.index_from_object, index.size);
    for (int x = range.first.x; x <= range.last.x; ++x) {
      for (int y = range.first.y; y <= range.last.y; ++y) {
        for (int z = range.first.z; z <= range.last.z; ++z) {
          const std::size_t row = static_cast<std::size_t>(x) * index.size.y + static_cast<std::size_t>(y);
          cells[row * index.size.z + static_cast<std::size_t>(z)].push_back(i);
        }
      }
    }
  }
  return cells;
}

std::uint64_t entry_count(const Index& index) {
  if (!index.entered_by_corners) return index.entries.size();
  std::uint64_t count = 0;
  for (const Index::Entry& entry : index.entries) {
    const CellRange range = cells_of(entry.local_from_object, index.index_from_object, index.size);
    const glm::i64vec3 width = glm::max(range.last - range.first + 1, glm::ivec3(0));
    count += static_cast<std::uint64_t>(width.x * width.y * width.z);
  }
  return count;
}

/// Seeds: the SDF's own `index`, or one cell.
Index index_of(const Sdf& sdf) {
  Index index;
  index.size = glm::max(sdf.index_size, glm::uvec3(1));
  for (const Affine& affine : sdf.local_from_object) index.entries.push_back({affine});
  return index;
}

/// Candidates: the region's first INDEX alone, if it has any; else all of them in one cell.
Index index_of(const Region& region) {
  Index index;
  const auto add = [&](const CandidateGroup& group, bool may_tile) {
    std::uint32_t number = group.first_number;
    for (const Candidate& candidate : group.candidates) {
      index.entries.push_back(
          {candidate.local_from_parent, candidate.object.index, may_tile && candidate.tiled, number++});
    }
  };
  for (const CandidateGroup& group : region.groups) {
    if (!group.box_from_object) continue;
    index.size = glm::max(group.index_size, glm::uvec3(1));
    index.index_from_object = *group.box_from_object;
    add(group, false);
    return index;
  }
  index.entered_by_corners = false;
  for (const CandidateGroup& group : region.groups) add(group, true);
  return index;
}

class ThesisFlattening {
 public:
  explicit ThesisFlattening(Records records) : out_(std::move(records)), placements_(std::move(out_.placements)) {
    out_.placements.clear();
    out_.groups.clear();
    out_.cells.clear();
    out_.lists.clear();
  }

  Records run(const Module& module) {
    for (std::size_t i = 0; i < module.sdfs.size(); ++i) place_sdf(module.sdfs[i], out_.sdfs[i]);
    for (std::size_t i = 0; i < module.regions.size(); ++i) place_region(module.regions[i], out_.regions[i]);
    return std::move(out_);
  }

 private:
  void place_sdf(const Sdf& sdf, gpu::SdfRecord& record) {
    if (sdf.placement == voml::Placement::seeded) {
      record.lookup = append(index_of(sdf));
      return;
    }
    out_.placements.push_back(placements_[record.first_placement]);
    record.first_placement = static_cast<std::uint32_t>(out_.placements.size() - 1);
  }

  void place_region(const Region& region, gpu::RegionRecord& record) {
    record.first_group = static_cast<std::uint32_t>(out_.groups.size());
    record.group_count = region.groups.empty() ? 0 : 1;
    if (region.groups.empty()) return;
    const Index index = index_of(region);
    gpu::GroupRecord group{};
    group.has_box = 1;
    group.box_from_object = rows(index.index_from_object);
    group.lookup = append(index);
    out_.groups.push_back(group);
  }

  gpu::LookupRecord append(const Index& index) {
    gpu::LookupRecord record{};
    record.size_x = index.size.x;
    record.size_y = index.size.y;
    record.size_z = index.size.z;
    record.first_cell = static_cast<std::uint32_t>(out_.cells.size() / 2);
    for (const std::vector<std::uint32_t>& cell : fill_cells(index)) {
      out_.cells.push_back(static_cast<std::uint32_t>(out_.placements.size()));
      out_.cells.push_back(static_cast<std::uint32_t>(cell.size()));
      for (const std::uint32_t i : cell) {
        const Index::Entry& entry = index.entries[i];
        out_.placements.push_back({rows(entry.local_from_object), entry.object, entry.tiled, entry.candidate, 0});
      }
    }
    return record;
  }

  Records out_;
  std::vector<gpu::PlacementRecord> placements_;  // as flatten has them
};

std::size_t row_axis(const glm::uvec3& largest) {
  if (largest.x <= largest.y) return largest.x <= largest.z ? 0 : 2;
  return largest.y <= largest.z ? 1 : 2;
}

}  // namespace

bool fits_thesis(const Module& module, Diagnostics& diagnostics) {
  std::uint64_t instances = module.objects.size(), cells = 0;
  const auto count = [&](const Index& index) {
    instances += entry_count(index);
    cells += cell_count(index.size);
  };
  for (const Sdf& sdf : module.sdfs) {
    if (sdf.placement == voml::Placement::seeded) count(index_of(sdf));
  }
  for (const Region& region : module.regions) {
    if (!region.groups.empty()) count(index_of(region));
  }
  bool fits = true;
  const auto check = [&](std::uint64_t needed, std::uint32_t limit, const char* what) {
    if (needed <= limit) return;
    fits = false;
    diagnostics.report(
        Code::thesis_limit, {},
        fmt::format("the published implementation has room for {} {}; this scene needs {}: compile it in "
                    "another form than thesis",
                    limit, what, needed));
  };
  check(module.sdfs.size(), thesis_limits.sdfs, "SDFs");
  check(module.regions.size(), thesis_limits.regions, "regions");
  check(module.nodes.size(), thesis_limits.nodes, "nodes");
  check(instances, thesis_limits.instances, "instances in the cells of its index grids");
  check(cells, thesis_limits.cells, "cells of index grids");
  return fits;
}

std::optional<Atlas> pack_thesis_atlas(std::span<const voml::Grid> grids, std::uint32_t max_extent,
                                       Diagnostics& diagnostics) {
  Atlas atlas;
  atlas.border = 0;
  atlas.scales.assign(grids.size(), 1.0);
  atlas.slots.resize(grids.size());
  atlas.texture.name = "grid_atlas";
  atlas.texture.binding = DMVV_BIND_GRID_ATLAS;
  atlas.texture.format = TexelFormat::unorm8;
  if (grids.empty()) return atlas;

  // Step 1: one row of grids.
  glm::uvec3 extent{0};
  for (const voml::Grid& grid : grids) extent = glm::max(extent, grid.size);
  const auto axis = static_cast<int>(row_axis(extent));
  std::vector<std::size_t> order(grids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return texel_count(grids[a].size) > texel_count(grids[b].size); });
  std::uint64_t end = 0, used = 0;
  for (const std::size_t i : order) {
    atlas.slots[i] = glm::uvec3(0);
    atlas.slots[i][axis] = static_cast<std::uint32_t>(std::min<std::uint64_t>(end, max_extent));
    end += grids[i].size[axis];
    used += texel_count(grids[i].size);
  }
  extent[axis] = static_cast<std::uint32_t>(std::min<std::uint64_t>(end, std::uint64_t{max_extent} + 1));
  for (int a = 0; a < 3; ++a) extent[a] = std::bit_ceil(extent[a]);
  if (std::max({extent.x, extent.y, extent.z}) > max_extent) {
    diagnostics.report(Code::atlas_too_large, {},
                       fmt::format("the distance grids of this scene in one row, as the published implementation has "
                                   "them, exceed {} texels a side",
                                   max_extent));
    return std::nullopt;
  }
  // Step 2: the texels, and 1 for what no grid covers.
  atlas.texture.extent = extent;
  atlas.texture.texels.assign(texel_count(extent), std::byte{255});
  atlas.fill = static_cast<double>(used) / static_cast<double>(texel_count(extent));
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const voml::Grid& grid = grids[i];
    const glm::uvec3 slot = atlas.slots[i];
    std::size_t sample = 0;
    for (std::uint32_t z = 0; z < grid.size.z; ++z) {
      for (std::uint32_t y = 0; y < grid.size.y; ++y) {
        const std::size_t row = ((std::size_t{slot.z} + z) * extent.y + slot.y + y) * extent.x + slot.x;
        for (std::uint32_t x = 0; x < grid.size.x; ++x, ++sample) {
          store_texel(grid.values[sample] * 0.5f + 0.5f, TexelFormat::unorm8, 1.0, &atlas.texture.texels[row + x]);
        }
      }
    }
  }
  return atlas;
}

Records flatten_thesis(const Module& module, const Atlas& grid_atlas, const Atlas& bitmap_atlas) {
  return ThesisFlattening(flatten(module, grid_atlas, bitmap_atlas, {.use = false})).run(module);
}

}  // namespace dmvv::compiler
