// Makes what the banana scene needs beside its distance grid.
//
//   make_banana SCAN.obj PHOTO FITTED.ply FOLDER    writes peel.png, cores.txt, cores_rotate.txt, cores_scale.txt
//
// PHOTO lies on the scan's texture coordinates; FITTED.ply is the scan as `dmvv sdf --write-mesh` placed it in the
// cube. The photo is moved into a 3D bitmap: each texel has the colour of the nearest point of the surface. The seeds
// of the core are stations of the line through the middles of cross-sections.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "authoring/triangle_tree.h"
#include "base/files.h"
#include "voml/assets/mesh.h"

namespace {

using dmvv::authoring::Corners;
using dmvv::authoring::TriangleTree;
using glm::dvec2;
using glm::dvec3;

constexpr int texels = 128;
/// The bitmap's cube in the banana's: as in banana_scan.voml.
const dvec3 bitmap_scale(0.95, 0.42, 0.22);
constexpr int stations = 56;

[[noreturn]] void fail(const std::string& message) {
  fmt::print(stderr, "make_banana: {}\n", message);
  std::exit(2);
}

std::string read(const std::string& path) {
  auto bytes = dmvv::disk_files()(path, std::uint64_t{1} << 32);
  if (!bytes) fail(bytes.error().message);
  return std::move(*bytes);
}

dmvv::voml::Mesh read_mesh(const std::string& path) {
  dmvv::Diagnostics diagnostics;
  auto mesh = dmvv::voml::parse_mesh(path, read(path), diagnostics);
  if (!mesh) fail(diagnostics.render());
  return std::move(*mesh);
}

/// The texture coordinates of each triangle's corners, in the order in which voml::parse_mesh gives the triangles.
std::vector<std::array<dvec2, 3>> read_texture_coordinates(const std::string& path) {
  std::istringstream text(read(path));
  std::vector<dvec2> coordinates;
  std::vector<std::array<dvec2, 3>> triangles;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string keyword, corner;
    words >> keyword;
    if (keyword == "vt") {
      dvec2 uv;
      words >> uv.x >> uv.y;
      coordinates.push_back(uv);
    } else if (keyword == "f") {
      std::vector<dvec2> polygon;
      while (words >> corner) {
        const std::size_t slash = corner.find('/');
        const std::size_t index =
            slash == std::string::npos ? 0 : std::strtoul(corner.c_str() + slash + 1, nullptr, 10);
        if (index < 1 || index > coordinates.size()) fail(path + ": a corner without texture coordinates");
        polygon.push_back(coordinates[index - 1]);
      }
      for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        triangles.push_back({polygon[0], polygon[i], polygon[i + 1]});
    }
  }
  return triangles;
}

// ---- the photo ----

struct Photo {
  int width = 0, height = 0, channels = 0;
  std::vector<std::uint8_t> pixels;

  /// The mean around a texture coordinate; what no part of the surface uses is black and does not count.
  dvec3 around(const dvec2& uv) const {
    constexpr int radius = 3;
    const int column = static_cast<int>(uv.x * width), row = static_cast<int>((1.0 - uv.y) * height);
    dvec3 sum(0.0);
    int used = 0;
    for (int y = std::max(0, row - radius); y <= std::min(height - 1, row + radius); ++y) {
      for (int x = std::max(0, column - radius); x <= std::min(width - 1, column + radius); ++x) {
        const std::uint8_t* rgb = &pixels[(static_cast<std::size_t>(y) * width + x) * channels];
        if (rgb[0] + rgb[1] + rgb[2] < 24) continue;
        sum += dvec3(rgb[0], rgb[1], rgb[2]);
        ++used;
      }
    }
    return used == 0 ? dvec3(0.0) : sum / (255.0 * used);
  }
};

Photo read_photo(const std::string& path) {
  const auto file = OIIO::ImageInput::open(path);
  if (!file) fail("cannot read " + path);
  Photo photo{file->spec().width, file->spec().height, file->spec().nchannels, {}};
  photo.pixels.resize(static_cast<std::size_t>(photo.width) * photo.height * photo.channels);
  if (photo.channels < 3 || !file->read_image(0, 0, 0, photo.channels, OIIO::TypeDesc::UINT8, photo.pixels.data()))
    fail("cannot read " + path);
  return photo;
}

/// Shares of the corners in the point of a triangle next to p: those of p's projection, none below zero.
dvec3 shares(const Corners& t, const dvec3& p) {
  const dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const auto share = [&](int i) {
    return std::max(0.0, glm::dot(normal, glm::cross(t[(i + 2) % 3] - t[(i + 1) % 3], p - t[(i + 1) % 3])));
  };
  const dvec3 weights(share(0), share(1), share(2));
  const double sum = weights.x + weights.y + weights.z;
  return sum > 0.0 ? weights / sum : dvec3(1.0 / 3.0);
}

