// What depends on time alone is computed on the CPU, once a frame, and read by shaders as floats (spec/time.md).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

/// A time value may be reduced where only its remainder matters: as a summand of the argument of a periodic function.
enum class Period : std::uint8_t {
  none,
  turn,  ///< 2 pi: sin, cos, tan
  one,   ///< 1: fract
};

/// Beyond it a time value is reduced by its period. Below, reducing could lose more than it wins: with |b| > 256 the
/// error of float32 a + b exceeds that of a + (b mod 2 pi) for every |a| <= 126.
inline constexpr double reduced_beyond = 256.0;

/// What a period leaves of a value: its remainder, in [-pi, pi] or [0, 1); the value itself where its size is no more
/// than reduced_beyond, where it is not finite, and without a period.
double reduce(double value, Period period);

/// One float that depends on time alone: how it is computed.
struct TimeSlot {
  Register result;  ///< real; of the schedule that the slot is part of (time_values.h)
  Period period;
  Program program;  ///< the part of the schedule that computes it, as its result
};

/// The values of slots at a time: computed in double, rounded once. Cost: the slots' instructions.
std::vector<float> time_values(std::span<const TimeSlot> slots, double t_ms);

}  // namespace dmvv::compiler::snippet
