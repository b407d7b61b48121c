#include "compiler/layout/record_access.h"

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

BufferForm form_of(std::uint32_t binding, RecordAccess access) {
  if (access == RecordAccess::buffers) return BufferForm::records;
  switch (binding) {
    case DMVV_BIND_CELLS:
    case DMVV_BIND_LISTS:
    case DMVV_BIND_TAPE_CELLS:
      return BufferForm::r32ui;
    case DMVV_BIND_TAPES:
      return BufferForm::rg32ui;
    case DMVV_BIND_PLACEMENTS:
    case DMVV_BIND_SCALINGS:
    case DMVV_BIND_PARAMETERS:
      return BufferForm::rgba32ui;
    default:
      return BufferForm::records;
  }
}

}  // namespace dmvv::compiler
