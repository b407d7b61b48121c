// View -> what the shaders are told.
#include "runtime/view/frame_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <utility>

namespace dmvv::runtime {
namespace {

constexpr std::uint32_t most_samples = 16;

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::optional<std::string> plane_fault(const Plane& plane) {
  if (!finite(plane.normal) || !std::isfinite(plane.d)) return "has a number that is not finite";
  const double length = glm::length(plane.normal);
  if (!(length > 0.0) || !std::isfinite(length)) return fmt::format("has a normal of length {}", length);
  return std::nullopt;
}

std::optional<std::string> camera_fault(const Camera& camera) {
  if (!finite(camera.eye) || !finite(camera.look) || !finite(camera.up)) return "has a number that is not finite";
  const double distance = glm::length(camera.look - camera.eye);
  if (!(distance > 0.0) || !std::isfinite(distance))
    return fmt::format("looks at a point {} away from its eye", distance);
  if (!(camera.fov_deg > 0.0 && camera.fov_deg < 180.0)) {
    return fmt::format("has an angle of view of {}, not between 0 and 180 degrees", camera.fov_deg);
  }
  return std::nullopt;
}

std::optional<std::string> view_fault(const View& view, std::uint32_t largest_px) {
  if (view.size_px.x < 1 || view.size_px.y < 1) {
    return fmt::format("a picture of {}x{} pixels has no pixel", view.size_px.x, view.size_px.y);
  }
  if (view.samples < 1 || view.samples > most_samples) {
    return fmt::format("{} samples a pixel and axis were asked for; 1 to {} can be had", view.samples, most_samples);
  }
  const std::uint64_t longest = std::max(view.size_px.x, view.size_px.y) * std::uint64_t{view.samples};
  if (longest > largest_px) {
    return fmt::format(
        "a picture of {}x{} pixels with {} samples each way is {} pixels long; this device draws at most {}",
        view.size_px.x, view.size_px.y, view.samples, longest, largest_px);
  }
  if (view.slice) {
    const auto fault = plane_fault(*view.slice);
    return fault ? std::optional("the slice " + *fault) : std::nullopt;
  }
  if (view.cuts.size() > DMVV_MAX_CUTS) {
    return fmt::format("{} cuts were asked for; at most {} can be drawn", view.cuts.size(), DMVV_MAX_CUTS);
  }
  for (std::size_t i = 0; i < view.cuts.size(); ++i) {
    if (const auto fault = plane_fault(view.cuts[i])) return fmt::format("cut {} {}", i + 1, *fault);
  }
  if (const auto fault = camera_fault(view.camera)) return "the camera " + *fault;
  return std::nullopt;
}

gpu::vec4 row(const glm::dvec3& v, double w = 0.0) { return {glm::vec3(v), static_cast<float>(w)}; }

struct Basis {
  glm::dvec3 forward, right, down;  ///< unit, at right angles
};

/// If up is along the view, +y is up instead, or +z where that is along the view as well.
Basis view_basis(const Camera& camera) {
  const glm::dvec3 forward = glm::normalize(camera.look - camera.eye);
  for (const glm::dvec3& up : {camera.up, glm::dvec3(0.0, 1.0, 0.0)}) {
    const glm::dvec3 right = glm::cross(forward, up);
    if (glm::length(right) > 1e-9 * glm::length(up)) {
      return {forward, glm::normalize(right), glm::cross(forward, glm::normalize(right))};
    }
  }
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0.0, 0.0, 1.0)));
  return {forward, right, glm::cross(forward, right)};
}

double distance_to_box(const glm::dvec3& p, const voml::Bounds& box) {
  return glm::length(glm::max(glm::max(box.lo - p, p - box.hi), glm::dvec3(0.0)));
}

/// Half the smallest depth that anything visible can have. Nothing that stays is nearer to the eye than the bounds, nor
/// nearer than a plane that takes the eye's side away.
double near_depth(const voml::Bounds& bounds, const glm::dvec3& eye, const gpu::RasterParams& raster,
                  double longest_ray) {
  double distance = distance_to_box(eye, bounds);
  for (gpu::uint i = 0; i < raster.cut_count; ++i)
    distance = std::max(distance, -static_cast<double>(raster.cuts[i].along.w));
  const double diagonal = glm::length(bounds.hi - bounds.lo);
  const double smallest = std::max(1e-7 * diagonal, 1e-18);
  return distance > 0.0 ? std::max(0.5 * distance / longest_ray, smallest) : std::max(1e-4 * diagonal, 1e-18);
}

