#include "compiler/program.h"

#include <algorithm>
#include <cstring>

#include "compiler/layout/flatten.h"
#include "compiler/layout/resources.h"
#include "compiler/layout/scene_buffers.h"

namespace dmvv::compiler {

const Kernel* Program::find_kernel(std::string_view name) const {
  const auto found = std::ranges::find(kernels, name, [](const Kernel& kernel) { return kernel.spec.name; });
  return found == kernels.end() ? nullptr : &*found;
}

std::string records_text(const Program& program) {
  const auto decode = [&]<class Record>(std::uint32_t binding, std::vector<Record>& into) {
    const auto buffer = std::ranges::find(program.buffers, binding, &Buffer::binding);
    if (buffer == program.buffers.end()) return;
    into.resize(buffer->count);
    std::memcpy(into.data(), buffer->bytes.data(), into.size() * sizeof(Record));
  };
  Records decoded;
  const auto decode_all = [&](auto& all) {
#define DMVV_SCENE_BUFFER(name, number, element, texels, present, contents) \
  if constexpr (requires { all.name; }) decode(scene_binding::name, all.name);
#include "compiler/layout/scene_buffers.def"
#undef DMVV_SCENE_BUFFER
  };
  decode_all(decoded);
  return to_text(decoded);
}

}  // namespace dmvv::compiler
