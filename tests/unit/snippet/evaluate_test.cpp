// What programs give at points: against mathematics, against C++, against central differences.
#include <doctest/doctest.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>

#include "compiler/snippet/evaluate.h"
#include "program_of.h"

using namespace dmvv::compiler::snippet;

namespace {

const glm::dvec3 point{0.3, -0.7, 0.45};
constexpr double time_ms = 250.0;

double value(const std::string& body, const std::string& helpers = "") {
  const Value v = snippet_of(body, helpers).evaluate(point, time_ms);
  CHECK(v.finished);
  return v.f;
}

}  // namespace

TEST_CASE("scalars, vectors and swizzles") {
  const double x = point.x, y = point.y, z = point.z;
  CHECK(value("return p.x;") == x);
  CHECK(value("return t;") == time_ms);
  CHECK(value("return t / 1000.0;") == 0.25);
  CHECK(value("return p.x + p.y * p.z - 2.0 / p.x;") == doctest::Approx(x + y * z - 2.0 / x).epsilon(1e-15));
  CHECK(value("return length(p);") == doctest::Approx(std::sqrt(x * x + y * y + z * z)).epsilon(1e-15));
  CHECK(value("vec2 q = p.zx; q.yx *= vec2(2.0, 3.0); return q.x - q.y;") == doctest::Approx(3 * z - 2 * x));
  CHECK(value("return dot(p.yyz, p.zxx);") == doctest::Approx(y * z + y * x + z * x));
  CHECK(value("return cross(p, vec3(1.0, 2.0, 3.0)).y;") == doctest::Approx(z * 1 - x * 3));
  CHECK(value("return reflect(p, vec3(0.0, 1.0, 0.0)).y;") == doctest::Approx(-y));
  CHECK(value("return refract(vec3(0.0, -1.0, 0.0), vec3(0.0, 1.0, 0.0), 0.5).y;") == doctest::Approx(-1.0));
  CHECK(value("return faceforward(p, p, p).x;") == doctest::Approx(-x));
  CHECK(value("return distance(p.xy, p.yz);") == doctest::Approx(std::hypot(x - y, y - z)));
  CHECK(value("return normalize(p).z;") == doctest::Approx(z / std::sqrt(x * x + y * y + z * z)));
  CHECK(value("p.xy = p.yx; p *= 2.0; return p.x;") == doctest::Approx(2 * y));  // writing to p is allowed
  CHECK(value("int i = int(p.x * 10.0); return p[i % 3];") == doctest::Approx(x));
  CHECK(value("int i = int(p.x * 10.0 + 0.5) - 1; p[i] = 7.0; return p.z - p.x;") == doctest::Approx(7 - x));
  CHECK(value("return any(lessThan(p, vec3(0.0))) && !all(lessThan(p, vec3(0.0))) ? 1.0 : 2.0;") == 1.0);
}

TEST_CASE("matrices") {
  // Columns (1 2 3), (0 1 4), (5 6 0): determinant 1, a textbook inverse.
  const std::string m = "mat3 m = mat3(1.0, 2.0, 3.0, 0.0, 1.0, 4.0, 5.0, 6.0, 0.0);\n";
  const double x = point.x, y = point.y, z = point.z;
  CHECK(value(m + "return (m * p).y;") == doctest::Approx(2 * x + y + 6 * z));
  CHECK(value(m + "return (p * m).y;") == doctest::Approx(y + 4 * z));
  CHECK(value(m + "return determinant(m * p.x);") == doctest::Approx(x * x * x));
  CHECK(value(m + "return (inverse(m * p.x) * m * p).z;") == doctest::Approx(z / x).epsilon(1e-12));
  CHECK(value(m + "return transpose(m)[2][0];") == 3.0);
  CHECK(value(m + "return (m * m)[1][2];") == doctest::Approx(0 * 3 + 1 * 4 + 4 * 0));
  CHECK(value(m + "int i = int(p.x * 10.0) - 2; return m[i][i + 1];") == doctest::Approx(4.0));
  CHECK(value("return outerProduct(p, p.xy)[1][2];") == doctest::Approx(z * y));
  CHECK(value("mat4 m = mat4(p.x); m[3][0] = 2.0; return (inverse(m) * vec4(p, 1.0)).x;") ==
        doctest::Approx((x - 2 / x) / x));
  CHECK(value("mat2 r = mat2(0.0, 1.0, -1.0, 0.0); return (r * p.xy).x;") == doctest::Approx(-y));
  CHECK(value("mat2x3 m = mat2x3(p, p.zyx); return (m * vec2(2.0, 3.0)).x;") == doctest::Approx(2 * x + 3 * z));
  CHECK(value("return matrixCompMult(mat2(p.x), mat2(2.0))[0][0];") == doctest::Approx(2 * x));
}

