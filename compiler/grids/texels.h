// How the samples of a distance grid are stored in texels, and which values a shader reads back.
#pragma once

#include <cstddef>
#include <vector>

#include "compiler/grids/storage.h"
#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// The value that a normalised format stores as 1, for each grid of a module; 1 in float formats.
///
/// A boundary passes only between samples near it: samples farther from every iso value in use than the samples around
/// one point can differ are cut off there. This leaves each boundary where it is (spec/accuracy.md) and makes the steps
/// of the format as fine as they can be.
/// Cost: one pass over the samples.
std::vector<double> texel_scales(const Module& module, TexelFormat format, Filter filter);

bool is_normalised(TexelFormat format);

/// Writes bytes_per_texel(format) bytes: the nearest value the format has, beyond its range the outermost.
void store_texel(float value, TexelFormat format, double scale, std::byte* out);

/// The grid with every sample as a shader reads it back, times scale.
voml::Grid as_stored(const voml::Grid& grid, TexelFormat format, double scale);

}  // namespace dmvv::compiler
