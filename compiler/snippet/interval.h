// Interval arithmetic over the operations of a program: every result encloses what the operation gives for any members
// of its operands, evaluated in reals, in double, and (IntervalDomain<Rounding::float32>) in float32 on a device.
//
// Bounds are rounded outward by nextafter (correctly rounded operations) or by a few units in the last place (the
// standard library's functions, good to 2). Infinities are members like any other; a NaN is told by maybe_nan. There
// are no empty intervals: where only NaN is possible, some interval is given.
//
// Source: Moore, Kearfott, Cloud 2009, "Introduction to Interval Analysis".
#pragma once

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "compiler/snippet/integer_interval.h"
#include "compiler/snippet/program.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler::snippet {

/// Bound of the error of a float32 operation: relative * |result| + absolute.
struct DeviceError {
  double relative;
  double absolute;
};

/// What a device may get wrong (1 ulp is at most 2^-23 relative); what is not named is exact.
///   V  promised by Vulkan 1.3, appendix A "Vulkan Environment for SPIR-V", "Precision and Operation of SPIR-V
///      Instructions": the tables of core and of GLSL.std.450 instructions
///   O  our own function (device_functions.h), made of what V promises: derived in spec/accuracy.md
///   M  measured, with a margin: V is so lax that nothing could be proven
/// tests/unit/snippet/device_test.cpp holds every row against the device.
constexpr DeviceError device_error(Op op) {
  constexpr double half_ulp = 0x1p-24, ulp = 0x1p-23;
  switch (op) {
    case Op::f_add:
    case Op::f_sub:
    case Op::f_mul:
    case Op::f_fract:
    case Op::f_ldexp:
      return {half_ulp, 0};  // V: correctly rounded
    case Op::f_div:
      return {2.5 * ulp, 0};  // V: for |b| in [2^-126, 2^126]
    case Op::f_inversesqrt:
      return {2 * ulp, 0};  // V
    case Op::f_sqrt:
      return {5 * ulp, 0};  // V: as 1 / inversesqrt
    case Op::f_log:
    case Op::f_log2:
      return {3 * ulp, 0x1p-21};  // V: 3 ulp, in [0.5, 2] 2^-21
    case Op::f_sin:
    case Op::f_cos:
      return {0, 0x1p-21};  // M: 1.6e-7, argument reduction apart (V: 2^-11 in [-pi, pi])
    case Op::f_asin:
    case Op::f_acos:
      return {16 * ulp, 0};  // O
    case Op::f_atan:
    case Op::f_atan2:
      return {8 * ulp, 0};  // O
    case Op::f_tanh:
      return {8 * ulp, 0x1p-21};  // O: cancellation at 0
    case Op::f_asinh:
      return {4 * ulp, 0x1p-19};  // O: likewise
    case Op::f_acosh:
      return {4 * ulp, 0x1p-19};  // O: likewise, at 1
    case Op::f_atanh:
      return {4 * ulp, 0x1p-20};  // V: log((1 + x) / (1 - x)) / 2
    case Op::f_smoothstep:
      return {0, 8 * half_ulp};  // V: the polynomial; its argument is composed
    default:
      return {0, 0};
  }
}

/// As std::fmin, std::fmax and std::nextafter towards an infinity, but for signs of zeros: those are calls of a
/// library, and intervals of large snippets consist of little else.
inline double smaller(double a, double b) { return a < b || b != b ? a : b; }
inline double larger(double a, double b) { return a > b || b != b ? a : b; }
inline double next_up(double x) {
  if (!(x < std::numeric_limits<double>::infinity())) return x;
  const auto bits = std::bit_cast<std::int64_t>(x + 0.0);  // of -0: those of 0
  return std::bit_cast<double>(x < 0.0 ? bits - 1 : bits + 1);
}
inline double next_down(double x) { return -next_up(-x); }

inline constexpr Interval unknown_interval{-std::numeric_limits<double>::infinity(),
                                           std::numeric_limits<double>::infinity(), true};

inline Interval hull(const Interval& a, const Interval& b) {
  return {smaller(a.lo, b.lo), larger(a.hi, b.hi), a.maybe_nan || b.maybe_nan};
}

template <Rounding rounding>
struct IntervalDomain : IntegerIntervalOps {
  using Real = Interval;
  using R = const Interval&;

