// Module -> the records of shaders/records.h: everything the generic walker needs, and the lists that specialised code
// searches.
#pragma once

#include <cstdint>
#include <vector>

#include "compiler/ir/module.h"
#include "compiler/ir/placements.h"
#include "compiler/layout/atlas.h"
#include "compiler/layout/lookup.h"
#include "compiler/passes/seed_chains.h"
#include "shaders/records.h"

namespace dmvv::compiler {

inline constexpr std::uint32_t no_scaling = ~0u;

/// Records of a module, in its order: sdfs[i] is module.sdfs[i], and so on; nodes are its decisions alone.
struct Records {
  std::vector<gpu::NodeRecord> nodes;
  std::vector<gpu::SdfRecord> sdfs;
  std::vector<gpu::RegionRecord> regions;
  std::vector<gpu::GroupRecord> groups;
  std::vector<gpu::PlacementRecord> placements;
  std::vector<std::uint32_t> cells;
  std::vector<std::uint32_t> lists;
  std::vector<std::uint32_t> gaps;  ///< like cells, if lists are widened (lookup.h: Lookup::gaps)
  std::vector<glm::vec4> scalings;  ///< of seeds that only scale, alike along all axes, and move: q = p * w + xyz
  std::vector<std::uint32_t> first_scaling;  ///< of each SDF; no_scaling where not all its seeds are such
  std::vector<SeedChain> chains;  ///< SDFs that share a lookup: its lists hold the seeds of all, in the chain's order
  std::vector<std::uint32_t> first_seed;  ///< of each SDF: the number of its first seed in the lists; 0 but for chains
  std::vector<std::uint32_t> objects;     ///< the reference of each object's root node (DMVV_REGION_BIT: a region)
};

/// Seeds of all SDFs of a chain, one SDF after the other.
std::vector<PlacedBox> placed_boxes(const SeedChain& chain, const Module& module);
/// The least number of cells that their authors want, along each axis.
glm::uvec3 index_size(const SeedChain& chain, const Module& module);
/// Atlas coordinates (normalised) of a grid's local points.
Affine atlas_from_local(const voml::Grid& grid, const glm::uvec3& slot, const glm::uvec3& atlas_extent);
/// Where the atlas's filter looks a grid's local points up: normalised coordinates for the texture unit, else texels,
/// whose centres are whole numbers.
Affine lookup_from_local(const voml::Grid& grid, Id<voml::Grid> id, const Atlas& atlas);

gpu::AffineRows rows(const Affine& affine);

/// How seeds and candidates are looked up.
struct IndexOptions {
  bool use = true;       ///< false: every lookup is one cell that lists everything
  bool refine = false;   ///< an author's size is no more than a wish for more cells than would be chosen
  double widened = 0.0;  ///< a cell's list also holds placements up to this distance outside the cell, in cells
};

/// Builds all records. Those of SDFs in chains are of no use to the generic walker.
/// Cost: that of build_lookup for each list.
Records flatten(const Module& module, const Atlas& grid_atlas, const Atlas& bitmap_atlas, IndexOptions index,
                std::vector<SeedChain> chains = {});

/// Records as text, one a line, stable.
std::string to_text(const Records& records);
}  // namespace dmvv::compiler