TEST_CASE("built-in functions are those of C++") {
  const double x = 0.3, y = -0.7;
  const auto near = [](const std::string& expression, double expected) {
    CAPTURE(expression);
    CHECK(value("float x = p.x; float y = p.y; return " + expression + ";") == doctest::Approx(expected).epsilon(1e-7));
  };
  near("sin(x)", std::sin(x)), near("cos(y)", std::cos(y)), near("tan(x)", std::tan(x));
  near("asin(x)", std::asin(x)), near("acos(y)", std::acos(y)), near("atan(x)", std::atan(x));
  near("atan(y, -x)", std::atan2(y, -x));
  near("sinh(x)", std::sinh(x)), near("cosh(x)", std::cosh(x)), near("tanh(x)", std::tanh(x));
  near("asinh(y)", std::asinh(y)), near("acosh(x + 1.0)", std::acosh(x + 1)), near("atanh(x)", std::atanh(x));
  near("exp(x)", std::exp(x)), near("exp2(y)", std::exp2(y)), near("log(x)", std::log(x)),
      near("log2(x)", std::log2(x));
  near("pow(x, y)", std::pow(x, y)), near("sqrt(x)", std::sqrt(x)), near("inversesqrt(x)", 1 / std::sqrt(x));
  near("abs(y)", 0.7), near("sign(y)", -1), near("floor(y)", -1), near("ceil(y)", 0), near("trunc(y)", 0);
  near("round(y)", -1), near("roundEven(2.5 * sign(x))", 2), near("fract(y)", 0.3), near("mod(y, x)", 0.2);
  near("min(x, y)", y), near("max(x, y)", x), near("clamp(y, -0.5, x)", -0.5), near("mix(x, y, 0.25)", 0.05);
  near("step(x, y)", 0), near("step(x, x)", 1), near("smoothstep(-1.0, 1.0, x)", 0.65 * 0.65 * 1.7);
  near("radians(x)", x * std::numbers::pi / 180), near("degrees(x)", x * 180 / std::numbers::pi);
  near("fma(x, y, 1.0)", x * y + 1), near("ldexp(x, 3)", 2.4), near("isnan(x) ? 1.0 : 0.0", 0);
  near("mix(x, y, y < x)", y), near("isinf(x / (y - y)) ? 1.0 : 0.0", 1);
  CHECK(value("float whole; float part = modf(p.y * 3.0, whole); return whole * 10.0 + part;") ==
        doctest::Approx(-20.1).epsilon(1e-7));
  CHECK(value("int e; float m = frexp(p.x * 10.0, e); return m * 10.0 + float(e);") == doctest::Approx(7.5 + 2));
}