  static constexpr bool float32 = rounding == Rounding::float32;
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr double pi = std::numbers::pi;
  static constexpr double largest = std::numeric_limits<float>::max();
  static constexpr double denormal = 0x1p-126;  ///< a device may flush what is smaller
  static constexpr double epsilon = 0x1p-52;
  static constexpr double unit = float32 ? 0x1p-23 : epsilon;  ///< one ulp of the coarser arithmetic

  // ---- rounding ----

  /// Zero is the exact zero: sums vanish only exactly, products see to underflow themselves.
  static double down(double x) { return x == 0.0 ? 0.0 : next_down(x); }
  static double up(double x) { return x == 0.0 ? 0.0 : next_up(x); }
  static Interval outward(double lo, double hi, bool nan) { return {down(lo), up(hi), nan}; }
  /// For the standard library's functions.
  static Interval margin(double lo, double hi, bool nan) {
    const auto ulps = [](double x) { return std::isinf(x) ? 0.0 : 4 * epsilon * std::abs(x); };
    return {down(lo - ulps(lo)), up(hi + ulps(hi)), nan};
  }

  /// Adds the error of a device, overflow and flushed denormals to a range of exact results.
  static Interval widen(const Interval& exact, const DeviceError& error) {
    if constexpr (!float32) return exact;
    const auto size = [&](double x) {
      return std::isinf(x) ? 0.0 : error.relative * std::abs(x) + error.absolute + denormal;
    };
    Interval out = outward(exact.lo - size(exact.lo), exact.hi + size(exact.hi), exact.maybe_nan);
    if (error.absolute == 0.0 && exact.lo >= 0.0) out.lo = larger(out.lo, 0.0);
    if (error.absolute == 0.0 && exact.hi <= 0.0) out.hi = smaller(out.hi, 0.0);
    if (out.hi > largest) out.hi = infinity;
    if (out.lo < -largest) out.lo = -infinity;
    out.lo = smaller(out.lo, largest);
    out.hi = larger(out.hi, -largest);
    return out;
  }
  template <Op op>
  static Interval finish(const Interval& exact) {
    return widen(exact, device_error(op));
  }

  /// Results that a device may flush have intervals that hold 0 (see widen); so must what is not computed.
  static Interval flushed(R a) { return float32 && least(a) < denormal ? hull(a, {0.0, 0.0}) : a; }

  /// A number given in double as a float32 of the device.
  static Interval input(R a) { return widen(a, {0x1p-24, 0}); }

  static bool nan(R a) { return a.maybe_nan; }
  static bool nan(R a, R b) { return a.maybe_nan || b.maybe_nan; }
  static bool infinite(R a) { return std::isinf(a.lo) || std::isinf(a.hi); }
  static bool contains(R a, double x) { return a.lo <= x && x <= a.hi; }
  static double size(R a) { return larger(std::abs(a.lo), std::abs(a.hi)); }
  static double least(R a) { return contains(a, 0.0) ? 0.0 : smaller(std::abs(a.lo), std::abs(a.hi)); }
  static Interval whole(bool nan) { return {-infinity, infinity, nan}; }
  static Interval intersect(R a, R b) { return {larger(a.lo, b.lo), smaller(a.hi, b.hi), a.maybe_nan && b.maybe_nan}; }
  /// f is monotonic and never decreases.
  template <class Function>
  static Interval rising(R a, const Function& f) {
    return margin(f(a.lo), f(a.hi), a.maybe_nan);
  }

  // ---- assignments ----
  static Interval f_copy(R a) { return a; }
  static Interval f_select(V c, R a, R b) { return c.is_point() ? (c.lo != 0 ? a : b) : hull(a, b); }

  // ---- arithmetic ----
  static Interval f_add(R a, R b) {
    const bool opposite = (a.hi == infinity && b.lo == -infinity) || (a.lo == -infinity && b.hi == infinity);
    const double lo = a.lo + b.lo, hi = a.hi + b.hi;
    return finish<Op::f_add>(
        outward(std::isnan(lo) ? -infinity : lo, std::isnan(hi) ? infinity : hi, nan(a, b) || opposite));
  }
  static Interval f_neg(R a) { return {-a.hi, -a.lo, a.maybe_nan}; }
  static Interval f_sub(R a, R b) { return f_add(a, f_neg(b)); }

