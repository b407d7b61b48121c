// The buffers of descriptor set 0: which there are, and how shaders read them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

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

/// Bindings of descriptor set 0 by the names of their buffers.
namespace scene_binding {
#define DMVV_SCENE_BUFFER(name, number, element, texels, present, contents) \
  inline constexpr std::uint32_t name = number;
#include "compiler/layout/scene_buffers.def"
#undef DMVV_SCENE_BUFFER
}  // namespace scene_binding

/// A row of scene_buffers.def.
struct SceneBuffer {
  std::string_view name;
  std::uint32_t binding;
  std::string_view element;  ///< a GLSL type
  std::size_t element_bytes;
  BufferForm as_texels;

  /// What it is to the kernels that generate_glsl writes.
  BufferForm form(RecordAccess access) const {
    return access == RecordAccess::texels ? as_texels : BufferForm::records;
  }
};

/// All rows, in the order of their numbers.
std::span<const SceneBuffer> scene_buffers();

/// The row of a binding; null if there is none.
const SceneBuffer* find_scene_buffer(std::uint32_t binding);

/// Rows that can be texels, which count as images.
inline constexpr std::uint32_t most_texel_buffers = 0
#define DMVV_SCENE_BUFFER(name, number, element, texels, present, contents) +(BufferForm::texels != BufferForm::records)
#include "compiler/layout/scene_buffers.def"
#undef DMVV_SCENE_BUFFER
    ;

}  // namespace dmvv::compiler