TEST_CASE("integers and bits") {
  CHECK(value("int a = int(p.x * 100.0 + 0.5); return float(a / 7 * 10 + a % 7);") == 42.0);
  CHECK(value("int a = -int(p.x * 100.0 + 0.5); return float(a / 7);") == -4.0);
  CHECK(value("uint a = uint(p.x * 100.0 + 0.5); return float((a << 2) ^ (a >> 1) & 7u | 1u);") ==
        ((120 ^ (15 & 7)) | 1));
  CHECK(value("uint h = uint(p.x * 10.0 + 0.5) * 747796405u + 2891336453u; return float(h);") ==
        static_cast<double>(3u * 747796405u + 2891336453u));
  CHECK(value("int a = int(p.x * 10.0 + 0.5); return float(bitfieldExtract(0x1234 * a, 4, 8));") ==
        (0x1234 * 3 >> 4 & 0xff));
  CHECK(value("int a = int(p.x * 10.0 + 0.5); return float(bitfieldExtract(-a, 0, 2));") == 1.0);
  CHECK(value("uint a = uint(p.x * 10.0 + 0.5); return float(bitfieldInsert(0xff00u, a, 4, 4));") == 0xff30);
  CHECK(value("int a = int(p.x * 10.0 + 0.5); return float(bitCount(a) * 100 + findMSB(a) * 10 + findLSB(a));") ==
        210.0);
  CHECK(value("uint a = uint(p.x * 10.0 + 0.5); return float(bitfieldReverse(a) >> 30);") == 3.0);
  CHECK(value("uint hi, lo; umulExtended(uint(p.x * 10.0 + 0.5) << 30, 8u, hi, lo); return float(hi);") == 6.0);
  CHECK(value("uint c; uint s = uaddCarry(uint(p.x * 10.0 + 0.5), 0xffffffffu, c); return float(s + 10u * c);") ==
        12.0);
  CHECK(value("return float(floatBitsToInt(p.x) >> 23);") == (std::bit_cast<std::int32_t>(0.3f) >> 23));
  CHECK(value("return intBitsToFloat(floatBitsToInt(p.x) + 1);") == double{std::nextafter(0.3f, 1.0f)});
  CHECK(value("return unpackHalf2x16(packHalf2x16(p.xy)).y;") == -0.7001953125);  // -0.7 rounded to 11 bits
  CHECK(value("return unpackSnorm4x8(packSnorm4x8(vec4(p, 1.0))).y;") == doctest::Approx(std::round(-0.7 * 127) / 127));
  CHECK(value("return unpackUnorm2x16(packUnorm2x16(p.xz)).y;") == doctest::Approx(std::round(0.45 * 65535) / 65535));
  CHECK(value("ivec3 i = ivec3(p * 10.0); return float(max(abs(i.y), min(i.x, i.z)));") == 7.0);
  CHECK(value("bvec2 b = lessThan(p.xy, p.yz); return (b.x ^^ b.y) && b != bvec2(true) ? 1.0 : 0.0;") == 1.0);
}

TEST_CASE("loops, branches, early returns") {
  CHECK(value("float s = 0.0; for (int i = 0; i < 5; i++) { for (int j = 0; j < 5; j++) { if (j > i) break;"
              "if ((i + j) % 2 == 1) continue; s += float(10 * i + j); } if (i == 3) break; } return s;") ==
        11 + 20 + 22 + 31 + 33);
  CHECK(
      value("int n = 0; do { n++; if (n == 3) continue; if (n > 6) return float(n); } while (n < 100); return -1.0;") ==
      7.0);
  CHECK(value("float s = 1.0; int i = 0; while (true) { s *= 2.0; if (++i >= 10) break; } return s;") == 1024.0);
  CHECK(value("for (int i = 0; i < 10; i++) for (int j = 0; j < 10; j++) if (i * j == 42) return float(10 * i + j);"
              "return 0.0;") == 67.0);
  CHECK(value("int a = 1, b = 1; for (int i = 0; i < 20; i++) { int c = a; a = b; b = c + b; } return float(b);") ==
        17711.0);  // Fibonacci: phis that swap
  CHECK(value("return p.x < 0.0 ? 1.0 : p.y < 0.0 ? 2.0 : 3.0;") == 2.0);
  CHECK(value("int n = 0; bool b = p.x < 0.0 && ++n > 0; bool c = p.x > 0.0 || ++n > 0; return float(n);") == 0.0);
  CHECK(value("float a = 1.0; { float a = 2.0; a += p.x; } return a;") == 1.0);
}