  /// A corner of a product or quotient: 0 times anything is 0, underflow is the smallest number.
  static double corner(double result, bool is_zero) {
    if (is_zero) return 0.0;
    return result == 0.0 ? std::copysign(std::numeric_limits<double>::denorm_min(), result) : result;
  }
  static Interval f_mul(R a, R b) {
    const auto product = [](double x, double y) { return corner(x * y, x == 0.0 || y == 0.0); };
    const auto [lo, hi] =
        std::minmax({product(a.lo, b.lo), product(a.lo, b.hi), product(a.hi, b.lo), product(a.hi, b.hi)});
    const bool zero_by_infinity = (contains(a, 0.0) && infinite(b)) || (contains(b, 0.0) && infinite(a));
    return finish<Op::f_mul>(outward(lo, hi, nan(a, b) || zero_by_infinity));
  }
  /// a * a of one and the same value.
  static Interval square(R a) {
    const Interval magnitude = f_abs(a);
    const auto product = [](double x) { return corner(x * x, x == 0.0); };
    return finish<Op::f_mul>(outward(product(magnitude.lo), product(magnitude.hi), a.maybe_nan));
  }
  static Interval f_div(R a, R b) {
    if (contains(b, 0.0)) return whole(nan(a, b) || contains(a, 0.0) || (infinite(a) && infinite(b)));
    const auto quotient = [](double x, double y) { return corner(x / y, x == 0.0 || std::isinf(y)); };
    const auto [lo, hi] =
        std::minmax({quotient(a.lo, b.lo), quotient(a.lo, b.hi), quotient(a.hi, b.lo), quotient(a.hi, b.hi)});
    Interval out = finish<Op::f_div>(outward(lo, hi, nan(a, b) || (infinite(a) && infinite(b))));
    if (float32 && size(b) > 0x1p126) out = hull(out, {0.0, 0.0});  // as a product with a reciprocal that underflows
    return out;
  }
  static Interval f_fma(R a, R b, R c) { return f_add(f_mul(a, b), c); }  // fused or not

  /// The error of a - b * floor(a / b) when the quotient is a rounded one: it may be off by one next to a whole number.
  static double remainder_error(R a, R b) { return 8 * unit * (size(a) + size(b)); }
  static Interval f_mod(R a, R b) {
    const Interval quotient = f_div(a, b);
    const Interval composed = f_sub(a, f_mul(b, f_floor(quotient)));
    if (infinite(a) || infinite(b) || infinite(quotient) || infinite(composed)) return composed;
    const double error = remainder_error(a, b);
    const Interval range{smaller(b.lo, 0.0) - error, larger(b.hi, 0.0) + error, true};
    return intersect(composed, range);
  }
  static Interval f_rem(R a, R b) {
    const Interval quotient = f_div(a, b);
    const Interval composed = f_sub(a, f_mul(b, f_trunc(quotient)));
    if (infinite(a) || infinite(b) || infinite(quotient) || infinite(composed)) return composed;
    const double error = remainder_error(a, b);
    const Interval range{(a.lo < 0.0 ? -size(b) : 0.0) - error, (a.hi > 0.0 ? size(b) : 0.0) + error, true};
    return intersect(composed, range);
  }

