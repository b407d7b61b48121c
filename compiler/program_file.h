// Program <-> bytes: what `dmvv compile` writes can be loaded and run by another program.
#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "compiler/program.h"

namespace dmvv::compiler {

/// The whole program, its SPIR-V, GLSL and statistics included: "dmvv program", a format number, the rest's hash, then
/// every field in the order of its declaration; numbers little-endian, texts and lists with their length before them.
/// The same program gives the same bytes. Cost: one copy.
std::string write_program(const Program& program);

/// Reads what write_program wrote. `name` stands in messages.
///
/// Errors (input): no such file, another format, bytes that are missing or changed; a program that no device could run:
/// bindings, sizes and counts that do not fit each other, unknown kernels, SPIR-V that spirv-val refuses, a computation
/// of time values that does not hold together. Nothing is trusted but that a validated shader stays within its buffers,
/// as those of `compile` do: a forged file can still give wrong answers.
/// Cost: one copy, and spirv-val (some 10 ms a kernel).
Result<Program> read_program(std::string_view bytes, const std::string& name);

}  // namespace dmvv::compiler
