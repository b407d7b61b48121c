#include "compiler/layout/scene_buffers.h"

#include <algorithm>
#include <array>

#include "shaders/records.h"

namespace dmvv::compiler {

std::size_t bytes_per_texel(BufferForm form) {
  switch (form) {
    case BufferForm::records:
      return 0;
    case BufferForm::r32ui:
      return 4;
    case BufferForm::rg32ui:
      return 8;
    case BufferForm::rgba32ui:
      return 16;
  }
  return 0;
}

std::span<const SceneBuffer> scene_buffers() {
  using namespace gpu;
  static constexpr std::array rows{
#define DMVV_SCENE_BUFFER(name, number, element, texels, present, contents) \
  SceneBuffer{#name, number, #element, sizeof(element), BufferForm::texels},
#include "compiler/layout/scene_buffers.def"
#undef DMVV_SCENE_BUFFER
  };
  return rows;
}

const SceneBuffer* find_scene_buffer(std::uint32_t binding) {
  const auto found = std::ranges::find(scene_buffers(), binding, &SceneBuffer::binding);
  return found == scene_buffers().end() ? nullptr : &*found;
}

}  // namespace dmvv::compiler
