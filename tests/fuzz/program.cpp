// Programs that were written to files: what a file says behind its hash.
#include "compiler/program_file.h"

#include <cstdint>
#include <string>

#include "base/content_hash.h"
#include "tests/fuzz/targets.h"

namespace dmvv::fuzz {

/// The bytes stand behind a header that fits them: the hash would refuse nearly everything else.
void run_program(std::string_view bytes) {
  const std::uint32_t format = 1;
  ContentHash hash;
  hash.add(bytes);
  std::string file = "dmvv program\n";
  file.append(reinterpret_cast<const char*>(&format), sizeof format);
  file += hash.digits();
  file += bytes;
  const auto program = compiler::read_program(file, "p.dmvv");
  if (!program) return must(!program.error().message.empty(), "refusals say why");
  must(compiler::write_program(*program) == file, "what was read is what was written");
  must(compiler::snippet::time_values(program->time_slots, 1234.5).size() == program->time_slots.size(),
       "each time value is computed");
}

}  // namespace dmvv::fuzz
