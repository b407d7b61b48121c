#include "compiler/layout/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/common.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>

#include "compiler/grids/storage.h"
#include "compiler/grids/texels.h"
#include "shaders/records.h"

namespace dmvv::compiler {

namespace {

std::uint64_t volume(const glm::uvec3& v) { return std::uint64_t{v.x} * v.y * v.z; }

struct Placed {
  glm::uvec3 lo;
  glm::uvec3 hi;
};

bool overlap(const Placed& a, const Placed& b) {
  return glm::all(glm::lessThan(a.lo, b.hi)) && glm::all(glm::lessThan(b.lo, a.hi));
}

struct LessZyx {
  bool operator()(const glm::uvec3& a, const glm::uvec3& b) const {
    return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
  }
};
using Points = std::set<glm::uvec3, LessZyx>;

/// Slides `p` down along `axis` until it meets a placed box or the container's wall.
glm::uvec3 project(glm::uvec3 p, int axis, const std::vector<Placed>& placed) {
  std::uint32_t stop = 0;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (const Placed& box : placed) {
    const bool under =
        box.hi[axis] <= p[axis] && box.lo[u] <= p[u] && p[u] < box.hi[u] && box.lo[v] <= p[v] && p[v] < box.hi[v];
    if (under) stop = std::max(stop, box.hi[axis]);
  }
  p[axis] = stop;
  return p;
}

/// The new corners that a box opens: each of its far corners, slid along the two other axes.
void add_extreme_points(const Placed& box, const std::vector<Placed>& placed, Points& points) {
  for (int axis = 0; axis < 3; ++axis) {
    glm::uvec3 corner = box.lo;
    corner[axis] = box.hi[axis];
    for (int slide = 0; slide < 3; ++slide) {
      if (slide != axis) points.insert(project(corner, slide, placed));
    }
    points.insert(corner);
  }
}

}  // namespace

std::optional<Packing> pack_boxes(std::span<const glm::uvec3> sizes, std::uint32_t max_extent) {
  std::vector<std::uint32_t> order(sizes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return volume(sizes[a]) > volume(sizes[b]); });

  Packing packing;
  packing.positions.resize(sizes.size());
  std::vector<Placed> placed;
  Points points{glm::uvec3(0)};
  for (const std::uint32_t index : order) {
    // Step 1: the free corner where the container grows least.
    const glm::uvec3 size = sizes[index];
    std::uint64_t best_volume = std::numeric_limits<std::uint64_t>::max();
    glm::uvec3 best{0};
    for (const glm::uvec3& point : points) {
      if (glm::any(glm::greaterThan(glm::u64vec3(point) + glm::u64vec3(size), glm::u64vec3(max_extent)))) continue;
      const Placed box{point, point + size};
      if (std::any_of(placed.begin(), placed.end(), [&](const Placed& other) { return overlap(box, other); })) continue;
      const std::uint64_t grown = volume(glm::max(packing.extent, box.hi));
      if (grown < best_volume) {
        best_volume = grown;
        best = point;
      }
    }
    if (best_volume == std::numeric_limits<std::uint64_t>::max()) return std::nullopt;
    // Step 2: put it there and offer the corners it opens.
    const Placed box{best, best + size};
    packing.positions[index] = best;
    packing.extent = glm::max(packing.extent, box.hi);
    packing.used += volume(size);
    placed.push_back(box);
    points.erase(best);
    add_extreme_points(box, placed, points);
  }
  return packing;
}