TEST_CASE("switch") {
  const std::string text =
      "float s = 0.0; switch (n) { case 1: s += 1.0; case 2: s += 10.0; break; case 3: return 5.0;"
      "case 4: if (p.x > 0.0) break; s = 9.0; default: s += 100.0; case 7: s += 1000.0; } return s;";
  const std::vector<std::pair<int, double>> expected{{1, 11},   {2, 10},   {3, 5},    {4, 0},
                                                     {5, 1100}, {7, 1000}, {-1, 1100}};
  for (const auto& pair : expected) {
    const int n = pair.first;
    const double f = pair.second;
    CAPTURE(n);
    CHECK(value(fmt::format("int n = int(p.x * 10.0 + 0.5) - 3 + {};", n) + text) == f);
    CHECK(value(fmt::format("float sum = 0.0; for (int k = 0; k < 3; k++) sum += g({}); return sum;", n),
                "float g(int n) { vec3 p = vec3(1.0); " + text + "}") == 3 * f);
  }
  std::string many = "switch (int(p.x * 1000.0)) {";  // 299 or 300
  for (int i = 0; i < 400; ++i) many += fmt::format("case {}: return {}.0;\n", i, i);
  const double index = value(many + "} return -1.0;");
  CHECK((index == 299.0 || index == 300.0));
}

TEST_CASE("functions, structs, arrays") {
  CHECK(value("vec3 q = p; float r = g(q, 2.0); return r + q.x * 10.0;",
              "float g(inout vec3 v, float k) { v = v.yzx * k; if (v.x < 0.0) return 1.0; return 2.0; }") ==
        doctest::Approx(1 + 10 * 2 * -0.7));
  CHECK(value("return g(p.x).b[1] + g(p.y).a;",
              "struct S { float a; float b[2]; };"
              "S g(float x) { S s; s.a = x; s.b = float[](2.0 * x, 3.0 * x); return s; }") ==
        doctest::Approx(3 * 0.3 - 0.7));
  CHECK(value("float a[4]; for (int i = 0; i < 4; i++) a[i] = float(i * i); int k = int(p.x * 10.0 + 0.5);"
              "return a[k] * 10.0 + a[k - 1];") == 94.0);
  CHECK(value("vec3 a[2] = vec3[](p, p * 2.0); float s = 0.0; for (int i = 0; i < 2; i++) s += a[i].y; return s;") ==
        doctest::Approx(-2.1));
  CHECK(value("float a[2][3]; for (int i = 0; i < 2; i++) for (int j = 0; j < 3; j++) a[i][j] = float(10 * i + j);"
              "int k = int(p.x * 10.0 + 0.5) - 2; return a[k][k + 1];") == 12.0);
  CHECK(value("mat3 m[2]; m[0] = mat3(1.0); m[1] = mat3(2.0); int k = int(p.x * 10.0 + 0.5) - 2; m[k][k][k] = 5.0;"
              "return (m[k] * vec3(1.0)).y + m[0][0][0];") == 6.0);
  CHECK(value("return float(table[int(p.x * 10.0 + 0.5)] + counter++ + counter);",
              "const int table[4] = int[](3, 1, 4, 1); int counter = 5;") == 12.0);
  CHECK(value("S s[2]; s[0].v = p; s[1].v = -p; s[1].n = 3; int k = int(p.x * 10.0 + 0.5) - 2;"
              "return s[k].v.y * float(s[k].n);",
              "struct S { vec3 v; int n; };") == doctest::Approx(2.1));
  // An index outside is clamped, whatever it is.
  CHECK(value("float a[3]; for (int i = 0; i < 3; i++) a[i] = float(i + 1); return a[int(p.x * 1e9)];") == 3.0);
}

