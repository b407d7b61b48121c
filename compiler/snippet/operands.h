// An instruction's operands are read by the table of operations, which also tells whether it stores.
#pragma once

#include <cstddef>
#include <string_view>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// Calls use(k, letter) for each operand k, with the letter that the table gives it (OpInfo::operands).
template <class Use>
void for_operands(const Instruction& instruction, Use use) {
  const std::string_view letters = info(instruction.op).operands;
  for (std::size_t k = 0; k < letters.size(); ++k) use(k, letters[k]);
}

/// Into an array, whose number is operand 0; it has no result.
inline bool is_store(Op op) { return op >= Op::f_store && op <= Op::b_store; }
inline bool is_store(const Instruction& instruction) { return is_store(instruction.op); }

}  // namespace dmvv::compiler::snippet
