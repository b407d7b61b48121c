// How steep the operations of a program are: a range of values, a Lipschitz bound by the point p, and a bound of the
// float32 error, carried through arithmetic by the chain rule. What jumps, or is not understood, is infinitely steep.
//
// Lengths are the reason for more than one bound: the root of a sum of squares has no bounded derivative by the sum,
// but |v(p)| is no steeper than v. So a sum of squares remembers the Jacobian of v as J^T J (its Gram matrix).
#pragma once

#include <array>
#include <cstdint>

#include "compiler/snippet/interval.h"

namespace dmvv::compiler::snippet {

/// A value over a box.
struct Steep {
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  /// A value as a sum of squares of v: J^T J (xx, yy, zz, xy, xz, yz), and the sum of the squares of v's errors.
  struct Squares {
    std::array<Interval, 6> gram{};
    double error = 0.0;
    int terms = 0;  ///< 0: it is no such sum
  };

  Interval v{0.0, 0.0};
  double slope = 0.0;  ///< |f(p) - f(q)| <= slope * |p - q|
  double error = 0.0;  ///< of float32 evaluation, p itself being exact
  std::array<Interval, 3> gradient{Interval{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
  Squares squares;
  std::uint64_t identity = next_identity();  ///< of copies the same; of any others not, whatever their bounds are

  Steep() = default;
  /// A constant; what is not bounded is unknown.
  Steep(const Interval& value) : v(value) {  // NOLINT: constants are values
    if (value.maybe_nan || !std::isfinite(value.lo) || !std::isfinite(value.hi)) forget();
  }

  void forget() {
    slope = error = infinity;
    gradient.fill({-infinity, infinity});
    squares = {};
  }

 private:
  static std::uint64_t next_identity() {
    thread_local std::uint64_t last = 0;
    return ++last;
  }
};

/// Joins two ways to the same place: the value jumps between them unless it is the same.
inline Steep hull(const Steep& a, const Steep& b) {
  const bool is_constant =
      a.v.lo == a.v.hi && a.v == b.v && a.slope == 0.0 && b.slope == 0.0 && a.error == 0.0 && b.error == 0.0;
  if (a.identity == b.identity || is_constant) return a;
  Steep out(hull(a.v, b.v));
  out.forget();
  return out;
}

/// The domain of Steep (machine.h).
struct SteepDomain : IntegerIntervalOps {
  using Real = Steep;
  using R = const Steep&;
  using Range = IntervalDomain<Rounding::float32>;
  using Exact = IntervalDomain<Rounding::real>;
  static constexpr double infinity = Steep::infinity;
  static constexpr DeviceError none{0.0, 0.0};

  static Steep flushed(R a) { return Range::flushed(a.v); }
  /// A coordinate of the point, or the time (which no residual reads).
  static Steep coordinate(const Interval& range, std::size_t axis) {
    Steep out(range);
    if (axis >= 3) return out;
    out.slope = 1.0;
    out.gradient[axis] = {1.0, 1.0};
    return out;
  }

  // ---- the chain rule ----

  static double size(const Interval& a) { return Range::size(a); }
  static double length(const std::array<Interval, 3>& g) {
    return std::sqrt(size(g[0]) * size(g[0]) + size(g[1]) * size(g[1]) + size(g[2]) * size(g[2])) * (1.0 + 0x1p-40);
  }
  static double product(double a, double b) { return a == 0.0 || b == 0.0 ? 0.0 : a * b; }

  static Steep finish(Steep out, const DeviceError& device) {
    out.error += device.relative * size(out.v) + device.absolute + Range::denormal;
    out.slope = smaller(out.slope, length(out.gradient));
    const bool is_known = !out.v.maybe_nan && std::isfinite(out.v.lo) && std::isfinite(out.v.hi) &&
                          std::isfinite(out.slope) && std::isfinite(out.error);
    if (!is_known) out.forget();
    return out;
  }
  /// f(a, b) with its partial derivatives.
  static Steep chain(const Interval& f, const Interval& by_a, R a, const Interval& by_b, R b,
                     const DeviceError& device) {
    Steep out;
    out.v = f;
    out.slope = (product(size(by_a), a.slope) + product(size(by_b), b.slope)) * (1.0 + 0x1p-40);
    out.error = product(size(by_a), a.error) + product(size(by_b), b.error);
    for (std::size_t i = 0; i < 3; ++i) {
      out.gradient[i] = Exact::f_add(Exact::f_mul(by_a, a.gradient[i]), Exact::f_mul(by_b, b.gradient[i]));
    }
    return finish(out, device);
  }
  static Steep chain(const Interval& f, const Interval& slope, R a, const DeviceError& device) {
    return chain(f, slope, a, {0.0, 0.0}, Steep(), device);
  }
  /// What does not change but in jumps.
  static Steep steps(const Interval& f) {
    Steep out(f);
    if (f.lo != f.hi) out.forget();
    return out;
  }
  /// What has no rule here.
  static Steep unknown(const Interval& f) { return steps(f); }
  static bool is_constant(R a) { return a.slope == 0.0; }

  // ---- assignments ----
  static Steep f_copy(R a) { return a; }
  static Steep f_select(V c, R a, R b) { return c.is_point() ? (c.lo != 0 ? a : b) : hull(a, b); }

  // ---- arithmetic ----
  static constexpr Interval one{1.0, 1.0}, minus_one{-1.0, -1.0};
  static Steep f_add(R a, R b) {
    Steep out = chain(Range::f_add(a.v, b.v), one, a, one, b, device_error(Op::f_add));
    if (a.squares.terms != 0 && b.squares.terms != 0) {
      for (std::size_t i = 0; i < 6; ++i) out.squares.gram[i] = Exact::f_add(a.squares.gram[i], b.squares.gram[i]);
      out.squares.error = a.squares.error + b.squares.error;
      out.squares.terms = a.squares.terms + b.squares.terms;
    }
    return out;
  }
  static Steep f_sub(R a, R b) { return chain(Range::f_sub(a.v, b.v), one, a, minus_one, b, device_error(Op::f_sub)); }
  static Steep f_neg(R a) { return chain(Range::f_neg(a.v), minus_one, a, none); }
  static Steep f_mul(R a, R b) { return chain(Range::f_mul(a.v, b.v), b.v, a, a.v, b, device_error(Op::f_mul)); }
  static Steep square(R a) {
    Steep out = chain(Range::square(a.v), Exact::f_add(a.v, a.v), a, device_error(Op::f_mul));
    if (!std::isfinite(a.slope)) return out;
    const auto& g = a.gradient;
    out.squares = Steep::Squares{{Exact::square(g[0]), Exact::square(g[1]), Exact::square(g[2]),
                                  Exact::f_mul(g[0], g[1]), Exact::f_mul(g[0], g[2]), Exact::f_mul(g[1], g[2])},
                                 a.error * a.error,
                                 1};
    return out;
  }
  static Steep f_div(R a, R b) {
    const Interval quotient = Range::f_div(a.v, b.v), inverse = Exact::f_div(one, b.v);
    return chain(quotient, inverse, a, Exact::f_neg(Exact::f_mul(quotient, inverse)), b, device_error(Op::f_div));
  }
  static Steep f_fma(R a, R b, R c) { return f_add(f_mul(a, b), c); }
  /// Where the quotient's whole part is one and the same.
  static Steep f_mod(R a, R b) {
    return remainder(Range::f_mod(a.v, b.v), Range::f_floor(Range::f_div(a.v, b.v)), a, b);
  }
  static Steep f_rem(R a, R b) {
    return remainder(Range::f_rem(a.v, b.v), Range::f_trunc(Range::f_div(a.v, b.v)), a, b);
  }
  static Steep remainder(const Interval& f, const Interval& whole, R a, R b) {
    if (whole.lo != whole.hi) return unknown(f);
    return chain(f, one, a, Exact::f_neg(whole), b, {0.0, Range::remainder_error(a.v, b.v)});
  }

  /// A minimum is no steeper than the steeper one; its gradient is that of either.
  static Steep either(const Interval& f, R a, R b) {
    Steep out;
    out.v = f;
    out.slope = larger(a.slope, b.slope);
    out.error = larger(a.error, b.error);
    for (std::size_t i = 0; i < 3; ++i) out.gradient[i] = hull(a.gradient[i], b.gradient[i]);
    return finish(out, none);
  }
  static Steep f_min(R a, R b) { return either(Range::f_min(a.v, b.v), a, b); }
  static Steep f_max(R a, R b) { return either(Range::f_max(a.v, b.v), a, b); }
  static Steep f_abs(R a) {
    const Interval sign{a.v.lo > 0.0 ? 1.0 : -1.0, a.v.hi < 0.0 ? -1.0 : 1.0};
    return chain(Range::f_abs(a.v), sign, a, none);
  }
  static Steep f_sign(R a) { return steps(Range::f_sign(a.v)); }
  static Steep f_floor(R a) { return steps(Range::f_floor(a.v)); }
  static Steep f_ceil(R a) { return steps(Range::f_ceil(a.v)); }
  static Steep f_trunc(R a) { return steps(Range::f_trunc(a.v)); }
  static Steep f_round(R a) { return steps(Range::f_round(a.v)); }
  static Steep f_fract(R a) {
    const Interval f = Range::f_fract(a.v), whole = Range::f_floor(a.v);
    return whole.lo == whole.hi ? chain(f, one, a, device_error(Op::f_fract)) : unknown(f);
  }
  static Steep f_mix(R a, R b, R c) {
    const Interval f = Range::f_mix(a.v, b.v, c.v);
    Steep out = f_add(f_mul(a, f_sub(one, c)), f_mul(b, c));
    const Steep of_difference = f_add(a, f_mul(f_sub(b, a), c));  // tighter where a and b change alike
    if (of_difference.slope < out.slope) out = of_difference;
    out.v = f;
    out.error += 8 * 0x1p-24 * (size(a.v) + size(b.v)) * (1.0 + size(c.v));  // either formula
    out.squares = {};
    return finish(out, none);
  }
  static Steep f_smoothstep(R edge0, R edge1, R x) {
    const Interval f = Range::f_smoothstep(edge0.v, edge1.v, x.v);
    if (!is_constant(edge0) || !is_constant(edge1)) return unknown(f);
    const Steep ratio = f_div(f_sub(x, edge0), f_sub(edge1, edge0));
    return chain(f, {0.0, 1.5}, either(Range::f_min(Range::f_max(ratio.v, {0.0, 0.0}), one), ratio, Steep()),
                 device_error(Op::f_smoothstep));
  }

  // ---- roots, exponentials ----

  /// A bound of the largest eigenvalue (Gershgorin).
  static double largest_eigenvalue(const std::array<Interval, 6>& m) {
    const double xy = size(m[3]), xz = size(m[4]), yz = size(m[5]);
    return larger(size(m[0]) + xy + xz, larger(size(m[1]) + xy + yz, size(m[2]) + xz + yz));
  }
  static Steep f_sqrt(R a) {
    const Interval f = Range::f_sqrt(a.v);
    if (a.squares.terms == 0) return chain(f, Exact::f_div({0.5, 0.5}, f), a, device_error(Op::f_sqrt));
    Steep out;
    out.v = {larger(0.0, f.lo), f.hi};
    out.slope = std::sqrt(largest_eigenvalue(a.squares.gram)) * (1.0 + 0x1p-40);
    out.error = std::sqrt(a.squares.error) + (a.squares.terms + 2) * 0x1p-24 * size(f) + 0x1p-60;
    out.gradient.fill({-out.slope, out.slope});
    return finish(out, device_error(Op::f_sqrt));
  }
  static Steep f_inversesqrt(R a) {
    const Interval f = Range::f_inversesqrt(a.v);
    const Interval cubed = Exact::f_mul(Exact::square(f), f);
    return chain(f, Exact::f_mul({-0.5, -0.5}, cubed), a, device_error(Op::f_inversesqrt));
  }
  static DeviceError exponential_error(R a) { return {(3.0 + 2.0 * smaller(size(a.v), 1e3)) * 0x1p-23, 0.0}; }
  static Steep f_exp(R a) {
    const Interval f = Range::f_exp(a.v);
    return chain(f, f, a, exponential_error(a));
  }
  static Steep f_exp2(R a) {
    const Interval f = Range::f_exp2(a.v);
    return chain(f, Exact::f_mul(f, {std::numbers::ln2, std::numbers::ln2}), a, exponential_error(a));
  }
  static Steep f_log(R a) { return chain(Range::f_log(a.v), Exact::f_div(one, a.v), a, device_error(Op::f_log)); }
  static Steep f_log2(R a) {
    const Interval scaled = Exact::f_div({1.0 / std::numbers::ln2, 1.0 / std::numbers::ln2}, a.v);
    return chain(Range::f_log2(a.v), scaled, a, device_error(Op::f_log2));
  }
  /// By a constant exponent; the error is that of the range's own margin.
  static Steep f_pow(R a, R b) {
    const Interval f = Range::f_pow(a.v, b.v), real = Exact::f_pow(a.v, b.v);
    if (!is_constant(b)) return unknown(f);
    const double margin = larger(real.lo - f.lo, f.hi - real.hi);
    const Interval slope = Exact::f_mul(b.v, Exact::f_pow(a.v, Exact::f_sub(b.v, one)));
    return chain(f, slope, a, {0.0, larger(margin, 0.0) + size(f) * 0x1p-18});
  }

  // ---- trigonometry ----
  static DeviceError wave_error(R a) { return {0.0, device_error(Op::f_sin).absolute + 0x1p-24 * size(a.v)}; }
  static Steep f_sin(R a) { return chain(Range::f_sin(a.v), Exact::f_cos(a.v), a, wave_error(a)); }
  static Steep f_cos(R a) { return chain(Range::f_cos(a.v), Exact::f_neg(Exact::f_sin(a.v)), a, wave_error(a)); }
  static Steep f_atan(R a) {
    const Interval slope = Exact::f_div(one, Exact::f_add(one, Exact::square(a.v)));
    return chain(Range::f_atan(a.v), slope, a, device_error(Op::f_atan));
  }
  /// Away from the origin and from the negative x axis, where it jumps.
  static Steep f_atan2(R y, R x) {
    const Interval f = Range::f_atan2(y.v, x.v);
    if (x.v.lo <= 0.0 && Range::contains(y.v, 0.0)) return unknown(f);
    const Interval r2 = Exact::f_add(Exact::square(x.v), Exact::square(y.v));
    return chain(f, Exact::f_div(x.v, r2), y, Exact::f_neg(Exact::f_div(y.v, r2)), x, device_error(Op::f_atan2));
  }
  static Steep f_tanh(R a) {
    const Interval f = Range::f_tanh(a.v);
    return chain(f, {0.0, 1.0}, a, device_error(Op::f_tanh));
  }
  static Steep f_tan(R a) { return unknown(Range::f_tan(a.v)); }
  static Steep f_asin(R a) { return unknown(Range::f_asin(a.v)); }
  static Steep f_acos(R a) { return unknown(Range::f_acos(a.v)); }
  static Steep f_sinh(R a) { return unknown(Range::f_sinh(a.v)); }
  static Steep f_cosh(R a) { return unknown(Range::f_cosh(a.v)); }
  static Steep f_asinh(R a) { return unknown(Range::f_asinh(a.v)); }
  static Steep f_acosh(R a) { return unknown(Range::f_acosh(a.v)); }
  static Steep f_atanh(R a) { return unknown(Range::f_atanh(a.v)); }

  // ---- exponents, comparisons, conversions, bits ----
  static Steep f_ldexp(R a, V b) { return unknown(Range::f_ldexp(a.v, b)); }
  static Steep f_frexp_mantissa(R a) { return unknown(Range::f_frexp_mantissa(a.v)); }
  static IntegerInterval i_frexp_exponent(R a) { return Range::i_frexp_exponent(a.v); }
  static IntegerInterval f_lt(R a, R b) { return Range::f_lt(a.v, b.v); }
  static IntegerInterval f_le(R a, R b) { return Range::f_le(a.v, b.v); }
  static IntegerInterval f_eq(R a, R b) { return Range::f_eq(a.v, b.v); }
  static IntegerInterval f_ne(R a, R b) { return Range::f_ne(a.v, b.v); }
  static IntegerInterval f_isnan(R a) { return Range::f_isnan(a.v); }
  static IntegerInterval f_isinf(R a) { return Range::f_isinf(a.v); }
  static Steep f_from_i(V a) { return steps(Range::f_from_i(a)); }
  static Steep f_from_u(V a) { return steps(Range::f_from_u(a)); }
  static IntegerInterval i_from_f(R a) { return Range::i_from_f(a.v); }
  static IntegerInterval u_from_f(R a) { return Range::u_from_f(a.v); }
  static Steep f_from_bits(V a) { return steps(Range::f_from_bits(a)); }
  static IntegerInterval u_from_float_bits(R a) { return Range::u_from_float_bits(a.v); }
  static IntegerInterval u_pack_half(R a) { return Range::u_pack_half(a.v); }
  static Steep f_unpack_half(V a) { return steps(Range::f_unpack_half(a)); }
};

}  // namespace dmvv::compiler::snippet