TEST_CASE("values that are not finite") {
  CHECK(std::isnan(value("return sqrt(p.y);")));
  CHECK(std::isnan(value("return pow(p.y, 2.0);")));
  CHECK(std::isinf(value("return 1.0 / (p.x - p.x);")));
  CHECK(std::isnan(value("return normalize(p - p).x;")));
  CHECK(value("return max(sqrt(p.y), 2.0);") == 2.0);
  CHECK(value("float n = sqrt(p.y); return n < 1.0 || n >= 1.0 || n == n ? 1.0 : n != n ? 2.0 : 3.0;") == 2.0);
}

TEST_CASE("a loop that does not end is told") {
  for (const char* body : {"for (;;) { } return 1.0;", "float s = p.x; while (s < 2.0) s *= 0.5; return s;",
                           "int i = 0; do { if (p.x > 2.0) break; i = 1 - i; } while (true); return float(i);"}) {
    CAPTURE(body);
    const Value v = snippet_of(body).evaluate(point, 0.0);
    CHECK_FALSE(v.finished);
    CHECK(std::isnan(v.f));
    const Interval all = snippet_of(body).evaluate({point, point}, {0, 0}, Rounding::real);
    CHECK(all.maybe_nan);
    CHECK(std::isinf(all.lo));
  }
}

TEST_CASE("duals agree with central differences") {
  const char* const bodies[] = {
      "return length(p) - 0.5;",
      "return sin(3.0 * p.x + t * 0.001) * cos(p.y) + tan(p.z);",
      "return atan(p.y, p.x) + asin(p.x * 0.5) + acos(p.z) + atan(p.x);",
      "return exp(p.x) * log(p.z + 2.0) + exp2(p.y) + log2(2.0 + p.y) + pow(p.z, p.x + 2.0);",
      "return sinh(p.x) + cosh(p.y) + tanh(p.z) + asinh(p.x) + acosh(p.z + 2.0) + atanh(p.y);",
      "return mod(p.x, 0.21) + fract(p.y * 1.3) + mix(p.x, p.y, p.z) + smoothstep(-1.0, 2.0, p.x);",
      "vec3 q = abs(p) - vec3(0.2); return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);",
      "mat2 m = mat2(cos(p.z), sin(p.z), -sin(p.z), cos(p.z)); p.xy = m * p.xy; return p.x * p.y / (2.0 + p.z);",
      "float s = 0.0; for (int i = 1; i < 6; i++) { s += sin(p.x * float(i)) / float(i); if (s > 3.0) break; } return "
      "s;",
      "float a[3] = float[](p.x, p.y * p.y, p.z); return a[int(t * 0.01) % 3] * inversesqrt(2.0 + p.x) * sqrt(1.0 + "
      "p.y);",
      "vec3 n = normalize(p); return dot(reflect(p, n.yzx), n) + (inverse(mat3(p, n.yzx, p.zxy + 1.0)) * p).x;",
  };
  for (const char* body : bodies) {
    CAPTURE(body);
    const Snippet snippet = snippet_of(body);
    const double h = 1e-6, ms = 0.1;
    const auto difference = [&](const glm::dvec3& step) {
      return (snippet.evaluate(point + step, time_ms).f - snippet.evaluate(point - step, time_ms).f) / (2 * h);
    };
    const Dual dual = snippet.differentiate(point, time_ms);
    CHECK(dual.value == snippet.evaluate(point, time_ms).f);
    CHECK(dual.gradient.x == doctest::Approx(difference({h, 0, 0})).epsilon(1e-6));
    CHECK(dual.gradient.y == doctest::Approx(difference({0, h, 0})).epsilon(1e-6));
    CHECK(dual.gradient.z == doctest::Approx(difference({0, 0, h})).epsilon(1e-6));
    const double rate = (snippet.evaluate(point, time_ms + ms).f - snippet.evaluate(point, time_ms - ms).f) / (2 * ms);
    CHECK(dual.rate == doctest::Approx(rate).epsilon(1e-6));
  }
}