  /// A NaN may be dropped for the other operand, or kept.
  static Interval f_min(R a, R b) {
    Interval out{smaller(a.lo, b.lo), smaller(a.hi, b.hi), nan(a, b)};
    if (a.maybe_nan) out.hi = larger(out.hi, b.hi);
    if (b.maybe_nan) out.hi = larger(out.hi, a.hi);
    return out;
  }
  static Interval f_max(R a, R b) { return f_neg(f_min(f_neg(a), f_neg(b))); }
  static Interval f_abs(R a) {
    if (a.lo >= 0.0) return a;
    return {a.hi <= 0.0 ? -a.hi : 0.0, size(a), a.maybe_nan};
  }
  static double sign(double x) { return double((x > 0.0) - (x < 0.0)); }
  static Interval f_sign(R a) {
    return a.maybe_nan ? Interval{-1.0, 1.0, true} : Interval{sign(a.lo), sign(a.hi), false};
  }
  static Interval f_floor(R a) { return {std::floor(a.lo), std::floor(a.hi), a.maybe_nan}; }
  static Interval f_ceil(R a) { return {std::ceil(a.lo), std::ceil(a.hi), a.maybe_nan}; }
  static Interval f_trunc(R a) { return {std::trunc(a.lo), std::trunc(a.hi), a.maybe_nan}; }
  /// Halves either way.
  static Interval f_round(R a) { return {std::ceil(a.lo - 0.5), std::floor(a.hi + 0.5), a.maybe_nan}; }
  static Interval f_fract(R a) {
    const double base = std::floor(a.lo);
    if (infinite(a) || base != std::floor(a.hi)) return {0.0, 1.0, a.maybe_nan || infinite(a)};
    return finish<Op::f_fract>(outward(a.lo - base, a.hi - base, a.maybe_nan));
  }
  static Interval f_mix(R a, R b, R c) {
    // Of either usual formula.
    const double error =
        4 * unit * (size(a) + size(b)) * (1.0 + size(c)) + (float32 ? denormal * (2.0 + size(c)) : 0.0);
    if (!(error < 1e30)) return whole(true);  // products may overflow
    const Interval composed = f_add(f_mul(a, f_sub({1.0, 1.0}, c)), f_mul(b, c));
    const Interval between = hull(a, b);
    const double beyond = larger(0.0, larger(-c.lo, c.hi - 1.0)) * (size(a) + size(b)) + error;
    return intersect({composed.lo - error, composed.hi + error, composed.maybe_nan},
                     {between.lo - beyond, between.hi + beyond, true});
  }
  static Interval f_smoothstep(R edge0, R edge1, R x) {
    const Interval ratio = f_div(f_sub(x, edge0), f_sub(edge1, edge0));
    const Interval s = f_min(f_max(ratio, {0.0, 0.0}), {1.0, 1.0});
    const auto polynomial = [](double v) { return v * v * (3.0 - 2.0 * v); };
    const Interval exact{polynomial(s.lo) - 8 * epsilon, polynomial(s.hi) + 8 * epsilon, s.maybe_nan};
    Interval out = finish<Op::f_smoothstep>(exact);
    out.lo = larger(out.lo, 0.0);
    return out;
  }

  // ---- roots, exponentials ----
  static Interval f_sqrt(R a) {
    const bool negative = a.lo < 0.0;
    return finish<Op::f_sqrt>(
        outward(std::sqrt(larger(a.lo, 0.0)), std::sqrt(larger(a.hi, 0.0)), a.maybe_nan || negative));
  }
  static Interval f_inversesqrt(R a) {
    if (a.lo <= 0.0) {  // the root of -0 is -0: its inverse may be -inf
      const bool zero = contains(a, 0.0);
      const Interval large{zero ? -infinity : 0.0, infinity, a.maybe_nan || a.lo < 0.0};
      return large;
    }
    return finish<Op::f_inversesqrt>(margin(1.0 / std::sqrt(a.hi), 1.0 / std::sqrt(a.lo), a.maybe_nan));
  }
  /// V: 3 + 2|x| ulp.
  static Interval exponential(R a, double (*f)(double)) {
    Interval exact = rising(a, f);
    exact.lo = larger(exact.lo, 0.0);
    exact.hi = larger(exact.hi, std::numeric_limits<double>::denorm_min());
    const double bounded = smaller(size(a), 1e3);  // beyond, the results are 0 and infinity
    return widen(exact, {(3.0 + 2.0 * bounded) * 0x1p-23, 0.0});
  }
  static Interval f_exp(R a) {
    return exponential(a, [](double x) { return std::exp(x); });
  }
  static Interval f_exp2(R a) {
    return exponential(a, [](double x) { return std::exp2(x); });
  }
  /// A device may give anything for negative numbers, up to the logarithm of their size.
  template <Op op>
  static Interval logarithm(R a, double (*f)(double)) {
    const double lo = a.lo <= 0.0 ? -infinity : f(a.lo);
    double largest_argument = a.lo < 0.0 ? size(a) : a.hi;
    if (float32 && largest_argument < denormal) largest_argument = denormal;  // M: that of a denormal is -127 at least
    const double hi = largest_argument <= 0.0 ? -infinity : f(largest_argument);
    return finish<op>(margin(lo, hi, a.maybe_nan || a.lo < 0.0));
  }
  static Interval f_log(R a) {
    return logarithm<Op::f_log>(a, [](double x) { return std::log(x); });
  }
  static Interval f_log2(R a) {
    return logarithm<Op::f_log2>(a, [](double x) { return std::log2(x); });
  }
  /// As exp2(b * log2(a)): 0^0, inf^0 and 1^inf may be NaN, negative numbers are.
  static Interval f_pow(R a, R b) {
    if (a.lo < 0.0 || (a.lo == 0.0 && b.lo <= 0.0) || infinite(b)) return whole(true);
    const double a_hi = float32 ? larger(a.hi, denormal) : a.hi;  // as for logarithms
    const auto [lo, hi] =
        std::minmax({std::pow(a.lo, b.lo), std::pow(a.lo, b.hi), std::pow(a_hi, b.lo), std::pow(a_hi, b.hi)});
    const bool maybe = nan(a, b) || (std::isinf(a.hi) && contains(b, 0.0));
    Interval exact = margin(lo, hi, maybe);
    exact.lo = larger(exact.lo, 0.0);
    exact.hi = larger(exact.hi, std::numeric_limits<double>::denorm_min());
    const auto exponent = [](double x) {
      return x > 0.0 && std::isfinite(x) ? smaller(std::abs(std::log2(x)), 1e3) : 200.0;
    };
    const double most = larger(exponent(lo), exponent(hi));
    // V: exp2's 3 + 2|x| ulp, and what the rounded log2 and product add to its argument.
    const double argument_error = size(b) * 0x1p-21 + 4.0 * most * 0x1p-23;
    if (!(argument_error < 0.5)) return widen({0.0, infinity, maybe}, {0.0, 0.0});
    return widen(exact, {(3.0 + 2.0 * most) * 0x1p-23 + 2.0 * argument_error, 0.0});
  }

