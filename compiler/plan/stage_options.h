// When pixels are evaluated in stages.
#pragma once

#include <cstdint>

namespace dmvv::compiler {

/// Lines after inlining, as they are estimated. Measured on lavapipe: for pixels, the list of a stage costs as much as
/// some 40 lines of code; below 500 in all (orange, mycoplasma) lists cost more than the code that they save.
struct StageOptions {
  std::uint32_t least_program_lines = 500;  ///< of a program that is divided at all
  std::uint32_t least_lines = 40;           ///< of what becomes a stage of its own
};

}  // namespace dmvv::compiler
