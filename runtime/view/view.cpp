// Parses cameras, planes and sizes; places the default camera and the pixels of slices.
#include "runtime/view/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

namespace dmvv::runtime {
namespace {

/// Words between blanks and commas.
std::vector<std::string_view> split_words(std::string_view text) {
  constexpr std::string_view separators = " \t\r\n,";
  std::vector<std::string_view> words;
  for (std::size_t begin = text.find_first_not_of(separators); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(separators, end);
  }
  return words;
}

std::optional<double> parse_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

tl::unexpected<Error> wrong(std::string_view what, std::string_view text, const std::string& problem,
                            std::string_view form) {
  return fail(Fault::input, fmt::format("{} '{}': {}", what, text, problem), {fmt::format("expected {}", form)});
}

constexpr std::string_view camera_form = "\"eye X Y Z look X Y Z [up X Y Z] [fov DEGREES]\"";
constexpr std::string_view plane_form = "\"NX NY NZ D\", the plane NX*x + NY*y + NZ*z = D";
constexpr std::string_view slice_form = "\"x=D\", \"y=D\", \"z=D\" or \"NX NY NZ D\"";
constexpr std::string_view size_form = "\"WIDTHxHEIGHT\" in pixels, 1 to 16384 each, such as 1280x720";

Result<Plane> parse_four_numbers(std::string_view what, std::string_view text, std::string_view form) {
  const auto words = split_words(text);
  if (words.size() != 4) return wrong(what, text, fmt::format("4 numbers are needed, found {}", words.size()), form);
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto value = parse_number(words[i]);
    if (!value) return wrong(what, text, fmt::format("'{}' is not a finite number", words[i]), form);
    values[i] = *value;
  }
  const Plane plane{{values[0], values[1], values[2]}, values[3]};
  if (plane.normal == glm::dvec3(0.0)) return wrong(what, text, "the normal is zero", form);
  return plane;
}

/// A direction from the origin to where a default camera stands: z towards the viewer, all 8 octants and 3 main axes.
struct Corner {
  glm::dvec3 direction{0.0};
  int facing = 0;         ///< cuts whose section is seen from there
  double squareness = 0;  ///< sum of the cosines at which the cuts are seen
};

glm::dvec3 default_direction(std::span<const Plane> cuts) {
  const std::array<glm::dvec3, 3> mains{glm::dvec3{0.55, 0.45, 1.0}, {1.0, 0.45, 0.55}, {0.55, 1.0, 0.45}};
  Corner best;
  for (const glm::dvec3& main : mains) {
    for (int octant = 0; octant < 8; ++octant) {
      const glm::dvec3 sign((octant & 1) != 0 ? -1 : 1, (octant & 2) != 0 ? -1 : 1, (octant & 4) != 0 ? -1 : 1);
      Corner corner{glm::normalize(main * sign)};
      for (const Plane& cut : cuts) {
        const double cosine = glm::dot(glm::normalize(cut.normal), corner.direction);
        corner.facing += cosine > 0.0 ? 1 : 0;
        corner.squareness += cosine;
      }
      const bool better =
          corner.facing > best.facing || (corner.facing == best.facing && corner.squareness > best.squareness + 1e-9);
      if (best.direction == glm::dvec3(0.0) || better) best = corner;
    }
  }
  return best.direction;
}

}  // namespace

Result<Camera> parse_camera(std::string_view text) {
  const auto bad = [&](const std::string& problem) { return wrong("camera", text, problem, camera_form); };
  const auto words = split_words(text);
  constexpr std::array<std::string_view, 4> keys{"eye", "look", "up", "fov"};
  std::array<bool, 4> seen{};
  Camera camera;
  std::array<double*, 4> targets{&camera.eye.x, &camera.look.x, &camera.up.x, &camera.fov_deg};
  for (std::size_t i = 0; i < words.size();) {
    const std::string_view word = words[i++];
    const auto key = static_cast<std::size_t>(std::ranges::find(keys, word) - keys.begin());
    if (key == keys.size()) return bad(fmt::format("'{}' is none of eye, look, up, fov", word));
    if (std::exchange(seen[key], true)) return bad(fmt::format("'{}' is given twice", word));
    const std::size_t count = word == "fov" ? 1 : 3;
    glm::dvec3 values(0.0);
    for (std::size_t k = 0; k < count; ++k, ++i) {
      const auto value = i < words.size() ? parse_number(words[i]) : std::nullopt;
      if (!value) {
        return bad(fmt::format("'{}' needs {} finite number{}, found {}", word, count, count > 1 ? "s" : "",
                               i < words.size() ? fmt::format("'{}'", words[i]) : "the end"));
      }
      values[static_cast<int>(k)] = *value;
    }
    std::copy_n(&values.x, count, targets[key]);
  }
  if (!seen[0]) return bad("'eye' is missing");
  if (!seen[1]) return bad("'look' is missing");
  if (camera.eye == camera.look) return bad("eye and look are the same point");
  if (camera.up == glm::dvec3(0.0)) return bad("up is zero");
  if (!(camera.fov_deg > 0.0 && camera.fov_deg < 180.0)) {
    return bad(fmt::format("fov is {}, not between 0 and 180 degrees", camera.fov_deg));
  }
  return camera;
}

Result<Plane> parse_plane(std::string_view text) { return parse_four_numbers("plane", text, plane_form); }