  // ---- trigonometry ----

  /// Is there a whole number k with a.lo <= first + k * period <= a.hi? True when in doubt.
  static bool hits(R a, double first, double period) {
    const double doubt = 4 * epsilon * (size(a) + period);
    return std::floor((a.hi + doubt - first) / period) >= std::ceil((a.lo - doubt - first) / period);
  }
  static Interval wave(R a, double (*f)(double), double maximum, double minimum) {
    if (infinite(a)) return {-infinity, infinity, true};
    if constexpr (float32) {
      if (size(a) > 1e7) return {-infinity, infinity, true};  // M: argument reduction fails
    }
    const double x = f(a.lo), y = f(a.hi);
    const bool far = size(a) > 1e15 || a.hi - a.lo >= 2 * pi;
    Interval exact = margin(far || hits(a, minimum, 2 * pi) ? -1.0 : smaller(x, y),
                            far || hits(a, maximum, 2 * pi) ? 1.0 : larger(x, y), a.maybe_nan);
    exact.lo = larger(exact.lo, -1.0);
    exact.hi = smaller(exact.hi, 1.0);
    DeviceError error = device_error(Op::f_sin);
    error.absolute += 0x1p-24 * size(a);  // of an argument scaled by 1 / 2 pi
    return widen(exact, error);
  }
  static Interval f_sin(R a) {
    return wave(
        a, [](double x) { return std::sin(x); }, pi / 2, -pi / 2);
  }
  static Interval f_cos(R a) {
    return wave(
        a, [](double x) { return std::cos(x); }, 0.0, pi);
  }
  /// A quotient of sine and cosine, whose errors grow with the square of the tangent.
  static Interval f_tan(R a) {
    if (infinite(a) || size(a) > 1e7 || a.hi - a.lo >= pi || hits(a, pi / 2, pi)) return whole(nan(a) || infinite(a));
    const Interval exact = rising(a, [](double x) { return std::tan(x); });
    const double error = float32 ? 0x1p-20 + 0x1p-23 * size(a) : 0.0;
    const double steepest = 1.0 + larger(exact.lo * exact.lo, exact.hi * exact.hi);
    if (error * steepest > 0.05) return whole(nan(a));
    return widen(exact, {0x1p-22, 2.0 * error * steepest});
  }
  static Interval f_asin(R a) {
    const bool outside = a.lo < -1.0 || a.hi > 1.0;
    const Interval inside{std::clamp(a.lo, -1.0, 1.0), std::clamp(a.hi, -1.0, 1.0), a.maybe_nan || outside};
    return finish<Op::f_asin>(rising(inside, [](double x) { return std::asin(x); }));
  }
  static Interval f_acos(R a) {
    const bool outside = a.lo < -1.0 || a.hi > 1.0;
    const double lo = std::acos(std::clamp(a.hi, -1.0, 1.0)), hi = std::acos(std::clamp(a.lo, -1.0, 1.0));
    return finish<Op::f_acos>(margin(lo, hi, a.maybe_nan || outside));
  }
  static Interval f_atan(R a) {
    return finish<Op::f_atan>(rising(a, [](double x) { return std::atan(x); }));
  }
  /// Extreme angles of a box that does not touch the negative x axis are at its corners.
  static Interval f_atan2(R y, R x) {
    const Interval turn{-pi - 1e-15, pi + 1e-15, nan(x, y) || infinite(x) || infinite(y)};
    // Numbers that a device may flush to 0 have any angle.
    const bool flushed = float32 && least(x) < denormal && least(y) < denormal;
    if (infinite(x) || infinite(y) || flushed || (x.lo <= 0.0 && contains(y, 0.0))) return finish<Op::f_atan2>(turn);
    const auto [lo, hi] =
        std::minmax({std::atan2(y.lo, x.lo), std::atan2(y.lo, x.hi), std::atan2(y.hi, x.lo), std::atan2(y.hi, x.hi)});
    return finish<Op::f_atan2>(margin(lo, hi, nan(x, y)));
  }

