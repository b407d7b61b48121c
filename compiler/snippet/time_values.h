// Binding times: which values of a program depend on t alone, and what is left when they are computed beforehand.
// See spec/time.md.
#pragma once

#include <vector>

#include "compiler/snippet/program.h"
#include "compiler/snippet/time_slot.h"

namespace dmvv::compiler::snippet {

/// A register of the residual that is read from time values instead of being computed.
struct Hoisted {
  Type type;
  std::uint32_t first_slot;  ///< a real or bool takes one slot, an integer two: its high 16 bits, and its low ones
};

/// A program in two parts: what depends on t alone, and the rest.
struct TimeSplit {
  Program residual;  ///< register residual.register_count() + k is hoisted[k]; t itself is not read
  std::vector<Hoisted> hoisted;
  Program schedule;  ///< computes the slots; its own `result` means nothing
  std::vector<TimeSlot> slots;
};

/// Hoists the largest subexpressions that depend on t alone and have one value an evaluation (not one a round of a
/// loop). Constants are not hoisted.
/// Cost: linear in the program times the depth of its control flow. At most 512 values are hoisted: a program that
/// wants more gets t alone.
TimeSplit split_time(const Program& program);

}  // namespace dmvv::compiler::snippet
