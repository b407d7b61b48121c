// Time values are computed in double and reduced by their periods before they are rounded.
#include "compiler/snippet/time_slot.h"

#include <cmath>

#include "compiler/snippet/evaluate.h"

namespace dmvv::compiler::snippet {

/// atan2 of sine and cosine rather than a remainder by a rounded 2 pi: the library reduces huge arguments exactly.
double reduce(double value, Period period) {
  if (period == Period::none || !(std::abs(value) > reduced_beyond) || !std::isfinite(value)) return value;
  if (period == Period::one) return value - std::floor(value);
  return std::atan2(std::sin(value), std::cos(value));
}

std::vector<float> time_values(std::span<const TimeSlot> slots, double t_ms) {
  std::vector<float> values;
  values.reserve(slots.size());
  for (const TimeSlot& slot : slots) {
    values.push_back(
        static_cast<float>(reduce(evaluate_point<double>(slot.program, {0.0, 0.0, 0.0, t_ms}).f, slot.period)));
  }
  return values;
}

}  // namespace dmvv::compiler::snippet
