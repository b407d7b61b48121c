#include "tests/render/render_scenes.h"

#include <OpenImageIO/imageio.h>
#include <doctest/doctest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/view/view.h"
#include "tests/cli/scenes.h"
#include "voml/scene.h"

namespace dmvv::tests {
namespace {

double ball(const glm::dvec3& q) { return glm::length(q) - 0.7; }
double wavy(const glm::dvec3& q) { return glm::length(q) - 0.6 - 0.1 * std::sin(7 * q.x) * std::sin(5 * q.y); }

/// n x n^2 pixels, each channel a ramp along one axis.
void write_ramp_bitmap(const std::string& path, std::uint32_t n) {
  runtime::Picture picture;
  picture.size_px = {n, n * n};
  for (std::uint32_t row = 0; row < n * n; ++row) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const double step = 1.0 / (n - 1);
      for (const double value : {x * step, (row % n) * step, (row / n) * step, 1.0}) {
        picture.rgba.push_back(static_cast<float>(value));
      }
    }
  }
  REQUIRE(runtime::write_picture(path, picture));
}

constexpr const char* parts = R"(
  <OBJECT name="BALL"><SDF name="F.BALL" file="ball.lxn"/><REGION name="R.BALL" type="color" rgb="1 0 0"/></OBJECT>
  <OBJECT name="HOLLOW">
    <SDF name="F.OUT" file="ball.lxn"/><SDF name="F.IN" file="wavy.lxn" scale="0.8 0.8 0.8"/>
    <REGION name="R.HULL" type="color" rgb="0 0.5 0"/><REGION name="R.HOLE" type="empty"/>
    <MAPPINGS><SDF name="F.OUT"><POSITIVE region="R.HOLE"/>
      <NEGATIVE><SDF name="F.IN"><POSITIVE region="R.HULL"/><NEGATIVE region="R.HOLE"/></SDF></NEGATIVE></SDF></MAPPINGS>
  </OBJECT>)";

constexpr const char* seeded_root = R"(
  <OBJECT name="ROOT">
    <SDF name="F.DROPS" file="ball.lxn" type="seeding" seedFile="seeds.txt" scale="0.12 0.1 0.14" rotate="0 0 30"/>
    <REGION name="R.DROP" type="color" rgb="0.2 0.4 1"/><REGION name="R.REST" type="color" rgb="0.9 0.9 0.9"/>
    <MAPPINGS><SDF name="F.DROPS"><POSITIVE region="R.REST"/><NEGATIVE region="R.DROP"/></SDF></MAPPINGS>
  </OBJECT>)";

constexpr const char* tiled_root = R"(
  <OBJECT name="ROOT">
    <SDF name="F.TILES" file="wavy.lxn" type="tiling" scale="0.3 0.25 0.2" rotate="10 20 30" offset="0.05"/>
    <REGION name="R.TILE" type="color" rgb="0.6 0.3 0"/><REGION name="R.REST" type="color" rgb="0.1 0.9 0.9"/>
    <MAPPINGS><SDF name="F.TILES"><POSITIVE region="R.REST"/><NEGATIVE region="R.TILE"/></SDF></MAPPINGS>
  </OBJECT>)";

constexpr const char* embedded_root = R"(
  <OBJECT name="MIDDLE"><SDF name="F.WAVY" file="wavy.lxn"/><REGION name="R.MIDDLE" type="color" rgb="1 1 0">
    <EMBEDDED name="HOLLOW" translate="0.1 0 0" scale="0.6 0.5 0.7" rotate="20 30 40"/>
    <EMBEDDED name="BALL" translate="0.1 0 0" scale="0.5 0.5 0.5"/>
  </REGION></OBJECT>
  <OBJECT name="ROOT"><REGION name="R.ROOT" type="color" rgb="0.3 0.3 0.3">
    <INDEX size="8 8 8" scale="0.9 0.9 0.9">
      <EMBEDDED name="HOLLOW" type="seeding" seedFile="seeds.txt" scale="0.12 0.12 0.12" rotate="5 10 15"/>
    </INDEX>
    <EMBEDDED name="MIDDLE" rotate="0 45 0" scale="0.9 0.9 0.9"/>
    <EMBEDDED name="BALL" type="tiling" translate="0.05 0.05 0.05" scale="0.08 0.08 0.08"/>
  </REGION></OBJECT>)";