  // ---- hyperbolic: made of exp and log ----
  static Interval hyperbolic(const Interval& exact, R a) {
    const double bounded = smaller(size(a), 1e3);
    Interval out = widen(exact, {(8.0 + 4.0 * bounded) * 0x1p-23, 8 * 0x1p-23});
    if (float32 && out.hi > largest / 4) out.hi = infinity;  // exp overflows before its half does
    if (float32 && out.lo < -largest / 4) out.lo = -infinity;
    return out;
  }
  static Interval f_sinh(R a) {
    return hyperbolic(rising(a, [](double x) { return std::sinh(x); }), a);
  }
  static Interval f_cosh(R a) {
    const Interval magnitude = f_abs(a);
    return hyperbolic(rising(magnitude, [](double x) { return std::cosh(x); }), a);
  }
  static Interval f_tanh(R a) {
    return finish<Op::f_tanh>(rising(a, [](double x) { return std::tanh(x); }));
  }
  static Interval f_asinh(R a) {
    const Interval exact = rising(a, [](double x) { return std::asinh(x); });
    return float32 && size(a) > 1e18 ? whole(nan(a)) : finish<Op::f_asinh>(exact);  // the square overflows
  }
  static Interval f_acosh(R a) {
    const Interval inside{larger(a.lo, 1.0), larger(a.hi, 1.0), a.maybe_nan || a.lo < 1.0};
    const Interval exact = rising(inside, [](double x) { return std::acosh(x); });
    return float32 && size(a) > 1e18 ? whole(true) : finish<Op::f_acosh>(exact);
  }
  static Interval f_atanh(R a) {
    const bool outside = a.lo < -1.0 || a.hi > 1.0;
    const Interval inside{std::clamp(a.lo, -1.0, 1.0), std::clamp(a.hi, -1.0, 1.0), a.maybe_nan || outside};
    Interval exact = rising(inside, [](double x) { return std::atanh(x); });
    if (float32) {  // a device may come to what a neighbour of the pole has: SwiftShader's atanh(-1) is -44
      const double beside_pole = std::atanh(1.0 - 0x1p-24);
      if (a.lo <= -1.0) exact.hi = larger(exact.hi, -beside_pole);
      if (a.hi >= 1.0) exact.lo = smaller(exact.lo, beside_pole);
    }
    return finish<Op::f_atanh>(exact);
  }