namespace {

std::optional<Atlas> arrange(std::span<const glm::uvec3> interiors, TexelFormat format, std::uint32_t border,
                             std::uint32_t max_extent, std::string_view what, const std::string& largest,
                             Diagnostics& diagnostics) {
  std::vector<glm::uvec3> sizes;
  for (const glm::uvec3& interior : interiors) sizes.push_back(interior + 2 * border);
  const auto packing = pack_boxes(sizes, max_extent);
  if (!packing) {
    diagnostics.report(Code::atlas_too_large, {},
                       fmt::format("the {} of this scene do not fit one 3D texture of at most {} texels a side "
                                   "(borders included); the largest is '{}'",
                                   what, max_extent, largest));
    return std::nullopt;
  }
  Atlas atlas;
  atlas.texture.extent = packing->extent;
  atlas.texture.format = format;
  atlas.texture.texels.resize(volume(packing->extent) * bytes_per_texel(format));
  const std::uint64_t texels = volume(packing->extent);
  atlas.fill = texels == 0 ? 0.0 : static_cast<double>(packing->used) / static_cast<double>(texels);
  atlas.border = border;
  for (const glm::uvec3& position : packing->positions) atlas.slots.push_back(position + border);
  return atlas;
}

/// Copies n interior texels and their border into the atlas row by row: texel(x, y, z) gives the bytes of an interior
/// texel, `fold` maps a border coordinate (below 0, or n and beyond) to the interior one that it repeats.
template <class Texel, class Fold>
void fill_slot(Atlas& atlas, const glm::uvec3& slot, const glm::uvec3& size, Fold&& fold, Texel&& texel) {
  const std::size_t stride = bytes_per_texel(atlas.texture.format);
  const glm::uvec3 extent = atlas.texture.extent;
  const glm::ivec3 n(size);
  const int border = static_cast<int>(atlas.border);
  for (int z = -border; z < n.z + border; ++z) {
    for (int y = -border; y < n.y + border; ++y) {
      const std::size_t row = ((slot.z + z) * std::size_t{extent.y} + (slot.y + y)) * extent.x + slot.x - atlas.border;
      std::byte* out = atlas.texture.texels.data() + row * stride;
      const int iy = fold(y, n.y), iz = fold(z, n.z);
      for (int x = -border; x < n.x + border; ++x, out += stride) texel(fold(x, n.x), iy, iz, out);
    }
  }
}

int clamp_fold(int i, int n) { return std::clamp(i, 0, n - 1); }
int wrap_fold(int i, int n) { return (i + n) % n; }

template <class T>
void store(std::byte* out, const T& value) {
  std::memcpy(out, &value, sizeof value);
}

template <class Asset, class Size>
std::string largest_path(std::span<const Asset> assets, Size&& size) {
  const auto largest =
      std::max_element(assets.begin(), assets.end(), [&](const Asset& a, const Asset& b) { return size(a) < size(b); });
  return largest == assets.end() ? std::string() : largest->path;
}

}  // namespace

std::optional<Atlas> pack_atlas(std::span<const voml::Grid> grids, const GridStorage& storage, std::uint32_t max_extent,
                                Diagnostics& diagnostics) {
  const TexelFormat format = storage.format;
  std::vector<glm::uvec3> sizes;
  for (const voml::Grid& grid : grids) sizes.push_back(grid.size);
  const std::string largest = largest_path(grids, [](const voml::Grid& grid) { return volume(grid.size); });
  const std::uint32_t border = storage.filter == Filter::tricubic ? 2 : 1;
  auto atlas = arrange(sizes, format, border, max_extent, "distance grids", largest, diagnostics);
  if (!atlas) return std::nullopt;
  atlas->texture.name = "grid_atlas";
  atlas->texture.binding = DMVV_BIND_GRID_ATLAS;
  atlas->texture.filtered = storage.filter == Filter::hardware;
  atlas->filter = storage.filter;
  atlas->scales = storage.scales;
  atlas->scales.resize(grids.size(), 1.0);
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const voml::Grid& grid = grids[i];
    const auto value = [&](int x, int y, int z) {
      return grid.values[(std::size_t{grid.size.y} * z + y) * grid.size.x + x];
    };
    const double scale = atlas->scales[i];
    fill_slot(*atlas, atlas->slots[i], grid.size, clamp_fold,
              [&](int x, int y, int z, std::byte* out) { store_texel(value(x, y, z), format, scale, out); });
  }
  return atlas;
}

std::optional<Atlas> pack_bitmaps(std::span<const voml::Bitmap> bitmaps, std::uint32_t max_extent,
                                  Diagnostics& diagnostics) {
  std::vector<glm::uvec3> sizes;
  for (const voml::Bitmap& bitmap : bitmaps) sizes.push_back(glm::uvec3(bitmap.n));
  const std::string largest = largest_path(bitmaps, [](const voml::Bitmap& bitmap) { return bitmap.n; });
  auto atlas = arrange(sizes, TexelFormat::rgba16f, 1, max_extent, "bitmaps", largest, diagnostics);
  if (!atlas) return std::nullopt;
  atlas->texture.name = "bitmap_atlas";
  atlas->texture.binding = DMVV_BIND_BITMAP_ATLAS;
  std::array<std::uint16_t, 256> half_of_byte;
  for (std::size_t v = 0; v < half_of_byte.size(); ++v)
    half_of_byte[v] = glm::packHalf1x16(static_cast<float>(v) / 255.0f);
  for (std::size_t i = 0; i < bitmaps.size(); ++i) {
    const voml::Bitmap& bitmap = bitmaps[i];
    fill_slot(*atlas, atlas->slots[i], glm::uvec3(bitmap.n), wrap_fold, [&](int x, int y, int z, std::byte* out) {
      const glm::u8vec4 t = bitmap.texels[(std::size_t{bitmap.n} * z + y) * bitmap.n + x];
      store(out, std::array{half_of_byte[t.r], half_of_byte[t.g], half_of_byte[t.b], half_of_byte[t.a]});
    });
  }
  return atlas;
}

}  // namespace dmvv::compiler
