// Most instructions of SPIR-V do one operation a component: a table tells which.
#pragma once

#include <cstdint>
#include <optional>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// How an instruction of SPIR-V becomes one operation; for integers the operand type is the operation's.
struct Scalarwise {
  /// Operands change places, the result is negated, or both.
  enum class Shape : std::uint8_t { plain, swapped, negated, swapped_negated };
  std::uint16_t opcode;
  Op op;
  Shape shape = Shape::plain;
};

/// Null for instructions that are not of the table. Cost: a look at each row.
const Scalarwise* scalarwise_rule(std::uint16_t opcode);

/// Instructions whose operation depends on whether the integers are signed; empty for others.
/// In: the type of the first operand.
std::optional<Op> integer_op(std::uint16_t opcode, Type type);

}  // namespace dmvv::compiler::snippet
