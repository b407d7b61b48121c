// A program slice is the part of a program that reaches some of its registers (Weiser 1981, "Program Slicing").
#pragma once

#include <span>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// The part of a program that reaches some of its registers: the instructions that their values hang on, and the
/// control flow that decides over these. Registers and arrays keep their numbers, used or not; `result` stays as it is.
/// In:   registers that are none of the program's (those of hoisted values) are passed over.
/// Cost: linear in the program.
Program reaching(const Program& program, std::span<const Register> results);

}  // namespace dmvv::compiler::snippet
