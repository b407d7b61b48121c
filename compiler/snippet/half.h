// float16, bit by bit: what packHalf2x16 and unpackHalf2x16 need.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace dmvv::compiler::snippet {

/// Rounded to nearest even; beyond 65,504: infinity.
inline std::uint32_t half_bits(double x) {
  const std::uint32_t sign = std::signbit(x) ? 0x8000u : 0u;
  if (std::isnan(x)) return sign | 0x7e00u;
  const double size = std::abs(x);
  if (size >= 65520.0) return sign | 0x7c00u;
  const int exponent = size < 0x1p-14 ? -14 : std::ilogb(size);
  const double steps = std::nearbyint(std::ldexp(size, 10 - exponent));  // of the last place; carries into the exponent
  const auto mantissa = static_cast<std::uint32_t>(steps);
  return sign | (static_cast<std::uint32_t>(exponent + 14) * 1024u + mantissa);
}

inline float half_value(std::uint32_t bits) {
  const float sign = (bits & 0x8000u) != 0 ? -1.0f : 1.0f;
  const int exponent = static_cast<int>(bits >> 10 & 0x1fu);
  const auto mantissa = static_cast<float>(bits & 0x3ffu);
  if (exponent == 31) {
    return mantissa == 0.0f ? sign * std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
  }
  return sign * (exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(mantissa + 1024.0f, exponent - 25));
}

}  // namespace dmvv::compiler::snippet
