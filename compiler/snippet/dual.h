// Dual numbers: a value and its derivatives by x, y, z and t, carried through arithmetic by the chain rule.
#pragma once

#include <array>
#include <cmath>

namespace dmvv::compiler::snippet {

struct DualNumber {
  double value = 0.0;
  std::array<double, 4> d{};

  DualNumber() = default;
  DualNumber(double v) : value(v) {}  // NOLINT: constants are duals
  DualNumber(double v, const std::array<double, 4>& derivatives) : value(v), d(derivatives) {}
};

/// f(x) with f'(x) = slope. A derivative of 0 stays 0 where the slope is infinite: what does not vary, does not vary.
inline DualNumber chain(double f, double slope, const DualNumber& x) {
  DualNumber out(f);
  for (std::size_t i = 0; i < 4; ++i) out.d[i] = x.d[i] == 0.0 ? 0.0 : slope * x.d[i];
  return out;
}

inline DualNumber chain(double f, double slope_x, const DualNumber& x, double slope_y, const DualNumber& y) {
  const DualNumber by_x = chain(f, slope_x, x), by_y = chain(f, slope_y, y);
  DualNumber out(f);
  for (std::size_t i = 0; i < 4; ++i) out.d[i] = by_x.d[i] + by_y.d[i];
  return out;
}

inline DualNumber operator+(const DualNumber& x, const DualNumber& y) { return chain(x.value + y.value, 1, x, 1, y); }
inline DualNumber operator-(const DualNumber& x, const DualNumber& y) { return chain(x.value - y.value, 1, x, -1, y); }
inline DualNumber operator-(const DualNumber& x) { return chain(-x.value, -1, x); }
inline DualNumber operator*(const DualNumber& x, const DualNumber& y) {
  return chain(x.value * y.value, y.value, x, x.value, y);
}
inline DualNumber operator/(const DualNumber& x, const DualNumber& y) {
  const double q = x.value / y.value;
  return chain(q, 1.0 / y.value, x, -q / y.value, y);
}

inline bool operator<(const DualNumber& x, const DualNumber& y) { return x.value < y.value; }
inline bool operator<=(const DualNumber& x, const DualNumber& y) { return x.value <= y.value; }
inline bool operator==(const DualNumber& x, const DualNumber& y) { return x.value == y.value; }

inline double value_of(const DualNumber& x) { return x.value; }

inline DualNumber abs(const DualNumber& x) { return x.value < 0.0 ? -x : x; }
inline DualNumber floor(const DualNumber& x) { return {std::floor(x.value)}; }
inline DualNumber ceil(const DualNumber& x) { return {std::ceil(x.value)}; }
inline DualNumber trunc(const DualNumber& x) { return {std::trunc(x.value)}; }
inline DualNumber nearbyint(const DualNumber& x) { return {std::nearbyint(x.value)}; }
inline DualNumber sqrt(const DualNumber& x) {
  const double root = std::sqrt(x.value);
  return chain(root, 0.5 / root, x);
}
inline DualNumber exp(const DualNumber& x) { return chain(std::exp(x.value), std::exp(x.value), x); }
inline DualNumber exp2(const DualNumber& x) { return chain(std::exp2(x.value), std::exp2(x.value) * std::log(2.0), x); }
inline DualNumber log(const DualNumber& x) { return chain(std::log(x.value), 1.0 / x.value, x); }
inline DualNumber log2(const DualNumber& x) { return chain(std::log2(x.value), 1.0 / (x.value * std::log(2.0)), x); }
inline DualNumber pow(const DualNumber& x, const DualNumber& y) {
  const double f = std::pow(x.value, y.value);
  const double by_y = f == 0.0 ? 0.0 : f * std::log(x.value);
  return chain(f, y.value * std::pow(x.value, y.value - 1.0), x, by_y, y);
}
inline DualNumber sin(const DualNumber& x) { return chain(std::sin(x.value), std::cos(x.value), x); }
inline DualNumber cos(const DualNumber& x) { return chain(std::cos(x.value), -std::sin(x.value), x); }
inline DualNumber tan(const DualNumber& x) {
  const double f = std::tan(x.value);
  return chain(f, 1.0 + f * f, x);
}
inline DualNumber asin(const DualNumber& x) {
  return chain(std::asin(x.value), 1.0 / std::sqrt(1.0 - x.value * x.value), x);
}
inline DualNumber acos(const DualNumber& x) {
  return chain(std::acos(x.value), -1.0 / std::sqrt(1.0 - x.value * x.value), x);
}
inline DualNumber atan(const DualNumber& x) { return chain(std::atan(x.value), 1.0 / (1.0 + x.value * x.value), x); }
inline DualNumber atan2(const DualNumber& y, const DualNumber& x) {
  const double r2 = x.value * x.value + y.value * y.value;
  return chain(std::atan2(y.value, x.value), x.value / r2, y, -y.value / r2, x);
}
inline DualNumber sinh(const DualNumber& x) { return chain(std::sinh(x.value), std::cosh(x.value), x); }
inline DualNumber cosh(const DualNumber& x) { return chain(std::cosh(x.value), std::sinh(x.value), x); }
inline DualNumber tanh(const DualNumber& x) {
  const double f = std::tanh(x.value);
  return chain(f, 1.0 - f * f, x);
}
inline DualNumber asinh(const DualNumber& x) {
  return chain(std::asinh(x.value), 1.0 / std::sqrt(x.value * x.value + 1.0), x);
}
inline DualNumber acosh(const DualNumber& x) {
  return chain(std::acosh(x.value), 1.0 / std::sqrt(x.value * x.value - 1.0), x);
}
inline DualNumber atanh(const DualNumber& x) { return chain(std::atanh(x.value), 1.0 / (1.0 - x.value * x.value), x); }
inline DualNumber fma(const DualNumber& x, const DualNumber& y, const DualNumber& z) { return x * y + z; }
inline DualNumber ldexp(const DualNumber& x, int exponent) {
  return chain(std::ldexp(x.value, exponent), std::ldexp(1.0, exponent), x);
}
inline DualNumber frexp(const DualNumber& x, int* exponent) {
  const double mantissa = std::frexp(x.value, exponent);
  return chain(mantissa, std::ldexp(1.0, -*exponent), x);
}

}  // namespace dmvv::compiler::snippet
