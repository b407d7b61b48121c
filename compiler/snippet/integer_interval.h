// Closed intervals of int32, uint32 and bool (0 to 1), kept in 64 bits. What wraps around as a whole stays an interval;
// what may wrap around in part is the whole range.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "compiler/snippet/point_domain.h"

namespace dmvv::compiler::snippet {

struct IntegerInterval {
  std::int64_t lo = 0;
  std::int64_t hi = 0;
  bool is_point() const { return lo == hi; }
};

inline IntegerInterval hull(const IntegerInterval& a, const IntegerInterval& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

struct IntegerIntervalOps {
  using Integer = IntegerInterval;
  using Signed = IntegerInterval;
  using Unsigned = IntegerInterval;
  using Boolean = IntegerInterval;
  using V = const IntegerInterval&;
  using Points = IntegerOps;

  static constexpr IntegerInterval any_int{std::numeric_limits<std::int32_t>::min(),
                                           std::numeric_limits<std::int32_t>::max()};
  static constexpr IntegerInterval any_uint{0, std::numeric_limits<std::uint32_t>::max()};
  static constexpr IntegerInterval any_bool{0, 1};

  /// The low 32 bits of everything from lo to hi.
  static IntegerInterval within(const IntegerInterval& range, std::int64_t lo, std::int64_t hi) {
    const std::int64_t wrapped = (lo - range.lo) & ~std::int64_t{0xffffffff};
    return hi - wrapped > range.hi ? range : IntegerInterval{lo - wrapped, hi - wrapped};
  }
  static IntegerInterval as_int(std::int64_t lo, std::int64_t hi) { return within(any_int, lo, hi); }
  static IntegerInterval as_uint(std::int64_t lo, std::int64_t hi) { return within(any_uint, lo, hi); }
  static IntegerInterval point(std::int64_t value) { return {value, value}; }
  static bool contains(V a, std::int64_t value) { return a.lo <= value && value <= a.hi; }
  static std::int32_t int_of(V a) { return static_cast<std::int32_t>(a.lo); }
  static std::uint32_t uint_of(V a) { return static_cast<std::uint32_t>(a.lo); }
  static IntegerInterval decided(bool surely, bool possibly) { return {surely ? 1 : 0, possibly ? 1 : 0}; }

  /// The hull of f at the four corners: for functions that are monotonic in each operand.
  template <class Function>
  static IntegerInterval corners(V a, V b, const Function& f) {
    const auto [lo, hi] = std::minmax({f(a.lo, b.lo), f(a.lo, b.hi), f(a.hi, b.lo), f(a.hi, b.hi)});
    return {lo, hi};
  }

  static IntegerInterval i_copy(V a) { return a; }
  static IntegerInterval u_copy(V a) { return a; }
  static IntegerInterval b_copy(V a) { return a; }
  static IntegerInterval i_select(V c, V a, V b) { return c.is_point() ? (c.lo != 0 ? a : b) : hull(a, b); }
  static IntegerInterval u_select(V c, V a, V b) { return i_select(c, a, b); }
  static IntegerInterval b_select(V c, V a, V b) { return i_select(c, a, b); }

  static IntegerInterval i_from_u(V a) {
    if (a.hi <= any_int.hi) return a;
    return a.lo > any_int.hi ? IntegerInterval{a.lo - (std::int64_t{1} << 32), a.hi - (std::int64_t{1} << 32)}
                             : any_int;
  }
  static IntegerInterval u_from_i(V a) {
    if (a.lo >= 0) return a;
    return a.hi < 0 ? IntegerInterval{a.lo + (std::int64_t{1} << 32), a.hi + (std::int64_t{1} << 32)} : any_uint;
  }

  // ---- comparisons ----
  static IntegerInterval i_eq(V a, V b) {
    return decided(a.is_point() && b.is_point() && a.lo == b.lo, a.lo <= b.hi && b.lo <= a.hi);
  }
  static IntegerInterval i_ne(V a, V b) { return b_not(i_eq(a, b)); }
  static IntegerInterval i_lt(V a, V b) { return decided(a.hi < b.lo, a.lo < b.hi); }
  static IntegerInterval i_le(V a, V b) { return decided(a.hi <= b.lo, a.lo <= b.hi); }
  static IntegerInterval u_eq(V a, V b) { return i_eq(a, b); }
  static IntegerInterval u_ne(V a, V b) { return i_ne(a, b); }
  static IntegerInterval u_lt(V a, V b) { return i_lt(a, b); }
  static IntegerInterval u_le(V a, V b) { return i_le(a, b); }

  // ---- int ----
  static IntegerInterval i_add(V a, V b) { return as_int(a.lo + b.lo, a.hi + b.hi); }
  static IntegerInterval i_sub(V a, V b) { return as_int(a.lo - b.hi, a.hi - b.lo); }
  static IntegerInterval i_mul(V a, V b) {
    const IntegerInterval product = corners(a, b, [](std::int64_t x, std::int64_t y) { return x * y; });
    return as_int(product.lo, product.hi);
  }
  static IntegerInterval i_div(V a, V b) {
    if (contains(b, 0)) return any_int;
    const IntegerInterval quotient = corners(a, b, [](std::int64_t x, std::int64_t y) { return x / y; });
    return quotient.hi > any_int.hi ? any_int : quotient;  // the least integer by -1: undefined
  }
  static IntegerInterval i_rem(V a, V b) {
    if (contains(b, 0)) return any_int;
    if (a.is_point() && b.is_point()) return point(a.lo % b.lo);
    const std::int64_t most = std::max(std::abs(b.lo), std::abs(b.hi)) - 1;
    const std::int64_t least = std::min(std::abs(b.lo), std::abs(b.hi));
    if (a.lo >= 0 && a.hi < least) return a;
    return {a.lo < 0 ? std::max(-most, a.lo) : 0, a.hi > 0 ? std::min(most, a.hi) : 0};
  }
  static IntegerInterval i_mod(V a, V b) {
    if (contains(b, 0)) return any_int;
    if (a.is_point() && b.is_point()) return point(Points::i_mod(int_of(a), int_of(b)));
    if (b.lo > 0) return a.lo >= 0 ? i_rem(a, b) : IntegerInterval{0, b.hi - 1};
    return {b.lo + 1, 0};
  }
  static IntegerInterval i_neg(V a) { return as_int(-a.hi, -a.lo); }
  static IntegerInterval i_abs(V a) {
    if (a.lo >= 0) return a;
    const IntegerInterval negated = i_neg(a);
    return a.hi <= 0 || negated.lo == any_int.lo ? negated : IntegerInterval{0, std::max(-a.lo, a.hi)};
  }
  static IntegerInterval i_sign(V a) { return {(a.lo > 0) - (a.lo < 0), (a.hi > 0) - (a.hi < 0)}; }
  static IntegerInterval i_min(V a, V b) { return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)}; }
  static IntegerInterval i_max(V a, V b) { return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)}; }
  static IntegerInterval i_shr(V a, V b) {
    if (b.hi > 31) return any_int;
    return corners(a, b, [](std::int64_t x, std::int64_t y) { return x >> y; });
  }
  static IntegerInterval i_mul_high(V a, V b) {
    return corners(a, b, [](std::int64_t x, std::int64_t y) { return (x * y) >> 32; });
  }
  static IntegerInterval i_find_msb(V a) {
    if (a.is_point()) return point(Points::i_find_msb(int_of(a)));
    return a.lo >= 0 ? u_find_msb(a) : IntegerInterval{-1, 31};
  }

  // ---- uint ----
  static IntegerInterval u_add(V a, V b) { return as_uint(a.lo + b.lo, a.hi + b.hi); }
  static IntegerInterval u_sub(V a, V b) {
    if (a.is_point() && b.is_point()) return point(uint_of(a) - uint_of(b));
    return as_uint(a.lo - b.hi, a.hi - b.lo);
  }
  static IntegerInterval u_mul(V a, V b) {
    if (a.is_point() && b.is_point()) return point(uint_of(a) * uint_of(b));
    const std::uint64_t most = static_cast<std::uint64_t>(a.hi) * static_cast<std::uint64_t>(b.hi);
    return most > static_cast<std::uint64_t>(any_uint.hi)
               ? any_uint
               : IntegerInterval{a.lo * b.lo, static_cast<std::int64_t>(most)};
  }
  static IntegerInterval u_div(V a, V b) {
    return contains(b, 0) ? any_uint : IntegerInterval{a.lo / b.hi, a.hi / b.lo};
  }
  static IntegerInterval u_mod(V a, V b) { return contains(b, 0) ? any_uint : i_rem(a, b); }
  static IntegerInterval u_min(V a, V b) { return i_min(a, b); }
  static IntegerInterval u_max(V a, V b) { return i_max(a, b); }
  /// All bits up to the highest that a or b may have.
  static std::int64_t mask(V a, V b) {
    return static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(std::max(a.hi, b.hi)) + 1) - 1);
  }
  static IntegerInterval u_and(V a, V b) {
    return a.is_point() && b.is_point() ? point(a.lo & b.lo) : IntegerInterval{0, std::min(a.hi, b.hi)};
  }
  static IntegerInterval u_or(V a, V b) {
    return a.is_point() && b.is_point() ? point(a.lo | b.lo) : IntegerInterval{std::max(a.lo, b.lo), mask(a, b)};
  }
  static IntegerInterval u_xor(V a, V b) {
    return a.is_point() && b.is_point() ? point(a.lo ^ b.lo) : IntegerInterval{0, mask(a, b)};
  }
  static IntegerInterval u_not(V a) { return {any_uint.hi - a.hi, any_uint.hi - a.lo}; }
  static IntegerInterval u_shl(V a, V b) {
    if (b.hi > 31) return any_uint;
    if (a.is_point() && b.is_point()) return point(uint_of(a) << b.lo);
    return as_uint(a.lo << b.lo, a.hi << b.hi);
  }
  static IntegerInterval u_shr(V a, V b) { return b.hi > 31 ? any_uint : IntegerInterval{a.lo >> b.hi, a.hi >> b.lo}; }
  static IntegerInterval u_mul_high(V a, V b) {
    const auto high = [](std::int64_t x, std::int64_t y) {
      return static_cast<std::int64_t>((static_cast<std::uint64_t>(x) * static_cast<std::uint64_t>(y)) >> 32);
    };
    return {high(a.lo, b.lo), high(a.hi, b.hi)};
  }
  static IntegerInterval u_bit_count(V a) {
    return a.is_point() ? point(std::popcount(uint_of(a))) : IntegerInterval{0, 32};
  }
  static IntegerInterval u_reverse(V a) { return a.is_point() ? point(Points::u_reverse(uint_of(a))) : any_uint; }
  static IntegerInterval u_find_lsb(V a) {
    return a.is_point() ? point(Points::u_find_lsb(uint_of(a))) : IntegerInterval{-1, 31};
  }
  static IntegerInterval u_find_msb(V a) {
    return {Points::u_find_msb(static_cast<std::uint32_t>(a.lo)), Points::u_find_msb(static_cast<std::uint32_t>(a.hi))};
  }

  // ---- bool ----
  static IntegerInterval b_and(V a, V b) { return {a.lo & b.lo, a.hi & b.hi}; }
  static IntegerInterval b_or(V a, V b) { return {a.lo | b.lo, a.hi | b.hi}; }
  static IntegerInterval b_xor(V a, V b) { return a.is_point() && b.is_point() ? point(a.lo ^ b.lo) : any_bool; }
  static IntegerInterval b_not(V a) { return {1 - a.hi, 1 - a.lo}; }
};

}  // namespace dmvv::compiler::snippet
