#include "compiler/snippet/straight_line.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "compiler/snippet/interval.h"
#include "compiler/snippet/machine.h"
#include "compiler/snippet/point_domain.h"

namespace dmvv::compiler::snippet {

namespace {

using Bounds = IntervalDomain<Rounding::float32>;

constexpr std::uint32_t no_step = ~0u;

/// Steps that reach the last one, renumbered.
StraightLine without_unused(const std::vector<Step>& steps, std::uint32_t result) {
  std::vector<bool> used(steps.size(), false);
  used[result] = true;
  std::size_t count = 0;
  for (std::uint32_t k = result + 1; k-- > 0;) {
    if (!used[k]) continue;
    ++count;
    for (std::uint32_t i = 0; i < operand_count(steps[k]); ++i) used[steps[k].operands[i]] = true;
  }
  StraightLine line;
  line.steps.reserve(count);
  std::vector<std::uint32_t> number(steps.size(), no_step);
  for (std::uint32_t k = 0; k <= result; ++k) {
    if (!used[k]) continue;
    Step step = steps[k];
    for (std::uint32_t i = 0; i < operand_count(step); ++i) step.operands[i] = number[step.operands[i]];
    number[k] = static_cast<std::uint32_t>(line.steps.size());
    line.steps.push_back(step);
  }
  return line;
}

float real_of(const Step& constant) { return std::bit_cast<float>(constant.operands[0]); }

}  // namespace

// ---- values over a box ----

void evaluate_steps(const StraightLine& line, const Box& box, std::span<const BoxValue> hoisted,
                    std::vector<BoxValue>& values) {
  thread_local std::vector<Cell<Bounds>> cells;
  cells.resize(line.steps.size());
  for (std::uint32_t k = 0; k < line.steps.size(); ++k) {
    const Step& step = line.steps[k];
    Cell<Bounds>& cell = cells[k];
    cell = {{0.0, 0.0}, {0, 0}};
    switch (step.kind) {
      case Step::Kind::point: {
        const auto axis = static_cast<int>(step.operands[0]);
        cell.f = Bounds::input({box.lo[axis], box.hi[axis]});
        break;
      }
      case Step::Kind::constant: {
        const float value = real_of(step);
        const std::int64_t whole = step.type == Type::integer
                                       ? std::int64_t{static_cast<std::int32_t>(step.operands[0])}
                                       : std::int64_t{step.operands[0]};
        if (step.type != Type::real) cell.i = {whole, whole};
        if (step.type == Type::real) cell.f = std::isnan(value) ? unknown_interval : Bounds::flushed({value, value});
        break;
      }
      case Step::Kind::hoisted:
        cell = {Bounds::flushed(hoisted[step.operands[0]].f), hoisted[step.operands[0]].i};
        break;
      case Step::Kind::operation:
        if (step.op == Op::f_mul && step.operands[0] == step.operands[1]) {
          cell.f = Bounds::square(cells[step.operands[0]].f);
        } else {
          execute<Bounds>({step.op, k, {step.operands[0], step.operands[1], step.operands[2]}}, cells.data());
        }
        break;
    }
  }
  values.resize(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k) values[k] = {cells[k].f, cells[k].i};
}

template <class Real>
Real evaluate_at(const StraightLine& line, const std::array<Real, 3>& p, std::span<const BoxValue> hoisted) {
  using Domain = PointDomain<Real>;
  std::vector<Cell<Domain>> cells(line.steps.size());
  for (std::uint32_t k = 0; k < line.steps.size(); ++k) {
    const Step& step = line.steps[k];
    switch (step.kind) {
      case Step::Kind::point:
        cells[k].f = p[step.operands[0]];
        break;
      case Step::Kind::constant:
        cells[k].f = static_cast<Real>(real_of(step));
        cells[k].i = step.operands[0];
        break;
      case Step::Kind::hoisted:
        cells[k].f = static_cast<Real>(hoisted[step.operands[0]].f.lo);
        cells[k].i = static_cast<std::uint32_t>(hoisted[step.operands[0]].i.lo);
        break;
      case Step::Kind::operation:
        execute<Domain>({step.op, k, {step.operands[0], step.operands[1], step.operands[2]}}, cells.data());
        break;
    }
  }
  return cells.back().f;
}
template float evaluate_at<float>(const StraightLine&, const std::array<float, 3>&, std::span<const BoxValue>);
template double evaluate_at<double>(const StraightLine&, const std::array<double, 3>&, std::span<const BoxValue>);

// ---- shortening ----

namespace {

/// Goes through the steps with the numbers of what stands for each of them: an earlier one, itself, or a constant.
class Shortener {
 public:
  Shortener(const StraightLine& line, std::span<const BoxValue> values)
      : steps_(line.steps), values_(values), stands_for_(line.steps.size()) {}

  StraightLine run() {
    for (std::uint32_t k = 0; k < steps_.size(); ++k) {
      Step& step = steps_[k];
      for (std::uint32_t i = 0; i < operand_count(step); ++i) step.operands[i] = stands_for_[step.operands[i]];
      stands_for_[k] = k;
      if (step.kind != Step::Kind::operation) continue;
      if (step.type != Type::real && values_[k].i.is_point()) {
        become_constant(step, static_cast<std::uint32_t>(values_[k].i.lo));
      } else if (const std::uint32_t same = same_as(step); same != no_step) {
        stands_for_[k] = same;
      } else if (step.type == Type::real) {
        fold(step);
      }
    }
    return without_unused(steps_, stands_for_.back());
  }

