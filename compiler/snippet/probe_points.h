// Inside compiler: where snippets are tried.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace dmvv::compiler::snippet {

/// Points of the standard cube: its centre, its corners, and 64 that fill it evenly (Halton, bases 2, 3, 5).
const std::vector<glm::dvec3>& probe_points();

/// Times in milliseconds: the start, a frame, a second, a minute, an hour; the start alone where time has no effect.
const std::vector<double>& probe_times(bool uses_time);

/// "p = (0, 0.5, -1)", and the time if it has an effect.
std::string describe(const glm::dvec3& p, double t_ms, bool uses_time);

/// Element `index` (from 1) of the van der Corput sequence in this base: 0..1.
double radical_inverse(std::uint32_t index, std::uint32_t base);

}  // namespace dmvv::compiler::snippet
