// How steep distance sources are: what an answer needs to tell how far it holds (shaders/reach.glsl).
#pragma once

#include <array>
#include <vector>

#include "compiler/grids/storage.h"
#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// How fast the value of an SDF's source can change, by how far it is from iso. Whoever goes from a point of some value
/// to the boundary passes all values in between, each where the source is no steeper than it is anywhere at that value.
struct Steepness {
  std::array<double, 2> widths{};  ///< |value - iso| at which the near and the middle band end
  std::array<double, 3> slopes{};  ///< of the near, the middle and the far band; infinite where nothing is known
  double error = 0.0;              ///< what a device gets wrong of a value

  /// How far from a point with this |value - iso| the boundary is at least. Not positive: nothing is known.
  double distance(double value) const;
};

/// One over a slope, a little less, as shaders are told; nearly 0 where the slope is infinite.
float flatness(double slope);

/// Bounds each SDF's source over the standard cube of its local frame, at any time, for a device that stores and
/// filters grids like that. Cost: a pass over the grids, on all cores, and for each function some 500 evaluations over
/// boxes.
std::vector<Steepness> source_steepness(const Module& module, TexelFormat format, Filter filter);

}  // namespace dmvv::compiler
