#include "runtime/frame/resolve.h"

#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace dmvv::runtime {
namespace {

/// Straight colour of the mean of samples^2 premultiplied colours. `first` is sample (0, 0), rows are `pitch` apart.
glm::vec4 mean_color(const glm::vec4* first, std::size_t pitch, std::uint32_t samples) {
  if (samples == 1) return *first;
  glm::vec3 premultiplied(0.0f);
  float alpha = 0.0f;
  for (std::uint32_t y = 0; y < samples; ++y) {
    for (std::uint32_t x = 0; x < samples; ++x) {
      const glm::vec4& color = first[y * pitch + x];
      premultiplied += glm::vec3(color) * color.a;
      alpha += color.a;
    }
  }
  const float count = static_cast<float>(samples * samples);
  return alpha > 0.0f ? glm::vec4(premultiplied / alpha, alpha / count) : glm::vec4(0.0f);
}

bool is_surface(const glm::uvec4& texel) { return texel.w != 0; }

float depth_of(const FrameSetup& setup, std::uint32_t region, const glm::uvec4& texel) {
  if (region == 0) return std::numeric_limits<float>::infinity();
  if (setup.slice) return 0.0f;
  return static_cast<float>(glm::dot(setup.forward, glm::dvec3(glm::uintBitsToFloat(glm::uvec3(texel))) - setup.eye));
}

/// The point that the kernel evaluates (shaders/pixels.comp).
glm::vec3 position_of(const FrameSetup& setup, const glm::uvec4& texel) {
  if (!is_surface(texel)) return glm::vec3(std::numeric_limits<float>::quiet_NaN());
  return glm::clamp(glm::uintBitsToFloat(glm::uvec3(texel)), glm::vec3(setup.pixels.bounds_lo),
                    glm::vec3(setup.pixels.bounds_hi));
}

/// As shaders/surface.glsl folds it.
glm::vec3 normal_of(const glm::uvec4& texel) {
  if (!is_surface(texel)) return glm::vec3(0.0f);
  const glm::vec2 folded(glm::vec2(texel.w & 0xffffu, texel.w >> 16 & 0x7fffu) / glm::vec2(32767.0f, 16383.0f) - 1.0f);
  const float z = 1.0f - std::abs(folded.x) - std::abs(folded.y);
  const auto unfolded = [&](float along, float across) {
    return z < 0.0f ? std::copysign(1.0f - std::abs(across), along) : along;
  };
  return glm::normalize(glm::vec3(unfolded(folded.x, folded.y), unfolded(folded.y, folded.x), z));
}

void put_color(const glm::vec4& color, std::size_t pixel, Picture& picture) {
  for (int channel = 0; channel < 4; ++channel) {
    if (picture.rgba.empty()) {
      picture.rgba8[4 * pixel + static_cast<std::size_t>(channel)] = to_byte(color[channel]);
    } else {
      picture.rgba[4 * pixel + static_cast<std::size_t>(channel)] = color[channel];
    }
  }
}

}  // namespace

Picture empty_picture(const View& view) {
  Picture picture;
  picture.size_px = view.size_px;
  const std::size_t pixels = std::size_t{view.size_px.x} * view.size_px.y;
  (view.colors == Colors::bytes ? picture.rgba8.resize(4 * pixels) : picture.rgba.resize(4 * pixels));
  if (view.want_regions) picture.regions.resize(pixels);
  if (view.want_doubt && view.rays && !view.slice) picture.doubt.resize(pixels);
  if (view.want_depth) picture.depth.resize(pixels, std::numeric_limits<float>::infinity());
  if (view.want_normals && !view.slice) picture.normals.resize(pixels, glm::vec3(0.0f));
  if (view.want_positions) picture.positions.resize(pixels, glm::vec3(std::numeric_limits<float>::quiet_NaN()));
  return picture;
}

void resolve_tile(const TilePixels& from, const Tile& tile, const FrameSetup& setup, std::uint32_t samples,
                  Picture& picture) {
  const std::size_t pitch = tile.size_px.x;
  const glm::uvec2 corner = tile.corner_px / samples, size = tile.size_px / samples;
  for (std::uint32_t y = 0; y < size.y; ++y) {
    const std::size_t row = std::size_t{corner.y + y} * picture.size_px.x + corner.x;
    if (from.bytes != nullptr) {  // one sample a pixel, channels in the order of the bytes
      std::memcpy(&picture.rgba8[4 * row], from.bytes + y * pitch, 4 * std::size_t{size.x});
    }
    if (from.bytes != nullptr && from.regions == nullptr && from.surface == nullptr && from.notes == nullptr) continue;
    for (std::uint32_t x = 0; x < size.x; ++x) {
      const std::size_t source = y * samples * pitch + x * samples;
      const std::size_t pixel = row + x;
      if (from.colors != nullptr) put_color(mean_color(from.colors + source, pitch, samples), pixel, picture);
      if (!picture.doubt.empty()) picture.doubt[pixel] = (from.notes[source] & DMVV_NOTE_DOUBT) != 0 ? 1 : 0;
      if (!picture.regions.empty()) picture.regions[pixel] = from.regions[source];
      if (!picture.depth.empty()) picture.depth[pixel] = depth_of(setup, from.regions[source], from.surface[source]);
      if (!picture.normals.empty()) picture.normals[pixel] = normal_of(from.surface[source]);
      if (!picture.positions.empty()) picture.positions[pixel] = position_of(setup, from.surface[source]);
    }
  }
}

}  // namespace dmvv::runtime