void plan_perspective(const View& view, const voml::Bounds& bounds, FrameSetup& setup) {
  const Basis basis = view_basis(view.camera);
  const glm::dvec3& eye = view.camera.eye;
  const double tan_y = std::tan(view.camera.fov_deg * std::numbers::pi / 360.0);
  const double tan_x = tan_y * setup.size_px.x / setup.size_px.y;
  const glm::dvec3 corner = basis.forward - tan_x * basis.right - tan_y * basis.down;
  const glm::dvec3 step_x = basis.right * (2.0 * tan_x / setup.size_px.x);
  const glm::dvec3 step_y = basis.down * (2.0 * tan_y / setup.size_px.y);

  gpu::RasterParams& raster = setup.raster;
  raster.eye = row(eye);
  raster.forward = row(basis.forward);
  raster.down = row(basis.down / tan_y);
  raster.ray = row(corner);
  raster.ray_x = row(step_x);
  raster.ray_y = row(step_y);
  raster.picture = gpu::vec4(setup.size_px, 0.0f, 0.0f);
  raster.cut_count = static_cast<gpu::uint>(view.cuts.size());
  for (gpu::uint i = 0; i < raster.cut_count; ++i) {
    const double length = glm::length(view.cuts[i].normal);
    const glm::dvec3 normal = view.cuts[i].normal / length;
    const double d = view.cuts[i].d / length;
    const glm::dvec3 along(glm::dot(normal, step_x), glm::dot(normal, step_y), glm::dot(normal, corner));
    raster.cuts[i] = {row(normal, d), row(along, d - glm::dot(normal, eye))};
    if (raster.cuts[i].along.w < 0.0f) std::swap(raster.cuts[i], raster.cuts[raster.front_count++]);
  }
  raster.right = row(basis.right / tan_x, near_depth(bounds, eye, raster, glm::length(corner)));

  if (view.rays) {
    double depth = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 p(i & 1 ? bounds.hi.x : bounds.lo.x, i & 2 ? bounds.hi.y : bounds.lo.y,
                         i & 4 ? bounds.hi.z : bounds.lo.z);
      depth = std::min(depth, glm::dot(basis.forward, p - eye));
    }
    const glm::dvec3 middle = corner + 0.5 * (step_x + step_y);  // of pixel (0, 0)
    setup.rays = RayFrame{eye, middle, step_x, step_y, bounds, std::max(depth, 0.0)};
  }
  setup.eye = eye;
  setup.forward = basis.forward;
  // From where the solid is left whole, sections are seen from within it only.
  setup.eye_within = raster.front_count == 0 && distance_to_box(eye, bounds) == 0.0;
  setup.has_caps = raster.cut_count > 0 && (raster.front_count != 0 || setup.eye_within);
  const glm::dvec3 light = -basis.forward + 0.25 * basis.right - 0.4 * basis.down;
  setup.pixels.light = row(glm::normalize(light), view.shading == Shading::lit ? 1.0 : 0.0);
  setup.pixels.bounds_lo = row(bounds.lo);
  setup.pixels.bounds_hi = row(bounds.hi);
}

/// Around the projections of the corners of a box. `project` gives pixels, or nothing for a corner beside or behind the
/// eye.
template <class Project>
PixelRange range_of(const voml::Bounds& box, glm::uvec2 size_px, std::uint32_t samples, Project project) {
  constexpr double margin_px = 2.0;
  const glm::dvec2 size(size_px);
  glm::dvec2 lo = size, hi(0.0);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                       corner & 4 ? box.hi.z : box.lo.z);
    const std::optional<glm::dvec2> at = project(p);
    if (!at) return {glm::uvec2(0), size_px};
    lo = glm::min(lo, *at - margin_px);
    hi = glm::max(hi, *at + margin_px);
  }
  const glm::dvec2 n(samples);
  return {glm::uvec2(glm::clamp(glm::floor(lo / n) * n, glm::dvec2(0.0), size)),
          glm::uvec2(glm::clamp(glm::ceil(hi / n) * n, glm::dvec2(0.0), size))};
}

