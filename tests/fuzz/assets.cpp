// Distance grids, lists of vectors, bitmaps.
#include <cmath>
#include <cstdint>
#include <string>

#include "tests/fuzz/targets.h"
#include "voml/assets/grid.h"

namespace dmvv::fuzz {

void run_lxn(std::string_view bytes) {
  Diagnostics diagnostics;
  const auto grid = voml::parse_lxn(bytes, diagnostics.add_source("a.lxn", {}), diagnostics);
  must(grid.has_value() == !diagnostics.has_errors(), "a grid or an error");
  if (!grid) return must(!diagnostics.render().empty(), "errors are told");
  must(grid->values.size() == std::size_t{grid->size.x} * grid->size.y * grid->size.z, "as many values as samples");
  for (const float value : grid->values) must(std::isfinite(value), "values are finite");
  for (int axis = 0; axis < 3; ++axis) must(grid->box_lo[axis] < grid->box_hi[axis], "the box is not empty");
  const std::string written = voml::write_lxn(*grid);
  const auto again = voml::parse_lxn(written, diagnostics.add_source("b.lxn", {}), diagnostics);
  must(again && again->values == grid->values && voml::write_lxn(*again) == written, "what is written can be read");
}

void run_vectors(std::string_view bytes) {
  Diagnostics diagnostics;
  const auto vectors = voml::parse_vectors(diagnostics.add_source("a.txt", std::string(bytes)), diagnostics);
  must(vectors.has_value() == !diagnostics.has_errors(), "vectors or an error");
  if (!vectors) return must(!diagnostics.render().empty(), "errors are told");
  for (const glm::dvec3& v : *vectors) must(std::isfinite(v.x + v.y + v.z), "vectors are finite");
}

namespace {

/// Mutated PNG files fail at a checksum: half of them get right ones, to come farther.
std::string with_right_checksums(std::string_view bytes) {
  std::string fixed(bytes);
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(fixed[i]); };
  for (std::size_t at = 8; fixed.size() >= at + 12;) {
    const std::uint64_t length = std::uint64_t{byte(at)} << 24 | byte(at + 1) << 16 | byte(at + 2) << 8 | byte(at + 3);
    if (length > fixed.size() - at - 12) break;
    std::uint32_t crc = 0xffffffffu;
    for (std::size_t i = at + 4; i < at + 8 + length; ++i) {
      crc ^= byte(i);
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
    }
    for (std::size_t i = 0; i < 4; ++i) fixed[at + 8 + length + i] = static_cast<char>(~crc >> (24 - 8 * i));
    at += 12 + length;
  }
  return fixed;
}

}  // namespace

void run_bitmap(std::string_view bytes) {
  const std::string png =
      bytes.starts_with("\x89PNG") && bytes.size() % 2 == 0 ? with_right_checksums(bytes) : std::string();
  if (!png.empty()) bytes = png;
  Diagnostics diagnostics;
  const auto bitmap = voml::parse_bitmap(bytes, "a.png", {diagnostics.add_source("a.voml", {}), 0, 0}, diagnostics);
  must(bitmap.has_value() == !diagnostics.has_errors(), "a bitmap or an error");
  if (!bitmap) return must(!diagnostics.render().empty(), "errors are told");
  must(bitmap->texels.size() == std::size_t{bitmap->n} * bitmap->n * bitmap->n, "n^3 texels");
}

}  // namespace dmvv::fuzz
