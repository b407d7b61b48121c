// How distance grids are stored in texels, and how values between samples are found.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dmvv::compiler {

/// Normalised formats hold value / scale, one scale a grid (compiler/grids/texels.h).
enum class TexelFormat : std::uint8_t {
  r32f,
  r16f,
  snorm16,
  snorm8,
  unorm8,   ///< of Codegen::thesis alone
  rgba16f,  ///< of bitmaps
};
std::size_t bytes_per_texel(TexelFormat format);

/// How a value between the samples of a distance grid is found.
enum class Filter : std::uint8_t {
  hardware,  ///< trilinear, by the texture unit and with its weights (some have only 8 bits of them)
  shader,    ///< trilinear, 8 fetches and float32 weights
  tricubic,  ///< Catmull-Rom, 64 fetches: keeps the samples, smooth where trilinear has edges
};

}  // namespace dmvv::compiler
