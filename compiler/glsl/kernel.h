// A kernel asks the scene about points: where they come from and what is asked of each are data.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace dmvv::compiler {

/// Where a kernel's points come from.
enum class Source : std::uint8_t {
  points,   ///< a buffer of points (shaders/points.comp)
  surface,  ///< what each pixel of a picture sees first (shaders/pixels.comp)
  rays,     ///< the way of each pixel's ray, until it meets something (shaders/rays.comp)
  hits,     ///< where rays met something (shaders/normals.comp, shaders/media.comp)
};

/// What a kernel asks of a point beside its region and colour.
struct Query {
  bool path = false;      ///< region and candidate of each level
  bool radius = false;    ///< how far around the point the answer holds (shaders/reach.glsl)
  bool medium = false;    ///< how long steps of the root are in the frame of the object that answers
  bool gradient = false;  ///< of the source that decides the boundary nearest to the point (shaders/gradient.glsl)
};

/// A kernel is one compute shader, or several that run after each other (compiler/plan/stage_plan.h).
struct KernelSpec {
  std::string_view name;
  Source source;
  Query query;
};

inline constexpr KernelSpec points_kernel{"points", Source::points, {.path = true}};
inline constexpr KernelSpec pixels_kernel{"pixels", Source::surface, {}};
inline constexpr KernelSpec leaders_kernel{"leaders", Source::surface, {.radius = true}};
inline constexpr KernelSpec rays_kernel{"rays", Source::rays, {.radius = true}};
inline constexpr KernelSpec normals_kernel{"normals", Source::hits, {.gradient = true}};
inline constexpr KernelSpec media_kernel{"media", Source::hits, {.radius = true, .medium = true}};
/// Every kernel that can be made of a scene. A program has those that its options ask for.
inline constexpr std::array kernel_specs{points_kernel, pixels_kernel,  leaders_kernel,
                                         rays_kernel,   normals_kernel, media_kernel};

}  // namespace dmvv::compiler
