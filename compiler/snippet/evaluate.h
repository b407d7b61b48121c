// A program evaluated at a point, or over a box.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "compiler/snippet/dual.h"
#include "compiler/snippet/integer_interval.h"
#include "compiler/snippet/program.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler::snippet {

template <class Real>
struct Evaluated {
  Real f;
  bool finished;  ///< false: the step budget was used up; f is NaN
};

/// At p.x, p.y, p.z, t; Real: double, float (what a device may compute, operation by operation) or DualNumber.
/// Cost: no more than Snippet::step_budget instructions.
template <class Real>
Evaluated<Real> evaluate_point(const Program& program, const std::array<Real, Program::input_count>& inputs);

/// A value over a box: the one of its type counts.
struct BoxValue {
  Interval f{0.0, 0.0};
  IntegerInterval i{0, 0};
};

/// Encloses the values over all inputs, as Snippet::evaluate says. `hoisted` are the registers from
/// program.register_count() on, that a residual reads (time_values.h).
Interval evaluate_box(const Program& program, const std::array<Interval, Program::input_count>& inputs,
                      Rounding rounding, std::span<const BoxValue> hoisted = {});

/// An operation whose result jumps, over a box within which it does.
struct Jump {
  std::uint32_t instruction;
  double operand_width;  ///< how far apart the bounds of what it takes are; of mod, in divisors
};
struct BoxAndJump {
  Interval value;
  std::optional<Jump> jump;  ///< the first on the way whose operand is a quarter wide or more
};

/// As evaluate_box with Rounding::float32, and tells which operation took most of what was known.
BoxAndJump evaluate_box_and_jump(const Program& program, const std::array<Interval, Program::input_count>& inputs,
                                 std::span<const BoxValue> hoisted);

/// Over all inputs, as Snippet::steepness says. Unknown where something jumps or is not understood.
Steepness steepness_over(const Program& program, const std::array<Interval, Program::input_count>& inputs,
                         std::span<const BoxValue> hoisted);

}  // namespace dmvv::compiler::snippet
