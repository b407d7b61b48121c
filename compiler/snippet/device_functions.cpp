// The polynomials are minimax fits (Remez 1934) of (atan(x)/x - 1)/x^2 on [0, 1] and (asin(x)/x - 1)/x^2 on [0, 1/2],
// in x^2, weighted by relative error, rounded to float32: 1.7e-8 and 5e-9 off. What rounding adds to them, given the
// precision that Vulkan asks of +, -, *, /, sqrt, exp and log, is derived in spec/accuracy.md.
#include "compiler/snippet/device_functions.h"

#include <algorithm>
#include <array>

namespace dmvv::compiler::snippet {

namespace {

/// `@` stands for the prefix. mix with a condition is a choice without a branch.
constexpr std::string_view atan_unit =
    R"(float @atan_unit(float a) {
  float z = a * a;
  float s = 0.0029280973;
  s = s * z - 0.016398609;
  s = s * z + 0.04326382;
  s = s * z - 0.075568326;
  s = s * z + 0.10668301;
  s = s * z - 0.14211681;
  s = s * z + 0.19993858;
  s = s * z - 0.33333156;
  return a + a * (z * s);
}
)";

constexpr std::string_view atan_one =
    R"(float @atan(float x) {
  float a = abs(x);
  float s = @atan_unit(min(a, 1.0) / max(a, 1.0));
  s = mix(s, 1.5707964 - s, a > 1.0);
  return mix(s, -s, x < 0.0);
}
)";

constexpr std::string_view atan_two =
    R"(float @atan2(float y, float x) {
  float a = abs(x), b = abs(y), c = max(a, b);
  float s = @atan_unit(mix(min(a, b) / c, 0.0, c == 0.0));
  s = mix(s, 1.5707964 - s, b > a);
  s = mix(s, 3.1415927 - s, x < 0.0);
  return mix(s, -s, y < 0.0);
}
)";

/// asin(|x|), or half of acos(|x|) where |x| > 1/2. sqrt gives NaN beyond 1.
constexpr std::string_view asin_part =
    R"(float @asin_part(float a) {
  float z = mix(a * a, 0.5 - 0.5 * a, a > 0.5);
  float b = mix(a, sqrt(z), a > 0.5);
  float s = 0.042093623;
  s = s * z + 0.024226768;
  s = s * z + 0.04545955;
  s = s * z + 0.07495399;
  s = s * z + 0.1666675;
  return b + b * (z * s);
}
)";

constexpr std::string_view asin_one =
    R"(float @asin(float x) {
  float a = abs(x);
  float s = @asin_part(a);
  s = mix(s, 1.5707964 - 2.0 * s, a > 0.5);
  return mix(s, -s, x < 0.0);
}
)";

constexpr std::string_view acos_one =
    R"(float @acos(float x) {
  float a = abs(x);
  float s = @asin_part(a);
  float near_one = mix(2.0 * s, 3.1415927 - 2.0 * s, x < 0.0);
  float near_zero = 1.5707964 - mix(s, -s, x < 0.0);
  return mix(near_zero, near_one, a > 0.5);
}
)";

/// exp of what is not positive neither overflows nor loses.
constexpr std::string_view tanh_one =
    R"(float @tanh(float x) {
  float e = exp(-2.0 * abs(x));
  float s = (1.0 - e) / (1.0 + e);
  return mix(s, -s, x < 0.0);
}
)";

/// The logarithm of |x| + ..., for x + sqrt(x * x + 1) of a negative x is a difference of neighbours.
constexpr std::string_view asinh_one =
    R"(float @asinh(float x) {
  float a = abs(x);
  float s = log(a + sqrt(a * a + 1.0));
  return mix(s, -s, x < 0.0);
}
)";

/// From x - 1, which is exact near 1, where x * x - 1 is not.
constexpr std::string_view acosh_one =
    R"(float @acosh(float x) {
  float y = x - 1.0;
  return log(1.0 + (y + sqrt(y * (y + 2.0))));
}
)";

struct DeviceFunction {
  Op op;
  std::string_view needs;  ///< what it calls
  std::string_view text;
};

constexpr std::array functions = {
    DeviceFunction{Op::f_atan, atan_unit, atan_one}, DeviceFunction{Op::f_atan2, atan_unit, atan_two},
    DeviceFunction{Op::f_asin, asin_part, asin_one}, DeviceFunction{Op::f_acos, asin_part, acos_one},
    DeviceFunction{Op::f_tanh, {}, tanh_one},        DeviceFunction{Op::f_asinh, {}, asinh_one},
    DeviceFunction{Op::f_acosh, {}, acosh_one},
};

void append(std::string& text, std::string_view function, std::string_view prefix) {
  for (const char c : function) {
    if (c == '@') text += prefix;
    if (c != '@') text += c;
  }
}

}  // namespace

bool has_device_function(Op op) {
  return std::ranges::any_of(functions, [op](const DeviceFunction& function) { return function.op == op; });
}

std::string device_functions(std::span<const Instruction> instructions, std::string_view prefix) {
  std::string text;
  std::string_view there;  // what the last one needed: those that share it stand together
  for (const DeviceFunction& function : functions) {
    const auto calls = [&](const Instruction& instruction) { return instruction.op == function.op; };
    if (std::ranges::none_of(instructions, calls)) continue;
    if (function.needs != there) append(text, function.needs, prefix);
    there = function.needs;
    append(text, function.text, prefix);
  }
  return text;
}

}  // namespace dmvv::compiler::snippet
