// When pixels are evaluated in stages.
#pragma once

#include <cstdint>

namespace dmvv::compiler {

/// Lines after inlining, as they are estimated. Measured on lavapipe: for pixels, the list of a stage costs as much as
/// some 40 lines of code; below 500 in all (orange, mycoplasma) lists cost more than the code that they save.
struct StageOptions {
  std::uint32_t least_program_lines = 500;  ///< a program with fewer lines is not divided
  std::uint32_t least_lines = 40;  ///< a group becomes a stage of its own if the code it calls has as many lines
};

}  // namespace dmvv::compiler
