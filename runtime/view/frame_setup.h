// Inside the runtime only: a view, checked and turned into what the shaders are told. Pure values.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "base/result.h"
#include "runtime/view/view.h"
#include "shaders/raster.h"
#include "shaders/rays.h"
#include "shaders/records.h"
#include "voml/assets/mesh.h"

namespace dmvv::runtime {

/// Pixels [lo, hi).
struct PixelRange {
  glm::uvec2 lo{0};
  glm::uvec2 hi{0};
};

inline constexpr std::uint32_t longest_picture_px = 16384;

/// The rays of a perspective picture: eye + t * (corner + x * step_x + y * step_y) through pixel (x, y), t being depth.
struct RayFrame {
  glm::dvec3 eye, corner, step_x, step_y;
  voml::Bounds bounds;  ///< nothing is seen beyond
  double depth;         ///< nothing is seen before it
};

struct FrameSetup {
  glm::uvec2 size_px{0};       ///< what is rendered: the picture times the samples
  PixelRange seen;             ///< where anything can show; whole pixels of the picture
  gpu::RasterParams raster{};  ///< unused for slices; its tile is set for each tile
  gpu::FrameParams pixels{};   ///< its size is set for each tile
  bool eye_within = false;     ///< the eye is in the mesh's bounds, and left there: it may see the solid from within
  bool has_caps = false;       ///< sections of the cuts can be seen
  glm::dvec3 eye{0.0};
  glm::dvec3 forward{0.0};          ///< unit; depth is measured along it
  std::optional<SliceFrame> slice;  ///< of size_px
  std::optional<RayFrame> rays;     ///< of size_px
};

/// `bounds` are those of the support mesh, or of what rays may meet (ignored for slices); `largest_px` is the longest
/// side that can be rendered. Errors (input): no pixel, a side times the samples beyond largest_px, samples not
/// in 1..16, more than DMVV_MAX_CUTS cuts, a plane without a normal, a camera without a direction, an angle not between
/// 0 and 180 degrees, anything not finite.
Result<FrameSetup> plan_frame_setup(const View& view, const voml::Bounds& bounds, std::uint32_t largest_px);

/// What the kernels over rays are told of a part of the picture, whose corner is given. Computed in double, rounded
/// once.
gpu::RayParams ray_params(const FrameSetup& setup, glm::uvec2 corner_px, glm::uvec2 size_px);

/// The size of the tiles in which a picture is rendered: whole pixels of samples^2 rendered ones each, some 220 MiB of
/// images and buffers at most.
glm::uvec2 largest_tile(glm::uvec2 rendered_px, std::uint32_t samples);

/// The surface texels (shaders/surface.glsl) of a slice's tile, without a normal: width * height of them, zeros where
/// the pixel lies outside the standard cube. Positions are computed in double and rounded once.
void fill_slice_surface(const SliceFrame& slice, glm::uvec2 corner_px, glm::uvec2 size_px, glm::uvec4* texels);

}  // namespace dmvv::runtime
