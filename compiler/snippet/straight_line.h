// A snippet without control flow: what is left of a program when loops are unrolled and branches become choices, and
// how it is shortened where intervals decide its minima, maxima and choices.
//
//   TimeSplit --straighten--> StraightLine --evaluate_steps over a box--> values --shorten--> StraightLine
//
// Sources: Keeter 2020, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces" (tapes shortened a box
// by intervals); Allen, Kennedy, Porterfield, Warren 1983, "Conversion of control dependence to data dependence".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/program.h"
#include "compiler/snippet/time_values.h"

namespace dmvv::compiler::snippet {

/// Makes one value, which has the number of its step.
struct Step {
  enum class Kind : std::uint8_t {
    point,      ///< p[operands[0]]
    constant,   ///< operands[0] are its bits (program.h, Constant)
    hoisted,    ///< number operands[0] of TimeSplit::hoisted
    operation,  ///< op of earlier steps; never of arrays
  };
  Kind kind = Kind::operation;
  Type type = Type::real;
  Op op = Op::f_copy;
  std::array<std::uint32_t, 3> operands{};
  friend bool operator==(const Step&, const Step&) = default;
};

/// Steps in an order in which few values wait at a time; the last one is the result. None is without use.
struct StraightLine {
  std::vector<Step> steps;
  friend bool operator==(const StraightLine&, const StraightLine&) = default;
};

/// Operands of an operation; 0 of any other step.
inline std::uint32_t operand_count(const Step& step) {
  static constexpr std::uint8_t counts[] = {
#define DMVV_OP(name, result, operands) sizeof(operands) - 1,
#include "compiler/snippet/ops.def"
#undef DMVV_OP
  };
  return step.kind == Step::Kind::operation ? counts[static_cast<std::size_t>(step.op)] : 0;
}

/// Makes the residual of a snippet a straight line with the same result at every point: of a branch both sides are
/// computed and one is chosen, loops are unrolled, arrays become values.
/// Errors: a loop of which the point or the time decides how often it runs, an array whose place they decide, more than
///         262,144 steps: in the words of a user ("a loop ...").
/// Cost:   linear in the steps made, times the variables where branches meet.
Result<StraightLine> straighten(const TimeSplit& split);

/// The value of each step over a box, as a device may compute it (Rounding::float32), at the times for which `hoisted`
/// holds (device_values). A finite, sound superset like all intervals: unknown where nothing is known.
/// Cost: some 50 ns a step. `values` is given its size; keep it from call to call.
void evaluate_steps(const StraightLine& line, const Box& box, std::span<const BoxValue> hoisted,
                    std::vector<BoxValue>& values);

/// Leaves out what does not reach the result where the values hold: a minimum of which one side is surely less is that
/// side, likewise maxima, choices, sums with 0, products with 1. A device that computes operation by operation
/// (`precise`) gets the same bits as from `line` at every point of the box, but for the sign of a zero where nothing
/// shows it.
/// In: values from evaluate_steps of this very line.
StraightLine shorten(const StraightLine& line, std::span<const BoxValue> values);

/// Without interval: the value at a point in Real (float: what a device computes, operation by operation).
/// In: the hoisted values in order, each rounded to float32 and in the cell of its type.
template <class Real>
Real evaluate_at(const StraightLine& line, const std::array<Real, 3>& p, std::span<const BoxValue> hoisted);

}  // namespace dmvv::compiler::snippet