PixelRange seen_in_perspective(const FrameSetup& setup, const voml::Bounds& bounds, std::uint32_t samples) {
  const double nearest = 1e-3 * glm::length(bounds.hi - bounds.lo);
  return range_of(bounds, setup.size_px, samples, [&](const glm::dvec3& p) -> std::optional<glm::dvec2> {
    const double depth = glm::dot(setup.forward, p - setup.eye);
    if (!(depth > nearest)) return std::nullopt;
    const glm::dvec2 across(glm::dot(glm::dvec3(setup.raster.right), p - setup.eye),
                            glm::dot(glm::dvec3(setup.raster.down), p - setup.eye));
    return (across / depth * 0.5 + 0.5) * glm::dvec2(setup.size_px);
  });
}

/// A section of the standard cube lies in its projection onto the plane.
PixelRange seen_in_slice(const FrameSetup& setup, std::uint32_t samples) {
  const SliceFrame& slice = *setup.slice;
  return range_of({glm::dvec3(-1.0), glm::dvec3(1.0)}, setup.size_px, samples,
                  [&](const glm::dvec3& p) -> std::optional<glm::dvec2> {
                    const glm::dvec3 from = p - slice.origin;
                    return glm::dvec2(glm::dot(from, slice.step_x), glm::dot(from, slice.step_y)) /
                           glm::dot(slice.step_x, slice.step_x);
                  });
}

}  // namespace

Result<FrameSetup> plan_frame_setup(const View& view, const voml::Bounds& bounds, std::uint32_t largest_px) {
  if (auto fault = view_fault(view, largest_px)) return fail(Fault::input, std::move(*fault));
  FrameSetup setup;
  setup.size_px = view.size_px * view.samples;
  setup.pixels.paints_bitmaps = view.steady_colors ? 0 : 1;
  if (view.slice) {
    setup.slice = slice_frame(*view.slice, setup.size_px);
    setup.pixels.bounds_lo = row(glm::dvec3(-1.0));
    setup.pixels.bounds_hi = row(glm::dvec3(1.0));
    setup.seen = seen_in_slice(setup, view.samples);
  } else {
    plan_perspective(view, bounds, setup);
    setup.seen = seen_in_perspective(setup, bounds, view.samples);
  }
  return setup;
}

gpu::RayParams ray_params(const FrameSetup& setup, glm::uvec2 corner_px, glm::uvec2 size_px) {
  const RayFrame& frame = *setup.rays;
  const glm::dvec3 corner = frame.corner + frame.step_x * double(corner_px.x) + frame.step_y * double(corner_px.y);
  gpu::RayParams params{};
  params.start = row(frame.eye + frame.depth * corner);
  params.start_x = row(frame.depth * frame.step_x);
  params.start_y = row(frame.depth * frame.step_y);
  params.along = row(corner);
  params.along_x = row(frame.step_x);
  params.along_y = row(frame.step_y);
  params.lo = row(frame.bounds.lo);
  params.hi = row(frame.bounds.hi);
  params.depth = static_cast<float>(frame.depth);
  params.pixel = static_cast<float>(glm::length(frame.step_x));
  params.tiles_x = (size_px.x + DMVV_RAY_TILE - 1) / DMVV_RAY_TILE;
  params.cut_count = setup.raster.cut_count;
  for (gpu::uint i = 0; i < params.cut_count; ++i) params.cuts[i] = setup.raster.cuts[i].plane;
  return params;
}

glm::uvec2 largest_tile(glm::uvec2 rendered_px, std::uint32_t samples) {
  constexpr std::uint32_t widest_px = 2048, budget_px = 1u << 21;
  const auto whole = [&](std::uint32_t px) { return std::max(samples, px / samples * samples); };
  const std::uint32_t width = std::min(rendered_px.x, whole(widest_px));
  return {width, std::min(rendered_px.y, whole(budget_px / width))};
}

void fill_slice_surface(const SliceFrame& slice, glm::uvec2 corner_px, glm::uvec2 size_px, glm::uvec4* texels) {
  constexpr double closed_cube = 1.0 + 1e-12;  // a plane given as "1 1 0 2" must not lose the edge to rounding
  for (std::uint32_t y = 0; y < size_px.y; ++y) {
    for (std::uint32_t x = 0; x < size_px.x; ++x) {
      const glm::dvec3 p =
          slice.origin + slice.step_x * double(corner_px.x + x) + slice.step_y * double(corner_px.y + y);
      const bool inside = std::abs(p.x) <= closed_cube && std::abs(p.y) <= closed_cube && std::abs(p.z) <= closed_cube;
      *texels++ = inside ? glm::uvec4(glm::floatBitsToUint(glm::vec3(p)), DMVV_SURFACE_BIT) : glm::uvec4(0u);
    }
  }
}

}  // namespace dmvv::runtime
