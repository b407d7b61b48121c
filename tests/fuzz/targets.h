// The fuzz targets: each reads bytes of one kind, whatever they are, and checks what comes out.
//
// libfuzzer.cpp runs one of them under libFuzzer, replay.cpp all of them over the seeds and what the fuzzer once found.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace dmvv::fuzz {

/// May be anything; a file of the target's kind does something.
using Run = void (*)(std::string_view bytes);

void run_voml(std::string_view bytes);
void run_lxn(std::string_view bytes);
void run_vectors(std::string_view bytes);
void run_bitmap(std::string_view bytes);
void run_mesh(std::string_view bytes);
void run_snippet(std::string_view bytes);
void run_molecule(std::string_view bytes);
void run_table(std::string_view bytes);
void run_cellpack(std::string_view bytes);
void run_program(std::string_view bytes);

struct Target {
  std::string_view name;
  Run run;
};
inline constexpr Target targets[] = {{"voml", run_voml},         {"lxn", run_lxn},     {"vectors", run_vectors},
                                     {"bitmap", run_bitmap},     {"mesh", run_mesh},   {"snippet", run_snippet},
                                     {"molecule", run_molecule}, {"table", run_table}, {"cellpack", run_cellpack},
                                     {"program", run_program}};

/// Ends the process if `holds` is false: a finding.
inline void must(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

}  // namespace dmvv::fuzz