Result<Plane> parse_slice(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return parse_four_numbers("slice", text, slice_form);
  const auto axis = split_words(text.substr(0, equals));
  const auto number = split_words(text.substr(equals + 1));
  if (axis.size() != 1 || (axis[0] != "x" && axis[0] != "y" && axis[0] != "z")) {
    return wrong("slice", text, "the name before '=' is none of x, y, z", slice_form);
  }
  const auto value = number.size() == 1 ? parse_number(number[0]) : std::nullopt;
  if (!value) return wrong("slice", text, "after '=' one finite number is needed", slice_form);
  Plane plane{glm::dvec3(0.0), *value};
  plane.normal[axis[0][0] - 'x'] = 1.0;
  return plane;
}

Result<glm::uvec2> parse_size(std::string_view text) {
  const auto bad = [&](const std::string& problem) { return wrong("size", text, problem, size_form); };
  const std::size_t cross = text.find('x');
  if (cross == std::string_view::npos) return bad("there is no 'x'");
  glm::uvec2 size{0};
  for (int i = 0; i < 2; ++i) {
    const std::string_view word = i == 0 ? text.substr(0, cross) : text.substr(cross + 1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), size[i]);
    const bool whole = end == word.data() + word.size() && !word.empty();
    if (!whole || error == std::errc::invalid_argument) return bad(fmt::format("'{}' is not a whole number", word));
    if (error != std::errc{} || size[i] < 1 || size[i] > 16384) return bad(fmt::format("{} is out of range", word));
  }
  return size;
}

namespace {

constexpr double frame_margin = 0.06;

/// Half the picture's width and height at depth 1, less the margin.
glm::dvec2 framed_slope(const Camera& camera, glm::uvec2 size_px) {
  const double tangent = std::tan(camera.fov_deg * std::numbers::pi / 360.0) * (1.0 - frame_margin);
  return {tangent * size_px.x / size_px.y, tangent};
}

}  // namespace

Camera default_camera(const voml::Bounds& bounds, glm::uvec2 size_px, std::span<const Plane> cuts) {
  Camera camera;
  const glm::dvec3 towards_eye = default_direction(cuts);
  const glm::dvec3 forward = -towards_eye;
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const glm::dvec3 up = glm::cross(right, forward);

  // A thing without extent is framed as if it were of size 1.
  const glm::dvec3 centre = 0.5 * (bounds.lo + bounds.hi);
  glm::dvec3 half = 0.5 * (bounds.hi - bounds.lo);
  if (glm::length(half) <= 1e-9 * (1.0 + glm::length(centre))) half = glm::dvec3(0.5);

  // The centre stands in the middle of the picture; each corner asks for a distance at which it lies in the pyramid of
  // view, |x| <= slope * (depth + distance).
  const glm::dvec2 slope = framed_slope(camera, size_px);
  double distance = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p = half * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const double depth = glm::dot(p, forward);
    distance = std::max(distance, std::abs(glm::dot(p, right)) / slope.x - depth);
    distance = std::max(distance, std::abs(glm::dot(p, up)) / slope.y - depth);
  }
  camera.look = centre;
  camera.eye = centre - distance * forward;
  return camera;
}

Camera framing(const Camera& camera, glm::uvec2 size_px, std::span<const glm::vec3> points, double radius) {
  const glm::dvec3 forward = glm::normalize(camera.look - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const glm::dvec3 up = glm::cross(right, forward);
  const glm::dvec2 slope = framed_slope(camera, size_px);
  // Of an eye at (x, y), at depth z: p lies right of its left border if p.x - x >= -slope.x * (p.z - z), that is if
  // p.x + slope.x * p.z >= x + slope.x * z; and so on. `lo` and `hi` are the tightest of these.
  constexpr double infinity = std::numeric_limits<double>::infinity();
  glm::dvec2 lo(infinity), hi(-infinity);
  for (const glm::vec3& point : points) {
    if (!std::isfinite(point.x + point.y + point.z)) continue;
    const glm::dvec3 p(point);
    const glm::dvec2 across(glm::dot(p, right), glm::dot(p, up));
    const double depth = glm::dot(p, forward);
    lo = glm::min(lo, across + slope * depth);
    hi = glm::max(hi, across - slope * depth);
  }
  if (!(lo.x < infinity)) return camera;
  const glm::dvec2 beside = radius * glm::sqrt(1.0 + slope * slope);  // balls touch the borders
  lo -= beside;
  hi += beside;
  const glm::dvec2 across = 0.5 * (lo + hi);
  const glm::dvec2 depths = 0.5 * (lo - hi) / slope;  // at which points touch both borders
  const double depth = std::min(depths.x, depths.y);
  Camera framed = camera;
  framed.eye = across.x * right + across.y * up + depth * forward;
  framed.look = framed.eye + glm::length(camera.look - camera.eye) * forward;
  return framed;
}

SliceFrame slice_frame(const Plane& plane, glm::uvec2 size_px) {
  const double length = glm::length(plane.normal);
  const glm::dvec3 normal = plane.normal / length;
  const auto in_plane = [&](const glm::dvec3& v) { return v - normal * glm::dot(normal, v); };
  glm::dvec3 up = in_plane({0.0, 1.0, 0.0});
  if (glm::length(up) < 1e-9) up = in_plane({0.0, 0.0, 1.0});
  up = glm::normalize(up);
  const glm::dvec3 right = glm::cross(up, normal);
  const double pixel = 2.0 / std::min(size_px.x, size_px.y);
  SliceFrame frame;
  frame.step_x = right * pixel;
  frame.step_y = -up * pixel;
  frame.origin =
      normal * (plane.d / length) + frame.step_x * (0.5 - 0.5 * size_px.x) + frame.step_y * (0.5 - 0.5 * size_px.y);
  return frame;
}

std::shared_ptr<const voml::Mesh> support_mesh(const View& view) {
  static const auto cube = std::make_shared<const voml::Mesh>(voml::standard_cube());
  return view.mesh != nullptr ? view.mesh : cube;
}

}  // namespace dmvv::runtime
