// Makes the assets of the orange: distance grids, bitmaps, seed files, support mesh.
//
//   make_orange FOLDER      writes sdf/*.lxn  bmp/*.png  seeds/*.txt  orange.ply  into FOLDER
//
// shapes.h says what things look like, parts.h where they are, support_mesh.h what is drawn; this file writes it all.
//
// All shapes are modelled in units of ORANGE, also those of embedded objects; a grid stores them in the standard cube
// of its object. So the values of a grid are distances in orange units, whatever the object's scale, and `offset` in
// orange.voml means a thickness in orange units.
//
// Deterministic: integer random numbers, no threads, nothing depends on time or place.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/common.hpp>
#include <glm/trigonometric.hpp>
#include <string>
#include <vector>

#include "noise.h"
#include "parts.h"
#include "shapes.h"
#include "support_mesh.h"
#include "voml/files.h"
#include "voml/grid.h"

namespace {

using namespace orange;

// ---- files ----------------------------------------------------------------------------------------------------------

/// Writes below the output folder; remembers the first failure.
class Output {
 public:
  explicit Output(std::string folder) : folder_(std::move(folder)) {}

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  void write(const std::string& name, const std::string& bytes) {
    const auto result = dmvv::write_file(path(name), bytes);
    if (!result) fail(result.error().message);
  }
  void fail(const std::string& message) {
    if (error_.empty()) error_ = message;
  }
  const std::string& error() const { return error_; }

 private:
  std::string folder_;
  std::string error_;
};

/// Samples `shape` over the cube of half edges `extent`.
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

/// Writes a 3D bitmap of n^3 texels as a picture of n x n^2 pixels; `color` gets the texel's middle in [0, 1)^3.
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

/// Angles in degrees such that Rz * Ry * Rx = r.
dvec3 euler_deg(const glm::dmat3& r) {
  return glm::degrees(
      dvec3(std::atan2(r[1][2], r[2][2]), -std::asin(glm::clamp(r[0][2], -1.0, 1.0)), std::atan2(r[0][1], r[0][0])));
}

/// Writes NAME.txt, NAME_rotate.txt and NAME_scale.txt. Positions in the files are fractions of the cube's edge.
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

// ---- bitmaps --------------------------------------------------------------------------------------------------------

dvec3 flavedo_color(dvec3 u) {
  const double blotches = fractal_noise(u * 4.0, 41, 4, 4);
  const double grain = noise(u * 32.0, 45, 32);
  const dvec3 rgb =
      glm::mix(dvec3(0.915, 0.430, 0.035), dvec3(0.970, 0.560, 0.090), glm::clamp(0.5 + 0.6 * blotches, 0.0, 1.0));
  return rgb + 0.020 * grain;
}

dvec3 albedo_color(dvec3 u) {
  const double clouds = fractal_noise(u * 4.0, 51, 3, 4);
  const double fibres = 1.0 - std::abs(noise(u * 16.0, 55, 16));
  return glm::mix(dvec3(0.985, 0.955, 0.860), dvec3(0.950, 0.885, 0.730),
                  glm::clamp(0.4 + 0.5 * clouds + 0.35 * (fibres - 0.6), 0.0, 1.0));
}

dvec3 pulp_color(dvec3 u) {
  const double clouds = fractal_noise(u * 4.0, 61, 3, 4);
  return glm::mix(dvec3(0.985, 0.690, 0.270), dvec3(0.960, 0.590, 0.150), glm::clamp(0.5 + 0.7 * clouds, 0.0, 1.0));
}

/// Covers the cube of a vesicle once: darker along the axis, veined lengthwise, paler to the thin end.
dvec3 juice_color(dvec3 u) {
  const dvec3 p = u * 2.0 - 1.0;
  const double depth = 1.0 - std::sqrt(std::min(1.0, p.x * p.x + p.z * p.z));
  const double veins = fractal_noise(dvec3(u.x * 6.0, u.y * 3.0, u.z * 6.0) * 1.0, 71, 2, 3);
  const double tone = glm::clamp(0.15 + 0.75 * depth + 0.30 * veins, 0.0, 1.0);
  return glm::mix(dvec3(1.000, 0.735, 0.260), dvec3(0.950, 0.510, 0.050), tone);
}

void make_orange(Output& output) {
  write_grid(output, "peel.lxn", {96, 96, 96}, dvec3(1.0), skin_distance);
  write_grid(output, "section.lxn", {64, 96, 64}, section_extent, section_distance);
  write_grid(output, "vesicle.lxn", {32, 80, 32}, vesicle_extent, vesicle_distance);
  write_grid(output, "pip.lxn", {24, 40, 24}, pip_extent, pip_distance);
  write_grid(output, "core.lxn", {40, 64, 40}, core_extent, core_distance);
  write_grid(output, "hollow.lxn", {32, 48, 32}, hollow_extent, hollow_distance);
  write_grid(output, "gland.lxn", {20, 20, 20}, gland_extent, gland_distance);
  write_grid(output, "dimple.lxn", {20, 20, 20}, gland_extent, dimple_distance);
  write_grid(output, "calyx.lxn", {48, 24, 48}, calyx_extent, calyx_distance);
  write_grid(output, "ball.lxn", {16, 16, 16}, dvec3(1.0), [](dvec3 p) { return glm::length(p) - 0.85; });

  write_bitmap(output, "flavedo.png", 64, flavedo_color);
  write_bitmap(output, "albedo.png", 32, albedo_color);
  write_bitmap(output, "pulp.png", 32, pulp_color);
  write_bitmap(output, "juice.png", 32, juice_color);

  const std::vector<Gland> glands = place_glands(4000);
  write_seeds(output, "glands", "oil glands and the dimples above them", gland_placements(glands));
  write_seeds(output, "vesicles", "vesicles of a segment", vesicle_placements(900));
  write_seeds(output, "chromoplasts", "chromoplasts of a vesicle", chromoplast_placements(150));
  write_seeds(output, "pips", "pips", pip_placements());
  output.write("orange.ply", support_mesh(glands));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: make_orange FOLDER\n");
    return 2;
  }
  std::error_code error;
  for (const char* folder : {"sdf", "bmp", "seeds"}) {
    std::filesystem::create_directories(std::filesystem::path(argv[1]) / folder, error);
    if (error) {
      fmt::print(stderr, "make_orange: cannot make folder {}/{}: {}\n", argv[1], folder, error.message());
      return 2;
    }
  }
  Output output(argv[1]);
  make_orange(output);
  if (!output.error().empty()) {
    fmt::print(stderr, "make_orange: {}\n", output.error());
    return 2;
  }
}
