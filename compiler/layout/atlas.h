// Distance grids or bitmaps of a module packed into one 3D texture.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "compiler/grids/storage.h"
#include "compiler/ir/module.h"
#include "compiler/layout/resources.h"

namespace dmvv::compiler {

/// Where boxes were put in a container; positions are the lowest texels.
struct Packing {
  glm::uvec3 extent{0};
  std::vector<glm::uvec3> positions;
  std::uint64_t used = 0;  ///< texels covered by boxes
};

/// Places boxes without overlap in a container that grows as little as it can.
///
/// Largest box first; each goes to the extreme point where the container's volume grows least, then lowest in z, y, x.
/// In:     sizes, each component at least 1.
/// Out:    positions[i] of sizes[i]; the same input gives the same packing.
/// Errors: empty if some box fits nowhere within max_extent.
/// Cost:   O(n^3) in the worst case, n being the number of different grids (tens).
/// Source: Crainic, Perboli, Tadei 2008, "Extreme point-based heuristics for three-dimensional bin packing".
std::optional<Packing> pack_boxes(std::span<const glm::uvec3> sizes, std::uint32_t max_extent);

/// A packed texture. Slots give the first texel of the interior; a border lies around it.
struct Atlas {
  Texture texture;
  std::vector<glm::uvec3> slots;
  std::vector<double> scales;  ///< of distance grids: value = texel * scale
  Filter filter = Filter::hardware;
  std::uint32_t border = 1;  ///< texels
  double fill = 0.0;         ///< share of the texture that holds samples or borders
};

/// How the samples of distance grids are stored.
struct GridStorage {
  TexelFormat format = TexelFormat::r32f;
  Filter filter = Filter::hardware;  ///< tricubic needs a border of two texels, the others one
  std::vector<double> scales{};      ///< texel_scales of the grids; none: all 1
};

/// Packs the grids' samples, each with a border that repeats its outer samples (sampling clamps).
///
/// Errors: E0303 the packed extent exceeds max_extent (names the largest grid).
/// Source: thesis section 4.3.2; Wang et al. 2011 use 3D bin packing.
std::optional<Atlas> pack_atlas(std::span<const voml::Grid> grids, const GridStorage& storage, std::uint32_t max_extent,
                                Diagnostics& diagnostics);

/// Packs bitmaps as rgba16f (8-bit values are exact in it to 1/8 of a step; lavapipe filters 8-bit textures with
/// coarse weights), each with a border of its opposite side (sampling wraps around).
std::optional<Atlas> pack_bitmaps(std::span<const voml::Bitmap> bitmaps, std::uint32_t max_extent,
                                  Diagnostics& diagnostics);

}  // namespace dmvv::compiler