void write_peel(const std::string& path, const std::vector<Corners>& triangles, const TriangleTree& tree,
                const std::vector<std::array<dvec2, 3>>& coordinates, const Photo& photo) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(3u * texels * texels * texels);
  TriangleTree::Index nearest = 0;
  for (int row = texels * texels - 1; row >= 0;
       --row) {  // rows of the file start at the top, of the format at the bottom
    for (int x = 0; x < texels; ++x) {
      const dvec3 p = bitmap_scale * ((dvec3(x, row % texels, row / texels) + 0.5) / double(texels) * 2.0 - 1.0);
      tree.distance(p, nearest);
      const std::uint32_t triangle = tree.given_number(nearest);
      const dvec3 w = shares(triangles[triangle], p);
      const auto& uv = coordinates[triangle];
      const dvec3 rgb = photo.around(w.x * uv[0] + w.y * uv[1] + w.z * uv[2]);
      for (int c = 0; c < 3; ++c) pixels.push_back(static_cast<std::uint8_t>(rgb[c] * 255.0 + 0.5));
    }
  }
  const auto file = OIIO::ImageOutput::create(path);
  if (!file || !file->open(path, OIIO::ImageSpec(texels, texels * texels, 3, OIIO::TypeDesc::UINT8)) ||
      !file->write_image(OIIO::TypeDesc::UINT8, pixels.data()) || !file->close()) {
    fail("cannot write " + path);
  }
}

// ---- the core ----

struct Section {
  dvec3 middle{0.0};
  double radius = 0.0;
};

/// The cross-section of the solid through `about`, across `along`: its middle, and the radius of a disc as large.
/// Counted on a lattice of rays across; a point is inside where the surface winds around it.
Section section(const TriangleTree& tree, const dvec3& about, const dvec3& along) {
  constexpr int n = 48;
  constexpr double reach = 0.3;
  const dvec3 z = glm::normalize(dvec3(0, 0, 1) - along.z * along), y = glm::cross(z, along);
  dvec3 sum(0.0);
  int inside = 0;
  for (int i = 0; i < n * n; ++i) {
    const dvec3 p =
        about + reach * ((2.0 * (i % n) + 1.0) / n - 1.0) * y + reach * ((2.0 * (i / n) + 1.0) / n - 1.0) * z;
    if (tree.winding_number(p) < 0.5) continue;
    sum += p;
    ++inside;
  }
  if (inside == 0) return {about, 0.0};
  return {sum / double(inside), 2.0 * reach / n * std::sqrt(inside / 3.14159265358979)};
}

void write_cores(const std::string& folder, const TriangleTree& tree, double lo, double hi) {
  std::vector<Section> line;
  for (int i = 0; i < stations; ++i) {
    const double x = lo + (hi - lo) * i / (stations - 1);
    line.push_back(section(tree, dvec3(x, 0, 0), dvec3(1, 0, 0)));
  }
  // Once more, across the line found; then smoothed.
  const auto along = [&](std::size_t i) {
    return glm::normalize(line[std::min(i + 1, line.size() - 1)].middle - line[i == 0 ? 0 : i - 1].middle);
  };
  std::vector<Section> across;
  for (std::size_t i = 0; i < line.size(); ++i) across.push_back(section(tree, line[i].middle, along(i)));
  for (int round = 0; round < 3; ++round) {
    line = across;
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      across[i].middle = (line[i - 1].middle + 2.0 * line[i].middle + line[i + 1].middle) / 4.0;
      across[i].radius = (line[i - 1].radius + 2.0 * line[i].radius + line[i + 1].radius) / 4.0;
    }
  }
  line = across;

  std::string places, turns, scales;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const dvec3 d = along(i), p = line[i].middle / 2.0;
    places += fmt::format("{:.5f} {:.5f} {:.5f}\n", p.x, p.y, p.z);
    // Turned about the line, so that a cut along it meets a row of seeds and no seam.
    turns += fmt::format("13 {:.2f} {:.2f}\n", glm::degrees(-std::asin(d.z)), glm::degrees(std::atan2(d.y, d.x)));
    const double half_length =
        0.55 * glm::distance(line[i == 0 ? 0 : i - 1].middle, line[std::min(i + 1, line.size() - 1)].middle) /
        (i == 0 || i + 1 == line.size() ? 1.0 : 2.0);
    scales += fmt::format("{:.5f} {:.5f} {:.5f}\n", half_length, line[i].radius, line[i].radius);
  }
  for (const auto& [name, text] :
       {std::pair{"cores.txt", &places}, {"cores_rotate.txt", &turns}, {"cores_scale.txt", &scales}}) {
    if (const auto written = dmvv::write_file(folder + "/" + name, *text); !written) fail(written.error().message);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    fmt::print(stderr, "usage: make_banana SCAN.obj PHOTO FITTED.ply FOLDER\n");
    return 2;
  }
  const dmvv::voml::Mesh mesh = read_mesh(argv[3]);
  const auto coordinates = read_texture_coordinates(argv[1]);
  if (coordinates.size() != mesh.triangles.size()) fail("the scan and the fitted mesh are not the same");
  std::vector<Corners> triangles;
  for (const glm::uvec3& t : mesh.triangles) {
    triangles.push_back({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]});
  }
  const TriangleTree tree(triangles);
  const dmvv::voml::Bounds box = dmvv::voml::bounds(mesh);
  const std::string folder = argv[4];
  // Stalk and tip have no core.
  const double length = box.hi.x - box.lo.x;
  write_cores(folder, tree, box.lo.x + 0.10 * length, box.hi.x - 0.20 * length);
  write_peel(folder + "/peel.png", triangles, tree, coordinates, read_photo(argv[2]));
}
