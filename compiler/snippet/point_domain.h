// The operations over points: float, double or dual numbers for reals, 32 bits for integers.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "compiler/snippet/dual.h"
#include "compiler/snippet/half.h"

namespace dmvv::compiler::snippet {

inline double value_of(double x) { return x; }

/// Integer operations; shared by all domains whose integers are points.
struct IntegerOps {
  using Integer = std::uint32_t;
  using Signed = std::int32_t;
  using Unsigned = std::uint32_t;
  using Boolean = bool;
  using I = Signed;
  using U = Unsigned;
  using B = Boolean;

  static I wrap(U x) { return static_cast<I>(x); }
  static U bits(I x) { return static_cast<U>(x); }

  static I i_copy(I a) { return a; }
  static U u_copy(U a) { return a; }
  static B b_copy(B a) { return a; }
  static I i_select(B c, I a, I b) { return c ? a : b; }
  static U u_select(B c, U a, U b) { return c ? a : b; }
  static B b_select(B c, B a, B b) { return c ? a : b; }

  static I i_from_u(U a) { return wrap(a); }
  static U u_from_i(I a) { return bits(a); }

  static I i_add(I a, I b) { return wrap(bits(a) + bits(b)); }
  static I i_sub(I a, I b) { return wrap(bits(a) - bits(b)); }
  static I i_mul(I a, I b) { return wrap(bits(a) * bits(b)); }
  static I i_div(I a, I b) { return b == 0 ? -1 : b == -1 ? i_neg(a) : a / b; }
  static I i_rem(I a, I b) { return b == 0 || b == -1 ? 0 : a % b; }
  static I i_mod(I a, I b) {
    const I r = i_rem(a, b);
    return r != 0 && (r < 0) != (b < 0) ? r + b : r;
  }
  static I i_neg(I a) { return wrap(0u - bits(a)); }
  static I i_abs(I a) { return a < 0 ? i_neg(a) : a; }
  static I i_sign(I a) { return (a > 0) - (a < 0); }
  static I i_min(I a, I b) { return a < b ? a : b; }
  static I i_max(I a, I b) { return a < b ? b : a; }
  static I i_shr(I a, U b) { return a >> (b & 31u); }
  static I i_mul_high(I a, I b) { return static_cast<I>((std::int64_t{a} * b) >> 32); }
  static I i_find_msb(I a) { return u_find_msb(a < 0 ? ~bits(a) : bits(a)); }
  static B i_eq(I a, I b) { return a == b; }
  static B i_ne(I a, I b) { return a != b; }
  static B i_lt(I a, I b) { return a < b; }
  static B i_le(I a, I b) { return a <= b; }

  static U u_add(U a, U b) { return a + b; }
  static U u_sub(U a, U b) { return a - b; }
  static U u_mul(U a, U b) { return a * b; }
  static U u_div(U a, U b) { return b == 0 ? ~0u : a / b; }
  static U u_mod(U a, U b) { return b == 0 ? ~0u : a % b; }
  static U u_min(U a, U b) { return a < b ? a : b; }
  static U u_max(U a, U b) { return a < b ? b : a; }
  static U u_and(U a, U b) { return a & b; }
  static U u_or(U a, U b) { return a | b; }
  static U u_xor(U a, U b) { return a ^ b; }
  static U u_not(U a) { return ~a; }
  static U u_shl(U a, U b) { return a << (b & 31u); }
  static U u_shr(U a, U b) { return a >> (b & 31u); }
  static U u_mul_high(U a, U b) { return static_cast<U>((std::uint64_t{a} * b) >> 32); }
  static I u_bit_count(U a) { return std::popcount(a); }
  static U u_reverse(U a) {
    U out = 0;
    for (int i = 0; i < 32; ++i) out |= (a >> i & 1u) << (31 - i);
    return out;
  }
  static I u_find_lsb(U a) { return a == 0 ? -1 : std::countr_zero(a); }
  static I u_find_msb(U a) { return 31 - std::countl_zero(a); }
  static B u_eq(U a, U b) { return a == b; }
  static B u_ne(U a, U b) { return a != b; }
  static B u_lt(U a, U b) { return a < b; }
  static B u_le(U a, U b) { return a <= b; }

  static B b_and(B a, B b) { return a && b; }
  static B b_or(B a, B b) { return a || b; }
  static B b_xor(B a, B b) { return a != b; }
  static B b_not(B a) { return !a; }
};

inline std::int32_t saturated_int(double x) {
  if (std::isnan(x)) return 0;
  return static_cast<std::int32_t>(std::fmin(std::fmax(x, -0x1p31), 0x1p31 - 1.0));
}
inline std::uint32_t saturated_uint(double x) {
  if (std::isnan(x)) return 0;
  return static_cast<std::uint32_t>(std::fmin(std::fmax(x, 0.0), 0x1p32 - 1.0));
}

/// T: float, double or DualNumber. The mathematical functions of the standard library, and of dual.h by lookup.
template <class T>
struct PointDomain : IntegerOps {
  using Real = T;

  static T nan() { return T(std::numeric_limits<double>::quiet_NaN()); }
  static double value(const T& x) { return value_of(x); }
  static bool isnan(const T& x) { return std::isnan(value(x)); }

