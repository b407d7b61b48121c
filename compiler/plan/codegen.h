// The forms that generated code can have.
#pragma once

#include <cstdint>

namespace dmvv::compiler {

enum class Codegen : std::uint8_t {
  specialised,  ///< the scene is the program
  table,        ///< records and one generic loop, as the thesis does it
  thesis,       ///< table with the errors of the published implementation (spec/thesis.md): for comparisons only
  automatic,    ///< object by object specialised or table, as the device's costs say
};

}  // namespace dmvv::compiler
