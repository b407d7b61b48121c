// Distance grids and their file format LXN (spec/lxn.md), 3D bitmaps, seed lists: the assets a scene refers to.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"

namespace dmvv::voml {

enum class AddressMode : std::int32_t { clamp = 0, wrap = 1, mirror = 2 };

/// A signed distance grid: cell-centred samples over an axis-aligned box of the standard cube.
///
/// Sample (x, y, z) stands at box_lo + (vec3(x, y, z) + 0.5) / size * (box_hi - box_lo).
struct Grid {
  std::string path;  ///< as opened; for messages and dumps
  glm::uvec3 size{0};
  glm::dvec3 box_lo{-1.0};  ///< cube coordinates: 2 * (unit-cube corner of the file) - 1
  glm::dvec3 box_hi{1.0};
  AddressMode address_mode = AddressMode::clamp;  ///< kept for writing; sampling always clamps
  std::int32_t channel_type = 8;                  ///< kept for writing
  std::vector<float> values;                      ///< x fastest, then y, then z; finite; negative inside
};

/// Parses an LXN file. `where` names the file in messages.
/// Errors: a diagnostic that names the field and both numbers; then the result is empty.
/// Cost: one copy of the values.
std::optional<Grid> parse_lxn(std::string_view bytes, SourceId where, Diagnostics& diagnostics);

/// The bytes of an LXN file; parse_lxn gives the same grid back. Box corners are rounded to float32 in the unit cube.
std::string write_lxn(const Grid& grid);

/// A 3D bitmap of n^3 texels, 8 bit RGBA, sRGB values shown as given.
struct Bitmap {
  std::string path;
  std::uint32_t n = 0;
  std::vector<glm::u8vec4> texels;  ///< x fastest, then y, then z (spec/voml.md: rows counted from the bottom)
};

/// Decodes a picture of n x n^2 pixels into its n slices. Errors: a diagnostic at `named_at`.
std::optional<Bitmap> parse_bitmap(std::string_view bytes, const std::string& path, Span named_at,
                                   Diagnostics& diagnostics);

/// One line of each of a seed, rotate and scale file, as written: position in fractions of the cube's edge, degrees.
struct Seed {
  glm::dvec3 position{0.0};
  glm::dvec3 rotate_deg{0.0};
  glm::dvec3 scale{1.0};
};

/// Parses a text of three numbers a line (blanks or commas between, '#' comments, blank lines).
/// Errors: diagnostics at the line and column; then the result is empty.
std::optional<std::vector<glm::dvec3>> parse_vectors(SourceId source, Diagnostics& diagnostics);

}  // namespace dmvv::voml
