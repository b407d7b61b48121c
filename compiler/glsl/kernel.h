// What is asked of a scene, and from where: each is a compute shader of its own.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dmvv::compiler {

/// The entry points of a program; each is a compute shader of its own (interfaces: shaders/points.comp, pixels.comp).
enum class Kernel : std::uint8_t {
  points,   ///< points in a buffer -> region, path and colour of each
  pixels,   ///< surface positions in images -> colour and region of each pixel
  leaders,  ///< as pixels, and how far each answer holds; if made at all (CompileOptions::many_frames)
};
inline constexpr std::size_t kernel_count = 3;

}  // namespace dmvv::compiler