TEST_CASE("time is exact after an hour") {
  const Snippet snippet = snippet_of("return sin(t / 1000.0);");
  for (double t = 3.6e6; t < 3.6e6 + 100.0; t += 16.7) CHECK(snippet.evaluate(point, t).f == std::sin(t / 1000.0));
}

TEST_CASE("what a program holds") {
  CHECK(snippet_of("return p.x + t;").uses_time());
  CHECK_FALSE(snippet_of("float unused = t; return p.x;").uses_time());
  CHECK(snippet_of("return t;").uses_time());
  CHECK(snippet_of("return length(p) + length(p) * 2.0;").instruction_count() == 8);  // the length is computed once
  const Program program = program_of("float s = 0.0; for (int i = 0; i < 3; i++) s += p.x; return s;");
  CHECK(program == program_of("float other = 0.0; for (int k = 0; k < 3; k++) { other += p.x; } return other;"));
  CHECK(program.variables.size() == 2);
}

TEST_CASE("what is refused, and why") {
  const auto reason = [](const std::string& body, const std::string& helpers = "") -> std::string {
    try {
      program_of(body, helpers);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing";
  };
  const auto says = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  CHECK(says(reason("return float(double(p.x) * 2.0LF);"), "64 bits"));
  CHECK(says(reason("float a[5000]; a[int(t)] = 1.0; return a[int(p.x)];"), "4096 scalars"));
  std::string doubling = "float f0(float x) { return x + 1.0; }\n";
  for (int i = 1; i < 24; ++i)
    doubling += fmt::format("float f{}(float x) {{ return f{}(x) + f{}(x + 1.0); }}\n", i, i - 1, i - 1);
  CHECK(says(reason("return f23(p.x);", doubling), "inlined"));
  std::string deep = "float s = 0.0;";
  for (int i = 0; i < 230; ++i) deep += fmt::format("if (p.x > 0.00{} + s) {{ s += p.y;", i);
  CHECK(says(reason(deep + std::string(230, '}') + "return s;"), "nested deeper"));
  CHECK_FALSE(read_spirv(std::vector<std::uint32_t>{}).has_value());
  CHECK_FALSE(read_spirv(std::vector<std::uint32_t>{0x07230203, 0x10500, 0, 10, 0, 0xffff0001}).has_value());
  CHECK_FALSE(read_spirv(std::vector<std::uint32_t>(64, 0xdeadbeef)).has_value());
}

TEST_CASE("recursion is refused by the reader, too") {
  // glslang lets recursion pass while it compiles a stage; whether it or the reader refuses, it never becomes a
  // program.
  CHECK_THROWS_AS(program_of("return g(p.x);", "float g(float x) { return x < 0.0 ? 0.0 : g(x - 1.0); }"),
                  std::runtime_error);
}

TEST_CASE("cost: some 10 ns an instruction") {
  const Snippet snippet =
      snippet_of("float s = 0.0; for (int i = 0; i < 100; i++) { s = s * 0.5 + p.x * p.y - s * p.z + 0.1; } return s;");
  const auto begin = std::chrono::steady_clock::now();
  double sum = 0.0;
  constexpr int rounds = 2000;
  for (int i = 0; i < rounds; ++i) sum += snippet.evaluate({i * 1e-3, 0.2, 0.3}, 0.0).f;
  const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
  const double each = spent.count() / (rounds * 100.0 * 11.0);  // 6 of arithmetic, 3 of the loop, 2 copies
  MESSAGE("ns an instruction: " << each);
  CHECK(std::isfinite(sum));
  CHECK(each < 1000.0);  // a bound that also a busy machine under sanitizers keeps
}
