// A device value holds both what the slots hold, rounded to float32, and the double that they stand for.
#include "compiler/snippet/device_values.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "compiler/snippet/interval.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr double float_unit = 0x1p-24, double_unit = 0x1p-53, smallest_normal = 0x1p-126;

double size(const Interval& a) { return std::max(std::abs(a.lo), std::abs(a.hi)); }

Interval widened(const Interval& a, double by) { return {a.lo - by, a.hi + by, a.maybe_nan}; }

/// What a period leaves of an interval of values: moved by whole periods, so that it begins within half of one of 0.
/// The device's value may be a whole period from the one here: the sums it enters round as much coarser.
Interval reduced(const Interval& value, Period period) {
  if (period == Period::none || !(size(value) > reduced_beyond) || !std::isfinite(size(value))) return value;
  const double length = period == Period::turn ? 2.0 * std::numbers::pi : 1.0;
  if (value.hi - value.lo >= length) return {-length, length, value.maybe_nan};
  const double lo = reduce(value.lo, period);
  // Of values on both sides of the limit some are left as they are, large.
  const bool some_stay = std::min(std::abs(value.lo), std::abs(value.hi)) <= reduced_beyond;
  const double coarser = float_unit * ((some_stay ? reduced_beyond : 0.0) + 2.0 * length);
  return widened({lo, lo + (value.hi - value.lo), value.maybe_nan}, coarser + 4.0 * double_unit * size(value));
}

/// A slot as a device reads it, and the double that it stands for.
Interval slot_values(const TimeSlot& slot, const Interval& t_ms) {
  const std::array<Interval, Program::input_count> inputs{Interval{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, t_ms};
  if (t_ms.lo != t_ms.hi) {
    const Interval value = reduced(evaluate_box(slot.program, inputs, Rounding::real), slot.period);
    return widened(value, float_unit * size(value) + smallest_normal);
  }
  const double exact = evaluate_point<double>(slot.program, {0.0, 0.0, 0.0, t_ms.lo}).f;
  if (std::isnan(exact)) return unknown_interval;
  const double value = reduce(exact, slot.period), device = static_cast<float>(value);
  if (!std::isfinite(device)) return {std::min(value, device), std::max(value, device), true};
  // The reference adds what was not reduced, and rounds it.
  const double apart = value == exact ? 0.0 : 4.0 * double_unit * std::abs(exact);
  return widened({std::min(value, device), std::max(value, device)}, apart);
}

std::int64_t whole(double x) { return std::llround(std::clamp(x, -0x1p33, 0x1p33)); }

/// From its halves of 16 bits. What does not fit the type is any value of it.
IntegerInterval joined(const Interval& high, const Interval& low, const IntegerInterval& type) {
  if (high.maybe_nan || low.maybe_nan) return type;
  const bool one_high = whole(high.lo) == whole(high.hi);
  const IntegerInterval value{whole(high.lo) * 65536 + (one_high ? whole(low.lo) : 0),
                              whole(high.hi) * 65536 + (one_high ? whole(low.hi) : 65535)};
  return value.lo < type.lo || value.hi > type.hi ? type : value;
}

}  // namespace

std::vector<BoxValue> device_values(const TimeSplit& split, const Interval& t_ms) {
  std::vector<BoxValue> values;
  values.reserve(split.hoisted.size());
  for (const Hoisted& hoisted : split.hoisted) {
    const auto slot = [&](std::uint32_t k) { return slot_values(split.slots[hoisted.first_slot + k], t_ms); };
    BoxValue value;
    switch (hoisted.type) {
      case Type::real:
        value.f = slot(0);
        break;
      case Type::boolean: {
        const Interval bit = slot(0);
        value.i =
            bit.maybe_nan ? IntegerIntervalOps::any_bool : IntegerInterval{bit.lo > 0.5 ? 1 : 0, bit.hi < 0.5 ? 0 : 1};
        break;
      }
      case Type::integer:
        value.i = joined(slot(0), slot(1), IntegerIntervalOps::any_int);
        break;
      case Type::unsigned_integer:
        value.i = joined(slot(0), slot(1), IntegerIntervalOps::any_uint);
        break;
    }
    values.push_back(value);
  }
  return values;
}

}  // namespace dmvv::compiler::snippet
