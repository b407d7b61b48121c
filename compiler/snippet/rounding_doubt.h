// Inside compiler: where float32 arithmetic cannot tell what a snippet is, and which operation makes it so.
#pragma once

#include <glm/vec3.hpp>
#include <string>

#include "compiler/snippet/snippet.h"

namespace dmvv::compiler::snippet {

/// What rounding does to a snippet at a point.
struct RoundingDoubt {
  Interval bounds;      ///< of every float32 evaluation
  double exact = 0.0;   ///< in double
  double single = 0.0;  ///< in float32, operation by operation
  /// The place of the first operation on the way that jumps (fract, floor, mod, ...) with an operand that float32 knows
  /// to within a quarter of a jump's distance at best: "fract of a product of 43758.5 and a sine". Empty: there is
  /// none.
  std::string jump;
  double operand_width = 0.0;  ///< of the jump: how far apart the operand's bounds are
};

/// In: a point whose coordinates, and a time that, float32 holds exactly.
/// Cost: three evaluations, one of them over intervals: some 0.1 us an instruction.
RoundingDoubt rounding_doubt(const Snippet& snippet, const glm::vec3& p, float t_ms);

}  // namespace dmvv::compiler::snippet
