#include "compiler/grids/texels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "compiler/grids/grid_bounds.h"
#include "compiler/grids/storage.h"

namespace dmvv::compiler {

namespace {

constexpr float largest_half = 65504.0f;

// Samples around one point differ by the sum of the slopes at most (trilinear). With Catmull-Rom weights, whose
// positive ones sum to W+ = (5/4 + ...)^3 = 1.4766 and negative ones to W- = 0.4766, four samples an axis differ by 3
// slopes, and a sum of zero needs no sample beyond 3 / (1 - W- / W+) = 4.43 of them.
constexpr double reach_trilinear = 1.0;
constexpr double reach_tricubic = 4.5;

template <class T>
void store(std::byte* out, const T& value) {
  std::memcpy(out, &value, sizeof value);
}

/// Steps of a normalised format between 0 and 1.
double steps(TexelFormat format) { return format == TexelFormat::snorm16 ? 32767.0 : 127.0; }

double nearest_step(float value, TexelFormat format, double scale) {
  return std::round(std::clamp(value / scale, -1.0, 1.0) * steps(format));
}

// Beyond half precision's range only the sign matters: the sample is far from any surface.
std::uint16_t half_of(float value) { return glm::packHalf1x16(std::clamp(value, -largest_half, largest_half)); }

std::uint8_t byte_of(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255.0f));
}

}  // namespace

std::size_t bytes_per_texel(TexelFormat format) {
  switch (format) {
    case TexelFormat::r32f:
      return 4;
    case TexelFormat::r16f:
    case TexelFormat::snorm16:
      return 2;
    case TexelFormat::snorm8:
    case TexelFormat::unorm8:
      return 1;
    case TexelFormat::rgba16f:
      return 8;
  }
  return 0;
}

bool is_normalised(TexelFormat format) { return format == TexelFormat::snorm16 || format == TexelFormat::snorm8; }

std::vector<double> texel_scales(const Module& module, TexelFormat format, Filter filter) {
  std::vector<double> scales(module.grids.size(), 1.0);
  if (!is_normalised(format)) return scales;
  std::vector<double> farthest_iso(module.grids.size(), 0.0);
  for (const Sdf& sdf : module.sdfs) {
    const auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source);
    if (grid) farthest_iso[grid->index] = std::max(farthest_iso[grid->index], std::abs(sdf.iso));
  }
  const double reach = filter == Filter::tricubic ? reach_tricubic : reach_trilinear;
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const GridBounds bounds = grid_bounds(module.grids[i]);
    const double slopes = bounds.slope.x + bounds.slope.y + bounds.slope.z;
    const double near = reach * slopes + farthest_iso[i];
    // Samples that are all alike have no slope: then the magnitude is all there is to keep.
    scales[i] = slopes == 0.0 ? bounds.magnitude : std::min(bounds.magnitude, near);
    if (scales[i] == 0.0) scales[i] = 1.0;
  }
  return scales;
}

void store_texel(float value, TexelFormat format, double scale, std::byte* out) {
  switch (format) {
    case TexelFormat::r32f:
      return store(out, value);
    case TexelFormat::r16f:
      return store(out, half_of(value));
    case TexelFormat::snorm16:
      return store(out, static_cast<std::int16_t>(nearest_step(value, format, scale)));
    case TexelFormat::snorm8:
      return store(out, static_cast<std::int8_t>(nearest_step(value, format, scale)));
    case TexelFormat::unorm8:
      return store(out, byte_of(value));
    case TexelFormat::rgba16f:
      return;  // no format of distances
  }
}

voml::Grid as_stored(const voml::Grid& grid, TexelFormat format, double scale) {
  voml::Grid stored = grid;
  for (float& value : stored.values) {
    if (format == TexelFormat::r16f) value = glm::unpackHalf1x16(half_of(value));
    if (is_normalised(format)) value = static_cast<float>(nearest_step(value, format, scale) / steps(format) * scale);
  }
  return stored;
}

}  // namespace dmvv::compiler
