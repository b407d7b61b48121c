// What is allowed, but probably not meant: distances that are none, surfaces that are missing or cut off.
#pragma once

#include <functional>

#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// Told after each step how many of how many are done. The steps of a call are similar in cost, as far as SDFs are.
using LintProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Looks at the SDFs of a module.
///
/// Warnings: W0402 the gradient of an analytic SDF, in its own frame, is at most a quarter or more than twice that of a
/// distance (the largest norm found at some 600 points, and where). W0403 an SDF whose positive side is empty is
/// negative at the border of its object's or its own standard cube, where the surface is cut off by the cube; not for
/// tilings, for SDFs that are negative everywhere, and where another SDF of the tree decides at that place. W0404 an
/// SDF is inside, or outside, in its whole cube, at all times: all samples of a grid are; of an analytic one, intervals
/// prove it, or samples leave no room for a surface of that slope. W0405 a tiled SDF has another side just beyond a
/// seam of its tiles, and another region is there for it. W0406 float32 arithmetic may come to either side of an
/// analytic SDF at 5 % of the points or more, though they are not near its surface, with the operation that makes it
/// so. All but those of grids name a point and, for animated functions, a time. But for proofs, what lies between the
/// samples is not seen. Cost: some 10,000 evaluations an SDF and time, linear in these; one time for static ones, 30 in
/// the first 20 s and an hour for others.
void lint(const Module& module, Diagnostics& diagnostics, const LintProgress& progress = {});

}  // namespace dmvv::compiler
