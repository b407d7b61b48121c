#include "examples/assets.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "base/files.h"
#include "voml/assets/grid.h"

namespace assets {
namespace {

/// Angles in degrees such that Rz * Ry * Rx = r.
dvec3 euler_deg(const glm::dmat3& r) {
  return glm::degrees(
      dvec3(std::atan2(r[1][2], r[2][2]), -std::asin(glm::clamp(r[0][2], -1.0, 1.0)), std::atan2(r[0][1], r[0][0])));
}

template <class T>
void append_raw(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little, "binary PLY is written little-endian");
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

}  // namespace

void Output::write(const std::string& name, const std::string& bytes) {
  const auto result = dmvv::write_file(path(name), bytes);
  if (!result) fail(result.error().message);
}

void write_grid(Output& output, const std::string& name, glm::uvec3 size, dvec3 extent,
                const std::function<double(dvec3)>& shape) {
  dmvv::voml::Grid grid;
  grid.size = size;
  grid.values.reserve(std::size_t{size.x} * size.y * size.z);
  for (std::uint32_t z = 0; z < size.z; ++z)
    for (std::uint32_t y = 0; y < size.y; ++y)
      for (std::uint32_t x = 0; x < size.x; ++x) {
        const dvec3 cube = (dvec3(x, y, z) + 0.5) / dvec3(size) * 2.0 - 1.0;
        grid.values.push_back(static_cast<float>(shape(cube * extent)));
      }
  output.write("sdf/" + name, dmvv::voml::write_lxn(grid));
}

void write_bitmap(Output& output, const std::string& name, int n, const std::function<dvec3(dvec3)>& color) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(3u * static_cast<std::size_t>(n) * n * n);
  for (int row = n * n - 1; row >= 0; --row)  // rows of the file start at the top, rows of the format at the bottom
    for (int x = 0; x < n; ++x) {
      const dvec3 rgb = color((dvec3(x, row % n, row / n) + 0.5) / double(n));
      for (int c = 0; c < 3; ++c)
        pixels.push_back(static_cast<std::uint8_t>(glm::clamp(rgb[c], 0.0, 1.0) * 255.0 + 0.5));
    }
  const std::string path = output.path("bmp/" + name);
  const auto file = OIIO::ImageOutput::create(path);
  if (!file || !file->open(path, OIIO::ImageSpec(n, n * n, 3, OIIO::TypeDesc::UINT8)) ||
      !file->write_image(OIIO::TypeDesc::UINT8, pixels.data()) || !file->close())
    output.fail("cannot write " + path);
}

void write_seeds(Output& output, const std::string& name, const std::string& what,
                 const std::vector<Placement>& placements) {
  std::string positions = fmt::format("# {}: positions, fractions of the edge of the cube\n", what);
  std::string angles = fmt::format("# {}: rotations about x, y, z in degrees\n", what);
  std::string scales = fmt::format("# {}: scales along x, y, z\n", what);
  for (const Placement& placement : placements) {
    const dvec3 p = placement.position / 2.0, a = euler_deg(placement.rotation), s = placement.scale;
    positions += fmt::format("{:.5f} {:.5f} {:.5f}\n", p.x, p.y, p.z);
    angles += fmt::format("{:.2f} {:.2f} {:.2f}\n", a.x, a.y, a.z);
    scales += fmt::format("{:.5f} {:.5f} {:.5f}\n", s.x, s.y, s.z);
  }
  output.write("seeds/" + name + ".txt", positions);
  output.write("seeds/" + name + "_rotate.txt", angles);
  output.write("seeds/" + name + "_scale.txt", scales);
}

int run_maker(int argc, char** argv, const std::string& name, const std::function<void(Output&)>& make) {
  if (argc != 2) {
    fmt::print(stderr, "usage: {} FOLDER\n", name);
    return 2;
  }
  std::error_code error;
  for (const char* folder : {"sdf", "bmp", "seeds"}) {
    std::filesystem::create_directories(std::filesystem::path(argv[1]) / folder, error);
    if (error) {
      fmt::print(stderr, "{}: cannot make folder {}/{}: {}\n", name, argv[1], folder, error.message());
      return 2;
    }
  }
  Output output(argv[1]);
  make(output);
  if (output.error().empty()) return 0;
  fmt::print(stderr, "{}: {}\n", name, output.error());
  return 2;
}

std::string to_ply(const Mesh& mesh, const std::string& comment) {
  std::string ply = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\nproperty float x\n"
      "property float y\nproperty float z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      comment, mesh.points.size(), mesh.triangles.size());
  for (const dvec3 p : mesh.points)
    for (int c = 0; c < 3; ++c) append_raw(ply, static_cast<float>(p[c]));
  for (const glm::uvec3 triangle : mesh.triangles) {
    append_raw(ply, std::uint8_t{3});
    for (int c = 0; c < 3; ++c) append_raw(ply, triangle[c]);
  }
  return ply;
}

glm::dmat3 frame_along(dvec3 d, dvec3 z_hint) {
  const dvec3 x = glm::normalize(glm::cross(d, z_hint));
  return {x, d, glm::cross(x, d)};
}

}  // namespace assets
