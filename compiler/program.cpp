#include "compiler/program.h"

#include <algorithm>
#include <cstring>

#include "compiler/layout/flatten.h"
#include "compiler/layout/resources.h"

namespace dmvv::compiler {

std::string records_text(const Program& program) {
  Records records;
  const auto decode = [&]<class Record>(std::uint32_t binding, std::vector<Record>& into) {
    const auto buffer = std::ranges::find(program.buffers, binding, &Buffer::binding);
    if (buffer == program.buffers.end()) return;
    into.resize(buffer->count);
    std::memcpy(into.data(), buffer->bytes.data(), into.size() * sizeof(Record));
  };
  decode(DMVV_BIND_NODES, records.nodes);
  decode(DMVV_BIND_SDFS, records.sdfs);
  decode(DMVV_BIND_REGIONS, records.regions);
  decode(DMVV_BIND_GROUPS, records.groups);
  decode(DMVV_BIND_PLACEMENTS, records.placements);
  decode(DMVV_BIND_CELLS, records.cells);
  decode(DMVV_BIND_LISTS, records.lists);
  decode(DMVV_BIND_OBJECTS, records.objects);
  return to_text(records);
}

}  // namespace dmvv::compiler
