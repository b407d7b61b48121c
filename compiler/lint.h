// What is allowed, but probably not meant: distances that are none, surfaces that are cut off.
#pragma once

#include "compiler/module.h"

namespace dmvv::compiler {

/// Looks at the analytic SDFs of a module.
///
/// Warnings: W0402 the gradient of an SDF, in its own frame, is at most a quarter or more than twice that of a distance
/// (the largest norm found at some 600 points, and where). W0403 an SDF whose positive side is empty is negative at the
/// border of its object's or its own standard cube, where the surface is cut off by the cube; not for tilings, for
/// SDFs that are negative everywhere, and where another SDF of the tree decides at that place. Both name a point and,
/// for animated functions, a time.
/// Both sample: what lies between the samples is not seen.
/// Cost: some milliseconds an SDF and time; one time for static ones, 30 in the first 20 s and an hour for others.
void lint(const Module& module, Diagnostics& diagnostics);

}  // namespace dmvv::compiler
