// Programs that were written to files: what a file says behind its hash.
#include "compiler/program_file.h"

#include <cstdint>
#include <string>

#include "base/content_hash.h"
#include "tests/fuzz/targets.h"

namespace dmvv::fuzz {

namespace {

/// What every file begins with, up to the hash: as the writer has it.
std::string mark_and_format() {
  constexpr std::size_t end = std::string_view("dmvv program\n").size() + sizeof(std::uint32_t);
  return compiler::write_program({}).substr(0, end);
}

}  // namespace

/// The bytes stand behind a header that fits them: the hash would refuse nearly everything else.
void run_program(std::string_view bytes) {
  ContentHash hash;
  hash.add(bytes);
  std::string file = mark_and_format();
  file += hash.digits();
  file += bytes;
  const auto program = compiler::read_program(file, "p.dmvv");
  if (!program) return must(!program.error().message.empty(), "refusals say why");
  must(compiler::write_program(*program) == file, "what was read is what was written");
  must(compiler::snippet::time_values(program->time_slots, 1234.5).size() == program->time_slots.size(),
       "each time value is computed");
}

}  // namespace dmvv::fuzz
