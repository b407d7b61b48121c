// How shaders read the records of a scene.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dmvv::compiler {

/// How shaders read the records that each point finds by an index of its own (shaders/access.glsl). The values are the
/// same. From a storage buffer lavapipe loads them point after point, a texel of a storage texel buffer for eight
/// points at once.
enum class RecordAccess : std::uint8_t { buffers, texels };

/// What a buffer is to shaders.
enum class BufferForm : std::uint8_t {
  records,   ///< a storage buffer
  r32ui,     ///< a storage texel buffer, a word a texel
  rg32ui,    ///< likewise, two words
  rgba32ui,  ///< likewise, four words
};
/// 0 for records.
std::size_t bytes_per_texel(BufferForm form);

/// What the buffer at this binding of set 0 is to the kernels that generate_glsl writes.
BufferForm form_of(std::uint32_t binding, RecordAccess access);

}  // namespace dmvv::compiler
