// A program that comes from outside is checked before anything runs it.
#pragma once

#include <string>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// Why evaluators may not run the program; empty if they may. They trust that registers and arrays exist and have the
/// types that operations want, that nothing but variables and temporaries is assigned, and that `leave` and `repeat`
/// stand in a loop or block. Cost: linear.
std::string fault_of(const Program& program);

}  // namespace dmvv::compiler::snippet
