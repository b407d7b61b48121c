#include <cstring>

#include "cli/dump.h"
#include "compiler/flatten.h"
#include "shaders/records.h"

namespace dmvv::cli {
namespace {

/// The records of the buffer at `binding`; none if the program has no such buffer.
template <class Record>
void decode(const compiler::Program& program, std::uint32_t binding, std::vector<Record>& records) {
  for (const compiler::Buffer& buffer : program.buffers) {
    if (buffer.binding != binding) continue;
    records.resize(buffer.bytes.size() / sizeof(Record));
    std::memcpy(records.data(), buffer.bytes.data(), records.size() * sizeof(Record));
  }
}

}  // namespace

std::string records_text(const compiler::Program& program) {
  compiler::Records records;
  decode(program, DMVV_BIND_NODES, records.nodes);
  decode(program, DMVV_BIND_SDFS, records.sdfs);
  decode(program, DMVV_BIND_REGIONS, records.regions);
  decode(program, DMVV_BIND_GROUPS, records.groups);
  decode(program, DMVV_BIND_PLACEMENTS, records.placements);
  decode(program, DMVV_BIND_CELLS, records.cells);
  decode(program, DMVV_BIND_LISTS, records.lists);
  decode(program, DMVV_BIND_OBJECTS, records.objects);
  return compiler::to_text(records);
}

}  // namespace dmvv::cli