constexpr const char* bitmap_root = R"(
  <OBJECT name="ROOT"><SDF name="F.BALL" file="ball.lxn"/>
    <REGION name="R.RAMP" type="bitmap" file="ramp.png" scale="0.5 0.5 0.5" rotate="0 0 45"/>
  </OBJECT>)";

constexpr const char* bitmap_around_list_root = R"(
  <OBJECT name="CELL"><SDF name="F.BALL" file="ball.lxn"/><REGION name="R.CELL" type="color" rgb="0.1 0.2 0.9"/>
    <REGION name="R.AIR" type="empty"/><MAPPINGS><SDF name="F.BALL"><POSITIVE region="R.AIR"/><NEGATIVE region="R.CELL"/></SDF></MAPPINGS></OBJECT>
  <OBJECT name="ROOT">
    <REGION name="R.RAMP" type="bitmap" file="ramp.png" translate="1 0 -1" scale="1 1 2">
      <EMBEDDED name="CELL" type="seeding" seedFile="seeds.txt" scale="0.2 0.2 0.2"/></REGION>
  </OBJECT>)";

/// 60 seeds in the cube, fractions of its edge: the additive recurrence of Roberts' R3 sequence, which spreads evenly.
std::string seed_text() {
  std::string text;
  for (int i = 1; i <= 60; ++i) {
    for (const double ratio : {0.8191725134, 0.6710436067, 0.5497004779}) {
      text += std::to_string(0.9 * (std::fmod(ratio * i, 1.0) - 0.5)) + ' ';
    }
    text += '\n';
  }
  return text;
}

template <class T>
std::vector<T> read_picture(const std::string& path, OIIO::TypeDesc type, int channels) {
  const auto file = OIIO::ImageInput::open(path);
  REQUIRE_MESSAGE(file, OIIO::geterror());
  const OIIO::ImageSpec& spec = file->spec();
  REQUIRE(spec.nchannels == channels);
  std::vector<T> values(spec.image_pixels() * static_cast<std::size_t>(channels));
  REQUIRE(file->read_image(0, 0, 0, channels, type, values.data()));
  return values;
}

}  // namespace

runtime::Device& device() {
  static runtime::Device opened = runtime::Device::create({.name = "", .validation = true}).value();
  return opened;
}

std::vector<RenderScene> write_render_scenes(const Folder& folder) {
  folder.write("ball.lxn", sampled(16, ball));
  folder.write("wavy.lxn", sampled(20, wavy));
  folder.write("seeds.txt", seed_text());
  write_ramp_bitmap(folder.file("ramp.png"), 8);
  std::vector<RenderScene> scenes{{"cubes", folder.write("cubes.voml", nested_cubes)}};
  for (const auto& [name, root] : {std::pair{"seeded", seeded_root},
                                   {"tiled", tiled_root},
                                   {"embedded", embedded_root},
                                   {"bitmap", bitmap_root},
                                   {"bitmap_around_list", bitmap_around_list_root}}) {
    scenes.push_back({name, folder.write(std::string(name) + ".voml", std::string("<MVV>") + parts + root + "</MVV>")});
  }
  return scenes;
}

std::vector<std::uint32_t> read_regions(const std::string& path) {
  return read_picture<std::uint32_t>(path, OIIO::TypeDesc::UINT32, 1);
}

std::vector<float> read_depth(const std::string& path) { return read_picture<float>(path, OIIO::TypeDesc::FLOAT, 1); }

std::vector<std::uint8_t> read_rgba8(const std::string& path) {
  return read_picture<std::uint8_t>(path, OIIO::TypeDesc::UINT8, 4);
}

}  // namespace dmvv::tests
