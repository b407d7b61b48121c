// A program evaluated at a point, or over a box.
#pragma once

#include <array>

#include "compiler/snippet/dual.h"
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

/// Encloses the values over all inputs, as Snippet::evaluate says.
Interval evaluate_box(const Program& program, const std::array<Interval, Program::input_count>& inputs,
                      Rounding rounding);

}  // namespace dmvv::compiler::snippet
