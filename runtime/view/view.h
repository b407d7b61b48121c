// What to look at: camera, support mesh, cuts, slices; and what comes back. Pure values and geometry, no device.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "voml/assets/mesh.h"

namespace dmvv::runtime {

/// Perspective camera, root coordinates. fov_deg is the vertical angle of view.
struct Camera {
  glm::dvec3 eye{0.0, 0.0, 5.0};
  glm::dvec3 look{0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};  ///< where it is along the view, +y is taken, or +z where that is too
  double fov_deg = 30.0;
};

/// The plane n.x = d.
struct Plane {
  glm::dvec3 normal;
  double d;
};

enum class Shading : std::uint8_t { none, lit };
enum class Colors : std::uint8_t { floats, bytes };

struct View {
  glm::uvec2 size_px{1280, 720};
  Camera camera;
  /// What each pixel's ray meets first is seen; the mesh is ignored. Needs the kernels `rays` and `normals`.
  bool rays = false;
  std::shared_ptr<const voml::Mesh> mesh;  ///< support mesh; null: the standard cube
  std::vector<Plane> cuts;                 ///< n.x > d is taken away, the section is capped; at most 64
  std::optional<Plane> slice;      ///< a section instead of a perspective picture; camera, mesh, cuts are ignored
  Shading shading = Shading::lit;  ///< slices are never lit
  double time_ms = 0.0;            ///< since the animation's start
  std::uint32_t samples = 1;       ///< per pixel along each axis, 1..16; the picture is the mean of samples^2
  Colors colors = Colors::floats;  ///< bytes: a quarter of the memory on the way, and what a PNG holds
  /// Colours from bitmaps are the same whichever frames came before. Off: while the camera moves they are found faster,
  /// and may differ by 1 in 255, by what happens to be proven.
  bool steady_colors = true;
  bool want_regions = false;
  bool want_depth = false;
  bool want_positions = false;
  bool want_normals = false;  ///< not of slices
  bool want_doubt = false;
  std::vector<std::string> disabled_passes;  ///< names of frame_pass_names(), frame_passes.h
};

/// What a picture of it is drawn on; not for slices. Never null.
std::shared_ptr<const voml::Mesh> support_mesh(const View& view);

/// "eye 3 2 4 look 0 0 0 fov 30", optional "up x y z"; words in any order, eye and look needed.
Result<Camera> parse_camera(std::string_view text);
/// "nx ny nz d", not all of n zero.
Result<Plane> parse_plane(std::string_view text);
/// "z=0" (x, y, z) or "nx ny nz d".
Result<Plane> parse_slice(std::string_view text);
/// "1280x720", 1..16384 each.
Result<glm::uvec2> parse_size(std::string_view text);

/// A camera from the front, right and above (toward (0.55, 0.45, 1) normalised) that frames `bounds` with a margin of 6
/// % at this aspect ratio; with cuts, from that of the directions (0.55, 0.45, 1), (1, 0.45, 0.55), (0.55, 1, 0.45),
/// with any signs, from which the most sections are seen, and those most squarely.
Camera default_camera(const voml::Bounds& bounds, glm::uvec2 size_px, std::span<const Plane> cuts);

/// The camera moved, but not turned, so that it frames balls of this radius around the points with the same margin.
/// Points that are not finite are left out; without any it stays.
Camera framing(const Camera& camera, glm::uvec2 size_px, std::span<const glm::vec3> points, double radius);

/// Where the middle of pixel (0, 0) of a slice lies in root coordinates, and the steps to the right and down.
/// The standard cube's whole width (2) fills the shorter side; up is +y, or +z if the plane's normal is along y.
struct SliceFrame {
  glm::dvec3 origin;
  glm::dvec3 step_x;
  glm::dvec3 step_y;
};
SliceFrame slice_frame(const Plane& plane, glm::uvec2 size_px);

}  // namespace dmvv::runtime