  // ---- exponents ----
  static Interval f_ldexp(R a, V b) {
    if (infinite(a) || (float32 && b.hi > 128)) return whole(true);  // GLSL: undefined
    const auto scaled = [](double x, std::int64_t exponent) {
      return corner(std::ldexp(x, static_cast<int>(std::clamp<std::int64_t>(exponent, -10000, 10000))), x == 0.0);
    };
    const auto [lo, hi] = std::minmax({scaled(a.lo, b.lo), scaled(a.lo, b.hi), scaled(a.hi, b.lo), scaled(a.hi, b.hi)});
    const Interval out = finish<Op::f_ldexp>(outward(lo, hi, a.maybe_nan));
    return float32 && b.lo < -126 ? hull(out, {0.0, 0.0}) : out;  // GLSL: may be flushed
  }
  static Interval f_frexp_mantissa(R a) {
    if (infinite(a)) return whole(true);
    return {a.lo > 0.0 ? 0.5 : -1.0, a.hi < 0.0 ? -0.5 : 1.0, a.maybe_nan};
  }
  static IntegerInterval i_frexp_exponent(R a) {
    if (infinite(a) || a.maybe_nan) return any_int;
    const auto exponent = [](double x) { return x == 0.0 ? std::int64_t{0} : std::int64_t{std::ilogb(x)} + 1; };
    const Interval magnitude = f_abs(a);
    if (magnitude.lo > 0.0) return {exponent(magnitude.lo), exponent(magnitude.hi)};
    return {-1080, std::max<std::int64_t>(exponent(magnitude.hi), 0)};
  }

  // ---- comparisons: false for NaN ----
  static IntegerInterval f_lt(R a, R b) { return decided(a.hi < b.lo && !nan(a, b), a.lo < b.hi); }
  static IntegerInterval f_le(R a, R b) { return decided(a.hi <= b.lo && !nan(a, b), a.lo <= b.hi); }
  static IntegerInterval f_eq(R a, R b) {
    const bool same = a.lo == a.hi && b.lo == b.hi && a.lo == b.lo;
    return decided(same && !nan(a, b), a.lo <= b.hi && b.lo <= a.hi);
  }
  static IntegerInterval f_ne(R a, R b) { return b_not(f_eq(a, b)); }
  static IntegerInterval f_isnan(R a) { return decided(false, a.maybe_nan); }
  static IntegerInterval f_isinf(R a) { return decided(false, infinite(a)); }

  // ---- conversions: what is out of range or NaN is any value on a device ----
  static Interval f_from_i(V a) {
    const Interval exact{static_cast<double>(a.lo), static_cast<double>(a.hi)};
    return size(exact) <= 0x1p24 ? exact : widen(exact, {0x1p-23, 0.0});
  }
  static Interval f_from_u(V a) { return f_from_i(a); }
  static IntegerInterval whole_part(R a, const IntegerInterval& range) {
    const double lo = std::trunc(a.lo), hi = std::trunc(a.hi);
    if (a.maybe_nan || !(lo >= static_cast<double>(range.lo) && hi <= static_cast<double>(range.hi))) return range;
    return {static_cast<std::int64_t>(lo), static_cast<std::int64_t>(hi)};
  }
  static IntegerInterval i_from_f(R a) { return whole_part(a, any_int); }
  static IntegerInterval u_from_f(R a) { return whole_part(a, any_uint); }

  // ---- bits: of positive floats they rise with the value ----
  static Interval f_from_bits(V a) {
    if (a.hi >= 0x7f800000 && !(a.is_point() && std::isfinite(std::bit_cast<float>(uint_of(a))))) return whole(true);
    const auto value = [](std::int64_t bits) { return double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))}; };
    return widen({value(a.lo), value(a.hi)}, {0.0, 0.0});
  }
  static IntegerInterval u_from_float_bits(R a) {
    if (a.maybe_nan || !(a.lo > 0.0)) return any_uint;
    const auto bits = [](double x) { return std::int64_t{std::bit_cast<std::uint32_t>(static_cast<float>(x))}; };
    return {bits(a.lo), bits(a.hi)};
  }
  static IntegerInterval u_pack_half(R a) {  // a device may round toward zero
    if (a.maybe_nan || !(a.lo > 0.0)) return {0, 0xffff};
    return {std::max<std::int64_t>(std::int64_t{half_bits(a.lo)} - 1, 0), std::int64_t{half_bits(a.hi)}};
  }
  static Interval f_unpack_half(V a) {
    if (a.hi >= 0x7c00 && !(a.is_point() && std::isfinite(half_value(uint_of(a))))) return whole(true);
    return {double{half_value(uint_of(point(a.lo)))}, double{half_value(uint_of(point(a.hi)))}};
  }
};

}  // namespace dmvv::compiler::snippet