  static T f_copy(const T& a) { return a; }
  static T f_select(B c, const T& a, const T& b) { return c ? a : b; }
  static T f_add(const T& a, const T& b) { return a + b; }
  static T f_sub(const T& a, const T& b) { return a - b; }
  static T f_mul(const T& a, const T& b) { return a * b; }
  static T f_div(const T& a, const T& b) { return a / b; }
  static T f_neg(const T& a) { return -a; }
  static T f_fma(const T& a, const T& b, const T& c) {
    using std::fma;
    return fma(a, b, c);
  }
  static T f_mod(const T& a, const T& b) {
    using std::floor;
    return a - b * floor(a / b);
  }
  static T f_rem(const T& a, const T& b) {
    using std::trunc;
    return a - b * trunc(a / b);
  }
  static T f_min(const T& a, const T& b) { return isnan(a) || b < a ? b : a; }
  static T f_max(const T& a, const T& b) { return isnan(a) || a < b ? b : a; }
  static T f_abs(const T& a) {
    using std::abs;
    return abs(a);
  }
  static T f_sign(const T& a) { return T(double((value(a) > 0.0) - (value(a) < 0.0))); }
  static T f_floor(const T& a) {
    using std::floor;
    return floor(a);
  }
  static T f_ceil(const T& a) {
    using std::ceil;
    return ceil(a);
  }
  static T f_trunc(const T& a) {
    using std::trunc;
    return trunc(a);
  }
  static T f_round(const T& a) {
    using std::nearbyint;
    return nearbyint(a);
  }
  static T f_fract(const T& a) {
    using std::floor;
    return a - floor(a);
  }
  static T f_sqrt(const T& a) {
    using std::sqrt;
    return sqrt(a);
  }
  static T f_inversesqrt(const T& a) {
    using std::sqrt;
    return T(1.0) / sqrt(a);
  }
  static T f_exp(const T& a) {
    using std::exp;
    return exp(a);
  }
  static T f_exp2(const T& a) {
    using std::exp2;
    return exp2(a);
  }
  static T f_log(const T& a) {
    using std::log;
    return log(a);
  }
  static T f_log2(const T& a) {
    using std::log2;
    return log2(a);
  }
  static T f_pow(const T& a, const T& b) {
    using std::pow;
    return value(a) < 0.0 ? nan() : pow(a, b);
  }
  static T f_sin(const T& a) {
    using std::sin;
    return sin(a);
  }
  static T f_cos(const T& a) {
    using std::cos;
    return cos(a);
  }
  static T f_tan(const T& a) {
    using std::tan;
    return tan(a);
  }
  static T f_asin(const T& a) {
    using std::asin;
    return asin(a);
  }
  static T f_acos(const T& a) {
    using std::acos;
    return acos(a);
  }
  static T f_atan(const T& a) {
    using std::atan;
    return atan(a);
  }
  static T f_atan2(const T& a, const T& b) {
    using std::atan2;
    return atan2(a, b);
  }
  static T f_sinh(const T& a) {
    using std::sinh;
    return sinh(a);
  }
  static T f_cosh(const T& a) {
    using std::cosh;
    return cosh(a);
  }
  static T f_tanh(const T& a) {
    using std::tanh;
    return tanh(a);
  }
  static T f_asinh(const T& a) {
    using std::asinh;
    return asinh(a);
  }
  static T f_acosh(const T& a) {
    using std::acosh;
    return acosh(a);
  }
  static T f_atanh(const T& a) {
    using std::atanh;
    return atanh(a);
  }
  static T f_mix(const T& a, const T& b, const T& c) { return a * (T(1.0) - c) + b * c; }
  static T f_smoothstep(const T& edge0, const T& edge1, const T& x) {
    const T s = f_min(f_max((x - edge0) / (edge1 - edge0), T(0.0)), T(1.0));
    return s * s * (T(3.0) - T(2.0) * s);
  }
  static T f_ldexp(const T& a, I b) {
    using std::ldexp;
    return ldexp(a, b);
  }
  static T f_frexp_mantissa(const T& a) {
    using std::frexp;
    int exponent = 0;
    return frexp(a, &exponent);
  }
  static I i_frexp_exponent(const T& a) {
    int exponent = 0;
    std::frexp(value(a), &exponent);
    return std::isfinite(value(a)) ? exponent : 0;
  }

  static B f_eq(const T& a, const T& b) { return a == b; }
  static B f_ne(const T& a, const T& b) { return !(a == b); }
  static B f_lt(const T& a, const T& b) { return a < b; }
  static B f_le(const T& a, const T& b) { return a <= b; }
  static B f_isnan(const T& a) { return isnan(a); }
  static B f_isinf(const T& a) { return std::isinf(value(a)); }

  static T f_from_i(I a) { return T(static_cast<double>(a)); }
  static T f_from_u(U a) { return T(static_cast<double>(a)); }
  static I i_from_f(const T& a) { return saturated_int(value(a)); }
  static U u_from_f(const T& a) { return saturated_uint(value(a)); }
  static T f_from_bits(U a) { return T(static_cast<double>(std::bit_cast<float>(a))); }
  static U u_from_float_bits(const T& a) { return std::bit_cast<U>(static_cast<float>(value(a))); }
  static U u_pack_half(const T& a) { return half_bits(value(a)); }
  static T f_unpack_half(U a) { return T(static_cast<double>(half_value(a))); }
};

}  // namespace dmvv::compiler::snippet
