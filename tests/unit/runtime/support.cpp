#include "support.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numbers>

#include "compiler/layout/scene_buffers.h"
#include "kernels/probe_pixels.h"
#include "kernels/probe_points.h"
#include "shaders/records.h"

namespace dmvv::tests {

std::string text_of(const Error& error) {
  std::string text = error.message;
  for (const std::string& reason : error.reasons) text += "; " + reason;
  return text;
}

runtime::Device& device() {
  static runtime::Device opened = must(runtime::Device::create({.name = "", .validation = true}));
  return opened;
}

namespace {

template <class T>
compiler::Buffer buffer_of(const T& value) {
  compiler::Buffer buffer{"scene", compiler::scene_binding::nodes, std::vector<std::byte>(sizeof value)};
  std::memcpy(buffer.bytes.data(), &value, sizeof value);
  return buffer;
}

}  // namespace

compiler::Kernel kernel_of(const compiler::KernelSpec& spec, std::span<const std::uint32_t> spirv) {
  return {spec, {{"", {spirv.begin(), spirv.end()}}}};
}

compiler::Program program(Show show) {
  compiler::Program made;
  made.buffers.push_back(buffer_of(glm::uvec4(static_cast<std::uint32_t>(show), 0, 0, 0)));
  // x - 0.25 at the middles of 4^3 cells: linear filtering gives it back exactly between them.
  compiler::Texture texture{"distance", DMVV_BIND_GRID_ATLAS, glm::uvec3(4), compiler::TexelFormat::r32f, true, {}};
  texture.texels.resize(4 * 64);
  for (int i = 0; i < 64; ++i) {
    const float value = static_cast<float>(-1.0 + (i % 4 + 0.5) / 2.0 - 0.25);
    std::memcpy(texture.texels.data() + 4 * i, &value, sizeof value);
  }
  made.textures.push_back(std::move(texture));
  made.kernels.push_back(kernel_of(compiler::pixels_kernel, probe_pixels));
  return made;
}

compiler::Program points_program(float radius) {
  compiler::Program made;
  made.depth = 2;
  made.buffers.push_back(buffer_of(glm::vec4(radius, 0, 0, 0)));
  made.kernels.push_back(kernel_of(compiler::points_kernel, probe_points));
  return made;
}

std::shared_ptr<const voml::Mesh> shared(const voml::Mesh& mesh) { return std::make_shared<const voml::Mesh>(mesh); }

voml::Mesh sphere(double radius, const glm::dvec3& centre, int rings) {
  voml::Mesh mesh;
  const int columns = 2 * rings;
  const auto columns_u = static_cast<std::uint32_t>(columns), rings_u = static_cast<std::uint32_t>(rings);
  mesh.positions.push_back(centre + glm::dvec3(0, radius, 0));
  for (int r = 1; r < rings; ++r) {
    for (int c = 0; c < columns; ++c) {
      const double polar = std::numbers::pi * r / rings, azimuth = 2.0 * std::numbers::pi * c / columns;
      mesh.positions.push_back(centre + radius * glm::dvec3(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                                            -std::sin(polar) * std::sin(azimuth)));
    }
  }
  mesh.positions.push_back(centre - glm::dvec3(0, radius, 0));
  const std::uint32_t south = static_cast<std::uint32_t>(mesh.positions.size()) - 1;
  const auto at = [&](std::uint32_t r, std::uint32_t c) { return 1 + (r - 1) * columns_u + c % columns_u; };
  for (std::uint32_t c = 0; c < columns_u; ++c) {
    mesh.triangles.push_back({0, at(1, c), at(1, c + 1)});
    for (std::uint32_t r = 1; r + 1 < rings_u; ++r) {
      mesh.triangles.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1)});
      mesh.triangles.push_back({at(r, c), at(r + 1, c + 1), at(r, c + 1)});
    }
    mesh.triangles.push_back({south, at(rings_u - 1, c + 1), at(rings_u - 1, c)});
  }
  return mesh;
}