 private:
  const Interval& real(std::uint32_t step) const { return values_[step].f; }
  bool is_constant(std::uint32_t step) const { return steps_[step].kind == Step::Kind::constant; }
  /// Of exactly these bits: 0.0 is not -0.0.
  bool is_real(std::uint32_t step, float value) const {
    return is_constant(step) && steps_[step].type == Type::real &&
           steps_[step].operands[0] == std::bit_cast<std::uint32_t>(value);
  }
  bool may_be_zero(std::uint32_t step) const { return Bounds::contains(real(step), 0.0); }
  bool is_finite(std::uint32_t step) const { return !real(step).maybe_nan && !Bounds::infinite(real(step)); }

  static void become_constant(Step& step, std::uint32_t bits) {
    step.kind = Step::Kind::constant;
    step.operands = {bits, 0, 0};
  }

  /// The operand that the result surely is.
  std::uint32_t same_as(const Step& step) const {
    const auto [a, b, c] = step.operands;
    switch (step.op) {
      case Op::f_min:
        return less(a, b) || a == b ? a : less(b, a) ? b : no_step;
      case Op::f_max:
        return less(a, b) || a == b ? b : less(b, a) ? a : no_step;
      case Op::f_abs:
        return real(a).lo > 0.0 && !real(a).maybe_nan ? a : no_step;
      case Op::f_add:
        return adds_nothing(b, a) ? a : adds_nothing(a, b) ? b : no_step;
      case Op::f_sub:
        return adds_nothing(b, a) ? a : no_step;
      case Op::f_mul:
        if (is_real(b, 1.0f)) return a;
        if (is_real(a, 1.0f)) return b;
        return becomes_zero(a, b) ? a : becomes_zero(b, a) ? b : no_step;
      case Op::f_mix:  // a * (1 - c) + b * c
        if (!is_finite(a) || !is_finite(b) || (zero_shows_ && (may_be_zero(a) || may_be_zero(b)))) return no_step;
        return is_real(c, 0.0f) ? a : is_real(c, 1.0f) ? b : no_step;
      default:
        if (!is_choice(step.op)) return no_step;
        if (b == c) return b;
        return is_constant(a) ? (steps_[a].operands[0] != 0 ? b : c) : no_step;
    }
  }

  /// Surely, whatever a device makes of the two; a NaN is on neither side.
  bool less(std::uint32_t a, std::uint32_t b) const {
    return real(a).hi < real(b).lo && !real(a).maybe_nan && !real(b).maybe_nan;
  }

  /// x + zero and x - zero are x, but that a zero may change its sign.
  bool adds_nothing(std::uint32_t zero, std::uint32_t x) const {
    return (is_real(zero, 0.0f) || is_real(zero, -0.0f)) && (!zero_shows_ || !may_be_zero(x));
  }

  /// zero * x is zero, but for its sign.
  bool becomes_zero(std::uint32_t zero, std::uint32_t x) const {
    return is_real(zero, 0.0f) && is_finite(x) && !zero_shows_;
  }

  /// Operations that every device rounds correctly, on constants; 0 divided by anything.
  void fold(Step& step) const {
    const std::uint32_t count = operand_count(step);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!is_constant(step.operands[i]) || steps_[step.operands[i]].type != Type::real) return;
    }
    const float a = real_of(steps_[step.operands[0]]), b = count > 1 ? real_of(steps_[step.operands[1]]) : 0.0f;
    std::optional<float> value;
    if (step.op == Op::f_add) value = a + b;
    if (step.op == Op::f_sub) value = a - b;
    if (step.op == Op::f_mul) value = a * b;
    if (step.op == Op::f_neg) value = -a;
    if (step.op == Op::f_abs) value = std::abs(a);
    if (step.op == Op::f_div && a == 0.0f) value = a / b;
    const auto plain = [](float x) { return x == 0.0f || std::isnormal(x); };  // nothing that a device may flush
    if (value && plain(a) && plain(b) && plain(*value)) become_constant(step, std::bit_cast<std::uint32_t>(*value));
  }

  /// Can the sign of a zero show in anything but a sign of a zero? Where an operation divides by what may be 0, or
  /// takes bits or angles of it.
  bool shows_zeros() const {
    return std::ranges::any_of(steps_, [&](const Step& step) {
      if (step.kind != Step::Kind::operation) return false;
      switch (step.op) {
        case Op::f_div:
        case Op::f_mod:
        case Op::f_rem:
          return may_be_zero(step.operands[1]);
        case Op::f_atan2:
          return may_be_zero(step.operands[0]) || may_be_zero(step.operands[1]);
        case Op::f_inversesqrt:
        case Op::f_pow:
        case Op::u_from_float_bits:
        case Op::u_pack_half:
          return may_be_zero(step.operands[0]);
        default:
          return false;
      }
    });
  }

  std::vector<Step> steps_;
  std::span<const BoxValue> values_;
  std::vector<std::uint32_t> stands_for_;
  bool zero_shows_ = shows_zeros();
};

}  // namespace

StraightLine shorten(const StraightLine& line, std::span<const BoxValue> values) {
  return Shortener(line, values).run();
}

}  // namespace dmvv::compiler::snippet