voml::Mesh torus(double major, double minor, int segments) {
  voml::Mesh mesh;
  const int around = segments / 2;
  for (int i = 0; i < segments; ++i) {
    for (int j = 0; j < around; ++j) {
      const double u = 2.0 * std::numbers::pi * i / segments, v = 2.0 * std::numbers::pi * j / around;
      const double reach = major + minor * std::cos(v);
      mesh.positions.push_back({reach * std::cos(u), reach * std::sin(u), minor * std::sin(v)});
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i % segments * around + j % around); };
  for (int i = 0; i < segments; ++i) {
    for (int j = 0; j < around; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

voml::Mesh join(voml::Mesh a, const voml::Mesh& b, bool inverted) {
  const auto shift = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (glm::uvec3 t : b.triangles) {
    if (inverted) std::swap(t.y, t.z);
    a.triangles.push_back(t + shift);
  }
  return a;
}

namespace {

struct Crossing {
  double depth;
  int turn;  ///< +1: the ray leaves the solid, -1: it enters
};

/// Moeller and Trumbore 1997.
std::optional<Crossing> cross_triangle(const glm::dvec3& eye, const glm::dvec3& direction, const glm::dvec3& a,
                                       const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, p = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, p);
  if (determinant == 0.0) return std::nullopt;
  const glm::dvec3 to_eye = eye - a, q = glm::cross(to_eye, ab);
  const double u = glm::dot(to_eye, p) / determinant, v = glm::dot(direction, q) / determinant;
  const double depth = glm::dot(ac, q) / determinant;
  if (u < 0.0 || v < 0.0 || u + v > 1.0 || depth <= 0.0) return std::nullopt;
  return Crossing{depth, determinant < 0.0 ? 1 : -1};
}

}  // namespace

std::optional<Hit> cast(const runtime::View& view, const voml::Mesh& mesh, double x_px, double y_px) {
  const runtime::Camera& camera = view.camera;
  const glm::dvec3 forward = glm::normalize(camera.look - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const glm::dvec3 up = glm::cross(right, forward);
  const double tangent = std::tan(camera.fov_deg / 2.0 * std::numbers::pi / 180.0);
  const double x = (2.0 * x_px / view.size_px.x - 1.0) * view.size_px.x / view.size_px.y,
               y = 1.0 - 2.0 * y_px / view.size_px.y;
  const glm::dvec3 direction = forward + tangent * (x * right + y * up);

  // ---- the kept part of the ray ----
  double enter = 0.0, leave = 1e300;
  std::optional<std::size_t> enter_cut, leave_cut;
  for (std::size_t i = 0; i < view.cuts.size(); ++i) {
    const double gap = view.cuts[i].d - glm::dot(view.cuts[i].normal, camera.eye);
    const double slope = glm::dot(view.cuts[i].normal, direction);
    if (gap < 0.0 && slope >= 0.0) return std::nullopt;
    if (gap < 0.0 && gap / slope > enter) enter = gap / slope, enter_cut = i;
    if (gap >= 0.0 && slope > 0.0 && gap / slope < leave) leave = gap / slope, leave_cut = i;
  }

  // ---- what the ray meets there ----
  std::vector<Crossing> crossings;
  for (const glm::uvec3& t : mesh.triangles) {
    const auto crossing =
        cross_triangle(camera.eye, direction, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
    if (crossing) crossings.push_back(*crossing);
  }
  const auto shells_around = [&](double depth) {
    int shells = 0;
    for (const Crossing& crossing : crossings) shells += crossing.depth > depth ? crossing.turn : 0;
    return shells;
  };
  if (enter > leave) return std::nullopt;
  if (enter_cut && shells_around(enter) != 0) return Hit{enter, enter_cut};
  std::optional<Hit> nearest;
  for (const Crossing& crossing : crossings) {
    if (crossing.depth < enter || crossing.depth > leave) continue;
    if (!nearest || crossing.depth < nearest->depth) nearest = Hit{crossing.depth, std::nullopt};
  }
  if (!nearest && leave_cut && shells_around(leave) != 0) return Hit{leave, leave_cut};  // seen from within the solid
  return nearest;
}

const std::filesystem::path& scratch() {
  static const std::filesystem::path folder = [] {
    const std::filesystem::path path = std::filesystem::path(DMVV_BINARY_DIR) / "tests" / "runtime";
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
    return path;
  }();
  return folder;
}

}  // namespace dmvv::tests
