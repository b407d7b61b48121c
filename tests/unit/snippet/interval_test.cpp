// Intervals enclose: every operation on members of its operands, every program on points of its box.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/interval.h"
#include "compiler/snippet/machine.h"
#include "program_of.h"

using namespace dmvv::compiler::snippet;

namespace {

bool encloses(const Interval& range, double x) {
  return std::isnan(x) ? range.maybe_nan : range.lo <= x && x <= range.hi;
}
bool encloses(const IntegerInterval& range, std::int64_t x) { return range.lo <= x && x <= range.hi; }

/// Numbers of all sizes, and the special ones.
class Numbers {
 public:
  double real() {
    constexpr double special[] = {0.0,
                                  -0.0,
                                  1.0,
                                  -1.0,
                                  0.5,
                                  2.0,
                                  3.0,
                                  -2.5,
                                  1e-3,
                                  1e6,
                                  1e30,
                                  -1e30,
                                  1e-30,
                                  std::numeric_limits<double>::infinity(),
                                  -std::numeric_limits<double>::infinity()};
    if (below(4) == 0) return static_cast<float>(special[below(std::size(special))]);
    const double size = std::exp2(uniform(-6.0, below(8) == 0 ? 40.0 : 5.0));
    return static_cast<float>(below(2) == 0 ? size : -size);  // representable on a device
  }
  Interval interval() {
    const double a = real();
    const double b = below(3) == 0   ? a
                     : below(2) == 0 ? real()
                                     : static_cast<float>(a + uniform(0.0, 0.2) * std::abs(a));
    if (std::isnan(b)) return {a, a};
    return {std::fmin(a, b), std::fmax(a, b)};
  }
  double member(const Interval& range) {
    if (below(4) == 0) return range.lo;
    if (below(4) == 0) return range.hi;
    const double lo = std::fmax(range.lo, -1e30), hi = std::fmin(range.hi, 1e30);
    return lo < hi ? std::fmin(std::fmax(uniform(lo, hi), lo), hi) : range.lo;
  }
  IntegerInterval integers(const IntegerInterval& type) {
    const std::int64_t a = integer(type);
    const std::int64_t b = below(3) == 0 ? a : below(2) == 0 ? integer(type) : std::min(a + below(20), type.hi);
    return {std::min(a, b), std::max(a, b)};
  }
  std::int64_t member(const IntegerInterval& range) {
    return std::uniform_int_distribution<std::int64_t>(range.lo, range.hi)(generator_);
  }
  double uniform(double a, double b) { return a + (b - a) * std::generate_canonical<double, 53>(generator_); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(generator_); }
  int below(std::size_t n) { return below(static_cast<int>(n)); }

 private:
  std::int64_t integer(const IntegerInterval& type) {
    const int kind = below(4);
    if (kind == 0) return type.lo + std::min<std::int64_t>(below(4), type.hi - type.lo);
    if (kind == 1) return type.hi - std::min<std::int64_t>(below(4), type.hi - type.lo);
    if (kind == 2) return member(type);
    return std::clamp<std::int64_t>(below(80) - 20, type.lo, type.hi);
  }
  std::mt19937_64 generator_{20};
};

std::int64_t as_integer(char letter, std::uint32_t bits) {
  return letter == 'i' ? std::int64_t{static_cast<std::int32_t>(bits)} : std::int64_t{bits};
}

/// One instruction on intervals and on members of them.
template <class Domain, class Point>
void check_operation(Op op, Numbers& numbers, int rounds) {
  const OpInfo& table = info(op);
  Instruction instruction{.op = op, .result = 3, .operands = {0, 1, 2}};
  for (int round = 0; round < rounds; ++round) {
    Cell<Domain> boxes[4];
    Cell<Point> points[4];
    for (std::size_t k = 0; k < table.operands.size(); ++k) {
      if (table.operands[k] == 'f') {
        boxes[k].f = numbers.interval();
        continue;
      }
      const char letter = table.operands[k];
      boxes[k].i = numbers.integers(letter == 'i'   ? IntegerIntervalOps::any_int
                                    : letter == 'u' ? IntegerIntervalOps::any_uint
                                                    : IntegerIntervalOps::any_bool);
    }
    execute<Domain>(instruction, boxes);
    for (int sample = 0; sample < 4; ++sample) {
      for (std::size_t k = 0; k < table.operands.size(); ++k) {
        if (table.operands[k] == 'f') points[k].f = static_cast<typename Point::Real>(numbers.member(boxes[k].f));
        if (table.operands[k] != 'f') points[k].i = static_cast<std::uint32_t>(numbers.member(boxes[k].i));
        if (table.operands[k] != 'f' || encloses(boxes[k].f, points[k].f)) continue;
        points[k].f = static_cast<typename Point::Real>(boxes[k].f.lo);  // rounded out of a narrow interval
      }
      execute<Point>(instruction, points);
      INFO(std::string(table.name) << " a " << boxes[0].f.lo << ".." << boxes[0].f.hi << " b " << boxes[1].f.lo << ".."
                                   << boxes[1].f.hi << " at " << double(points[0].f) << ", " << double(points[1].f)
                                   << ", " << double(points[2].f) << " | " << points[0].i << ", " << points[1].i);
      if (table.result == 'f') {
        INFO("got " << double(points[3].f) << " not in " << boxes[3].f.lo << ".." << boxes[3].f.hi);
        REQUIRE(encloses(boxes[3].f, double(points[3].f)));
      } else {
        const std::int64_t got = as_integer(table.result, points[3].i);
        INFO("got " << got << " not in " << boxes[3].i.lo << ".." << boxes[3].i.hi);
        REQUIRE(encloses(boxes[3].i, got));
      }
    }
  }
}

constexpr Op all_ops[] = {
#define DMVV_OP(name, result, operands) Op::name,
#include "compiler/snippet/ops.def"
#undef DMVV_OP
};

const char* const bodies[] = {
    "return length(p) - 0.6;",
    "vec3 q = abs(p) - vec3(0.3, 0.4, 0.5); return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);",
    "vec2 q = vec2(length(p.xz) - 0.6, p.y); return length(q) - 0.2;",
    "float h = clamp(dot(p, vec3(0.5)) / 0.75, 0.0, 1.0); return length(p - 0.5 * h) - 0.1;",
    "float a = length(p - 0.3), b = length(p + 0.3); float h = clamp(0.5 + (b - a) / 0.4, 0.0, 1.0);"
    "return mix(b, a, h) - 0.2 * h * (1.0 - h) - 0.3;",
    "return 1.0 - 0.1 / dot(p - 0.2, p - 0.2) - 0.1 / dot(p + 0.2, p + 0.2);",
    "return sin(9.0 * p.x) * cos(7.0 * p.y) + sin(5.0 * p.z + t * 0.001);",
    "float c = cos(3.0 * p.y), s = sin(3.0 * p.y); p.xz = mat2(c, -s, s, c) * p.xz; return max(abs(p.x), abs(p.z)) - "
    "0.3;",
    "vec3 q = mod(p + 0.25, 0.5) - 0.25; return length(q) - 0.1;",
    "vec3 q = fract(p * 3.0) - 0.5; return dot(q, q) - 0.1;",
    "return atan(p.y, p.x) + asin(clamp(p.z, -1.0, 1.0)) + acos(p.x * 0.5) + atan(p.z);",
    "return exp(p.x) - log(p.y + 3.0) * exp2(p.z) + pow(abs(p.x) + 0.1, 1.5 + p.y) + log2(2.0 + p.z);",
    "return tan(p.x) + sinh(p.y) + cosh(p.z) + tanh(p.x * 3.0) + asinh(p.y) + acosh(2.0 + p.z) + atanh(p.x * 0.9);",
    "return smoothstep(-0.5, 0.5, p.x) + step(0.2, p.y) + sign(p.z) * floor(p.x * 4.0) + ceil(p.y * 3.0) + round(p.z * "
    "5.0);",
    "if (p.x < 0.0) return p.y; if (p.y < p.z) { p.x = 2.0; } else { p.x -= p.z; } return p.x * p.x;",
    "float s = 0.0; for (int i = 0; i < 8; i++) { s += 0.3 * sin(float(i) * p.x + s); if (s > 1.0) break; } return s;",
    "float s = 0.0; for (int i = 0; i < 12; i++) { if (p.x * float(i) > 2.0) continue; s += p.y; if (s > 4.0) return "
    "9.0; }"
    "return s;",
    "vec3 z = p; float d = 1.0; for (int i = 0; i < 5; i++) { float r = length(z); if (r > 2.0) break; d = 2.0 * r * d "
    "+ 1.0;"
    "z = vec3(z.x * z.x - z.y * z.y, 2.0 * z.x * z.y, z.z) + p; } return length(z) / d;",
    "float a[4] = float[](p.x, p.y, p.z, p.x + p.y); int i = int(floor(2.0 + 2.0 * p.x)); a[i] += 1.0; return a[3 - i] "
    "+ a[1];",
    "switch (int(floor(p.x * 3.0))) { case 0: p.y += 1.0; case 1: p.z *= 2.0; break; case -1: return 5.0; default: p.y "
    "= 0.0; }"
    "return p.y - p.z;",
    "bool b = p.x < 0.2 && p.y > -0.1 || p.z < 0.0; bvec3 c = lessThan(p, p.yzx); return b ? float(c.x) : "
    "float(any(c)) * p.x;",
    "mat3 m = inverse(mat3(2.0 + p.x, 0.1, 0.0, 0.2, 3.0, p.y, 0.0, 0.1, 2.0)); return (m * p).x + determinant(m);",
    "vec3 n = normalize(p + vec3(2.0, 0.0, 0.0)); return dot(reflect(p, n), n) + refract(n, vec3(-1.0, 0.0, 0.0), "
    "0.7).y;",
    "uvec2 q = uvec2(ivec2(floor(p.xy * 8.0))); uint h = (q.x * 1664525u + q.y) ^ (q.x >> 3); h *= 747796405u;"
    "return float(h >> 8) / 16777216.0 + p.z;",
    "ivec3 i = ivec3(p * 10.0); return float((i.x * 7 + i.y) % 5 + i.z / 3 - (i.x << 1) + max(i.x, abs(i.y)));",
    "float w; float m = modf(p.x * 4.0, w); int e; float f = frexp(p.y, e); return m + w + f + ldexp(p.z, e);",
    "return sqrt(p.x) + 1.0 / p.y + log(p.z);",
    "float x = p.x / p.y; return isnan(x) || isinf(x) ? 7.0 : min(max(x, -3.0), 3.0);",
    "float s = p.x; int n = 0; while (s > 0.1 && n < 40) { s *= 0.7; n++; } return s + float(n);",
    "float s = p.x * p.x; do { s += 0.25; } while (s < 1.0); return s;",
    "return unpackHalf2x16(packHalf2x16(p.xy)).x + unpackSnorm4x8(packSnorm4x8(vec4(p, 0.0))).z;",
    "return intBitsToFloat(floatBitsToInt(abs(p.x) + 1.0) ^ 0x1000) + p.y;",
};

Box random_box(Numbers& numbers) {
  Box box{};
  const double width = std::exp2(numbers.uniform(-12.0, 1.0));
  for (int k = 0; k < 3; ++k) {
    box.lo[k] = numbers.uniform(-1.2, 1.2);
    box.hi[k] = box.lo[k] + width * numbers.uniform(0.0, 1.0);
  }
  return box;
}

}  // namespace

TEST_CASE("every operation encloses its results") {
  Numbers numbers;
  for (const Op op : all_ops) {
    if (info(op).operands[0] == 'a') continue;
    check_operation<IntervalDomain<Rounding::real>, PointDomain<double>>(op, numbers, 4000);
    check_operation<IntervalDomain<Rounding::float32>, PointDomain<double>>(op, numbers, 2000);
    check_operation<IntervalDomain<Rounding::float32>, PointDomain<float>>(op, numbers, 4000);
  }
}

TEST_CASE("points of a box never leave the interval of a program") {
  Numbers numbers;
  for (const char* body : bodies) {
    CAPTURE(body);
    const Program program = program_of(body);
    const Snippet snippet(std::make_shared<const Program>(program));
    for (int round = 0; round < 300; ++round) {
      const Box box = random_box(numbers);
      const Interval t{numbers.uniform(0.0, 5000.0), 5000.0};
      const Interval real = snippet.evaluate(box, t, Rounding::real);
      const Interval device = snippet.evaluate(box, t, Rounding::float32);
      for (int sample = 0; sample < 20; ++sample) {
        glm::dvec3 p;
        for (int k = 0; k < 3; ++k) p[k] = numbers.member(Interval{box.lo[k], box.hi[k]});
        const double at = numbers.member(t);
        const double f = snippet.evaluate(p, at).f;
        const float f32 = evaluate_point<float>(program, {float(p.x), float(p.y), float(p.z), float(at)}).f;
        INFO(p.x << " " << p.y << " " << p.z << " t " << at << ": " << f << ", float32 " << f32 << ", in " << real.lo
                 << ".." << real.hi << " and " << device.lo << ".." << device.hi);
        REQUIRE(encloses(real, f));
        REQUIRE(encloses(device, f));
        REQUIRE(encloses(device, double{f32}));
      }
    }
  }
}

TEST_CASE("small boxes give narrow intervals where the function is smooth") {
  const glm::dvec3 p{0.31, -0.22, 0.47};
  for (std::size_t i = 0; i < 14; ++i) {
    CAPTURE(bodies[i]);
    const Snippet snippet = snippet_of(bodies[i]);
    const Interval real = snippet.evaluate({p - 1e-7, p + 1e-7}, {100, 100}, Rounding::real);
    const Interval device = snippet.evaluate({p - 1e-7, p + 1e-7}, {100, 100}, Rounding::float32);
    CHECK(real.hi - real.lo < 1e-4);
    CHECK(device.hi - device.lo < 1e-2);
    CHECK_FALSE(device.maybe_nan);
  }
}

TEST_CASE("intervals are as tight as they should be") {
  const Box cube{{-1, -1, -1}, {1, 1, 1}};
  const auto over = [](const char* body, const Box& box) {
    return snippet_of(body).evaluate(box, {0, 0}, Rounding::real);
  };
  const auto is = [](const Interval& range, double lo, double hi) {
    CHECK(range.lo == doctest::Approx(lo).epsilon(1e-12));
    CHECK(range.hi == doctest::Approx(hi).epsilon(1e-12));
    CHECK_FALSE(range.maybe_nan);
  };
  is(over("return p.x * p.x;", cube), 0, 1);  // a square, not any product
  is(over("return length(p) - 0.5;", cube), -0.5, std::sqrt(3.0) - 0.5);
  is(over("return sin(p.x);", {{1, 0, 0}, {2, 0, 0}}), std::sin(1.0), 1);  // over its maximum
  is(over("return sin(p.x);", {{2, 0, 0}, {3, 0, 0}}), std::sin(3.0), std::sin(2.0));
  is(over("return cos(p.x);", {{-1, 0, 0}, {2, 0, 0}}), std::cos(2.0), 1);
  is(over("return atan(p.y, p.x);", {{1, 1, 0}, {2, 3, 0}}), std::atan2(1, 2), std::atan2(3, 1));
  is(over("return mod(p.x, 0.5);", {{0.6, 0, 0}, {0.9, 0, 0}}), 0.1, 0.4);
  is(over("return mix(p.x, p.y, p.z * p.z);", {{1, 2, -1}, {1, 2, 1}}), 1, 2);
  is(over("return smoothstep(0.0, 1.0, p.x);", {{-1, 0, 0}, {0.5, 0, 0}}), 0, 0.5);
  is(over("if (p.x > 0.0) return 2.0; return 3.0;", {{0.1, 0, 0}, {1, 0, 0}}), 2, 2);
  is(over("if (p.x > 0.0) return 2.0; return 3.0;", cube), 2, 3);
  is(over("float s = 0.0; for (int i = 0; i < 9; i++) { if (p.x > 0.0) break; s += 1.0; } return s;", cube), 0, 9);
  is(over("float a[3] = float[](1.0, 5.0, 9.0); return a[int(p.x + 1.5)];", {{0, 0, 0}, {0.9, 0, 0}}), 5, 9);
  is(over("return 1.0 / p.x;", {{1, 0, 0}, {2, 0, 0}}), 0.5, 1);
}

TEST_CASE("unbounded and undefined") {
  const Box cube{{-1, -1, -1}, {1, 1, 1}};
  const Interval quotient = snippet_of("return 1.0 / p.x;").evaluate(cube, {0, 0}, Rounding::real);
  CHECK((std::isinf(quotient.lo) && std::isinf(quotient.hi)));
  CHECK(snippet_of("return sqrt(p.x);").evaluate(cube, {0, 0}, Rounding::real).maybe_nan);
  CHECK_FALSE(snippet_of("return sqrt(abs(p.x));").evaluate(cube, {0, 0}, Rounding::float32).maybe_nan);
  CHECK_FALSE(snippet_of("return length(p);").evaluate(cube, {0, 0}, Rounding::float32).maybe_nan);
  CHECK(snippet_of("return log(p.x) * (p.y - p.y);").evaluate(cube, {0, 0}, Rounding::real).maybe_nan);
  // A loop whose end is never decided for the whole box.
  const Interval endless = snippet_of("float s = p.x; while (s < 1e6) s += p.y * p.y + 1e-3; return s;")
                               .evaluate(cube, {0, 0}, Rounding::real);
  CHECK((endless.maybe_nan && std::isinf(endless.hi)));
}

TEST_CASE("float32 widens, and no more than it must") {
  const Snippet snippet = snippet_of("return length(p) - 0.5;");
  const glm::dvec3 p{0.3, 0.4, 0.0};
  const Interval real = snippet.evaluate({p, p}, {0, 0}, Rounding::real);
  const Interval device = snippet.evaluate({p, p}, {0, 0}, Rounding::float32);
  CHECK(real.hi - real.lo < 1e-14);
  CHECK(device.hi - device.lo > 0x1p-24);
  CHECK(device.hi - device.lo < 20 * 0x1p-24);
}

TEST_CASE("integers that wrap around stay known") {
  const auto over = [](const std::string& body, double lo, double hi) {
    return snippet_of(body).evaluate({{lo, 0, 0}, {hi, 0, 0}}, {0, 0}, Rounding::float32);
  };
  // 3e9 + 3e9 and 65537 * 65537 modulo 2^32; a whole range that wraps; one that wraps in part.
  CHECK(over("uint a = 3000000000u + uint(p.x); return float((a + 3000000000u) >> 8u);", 0, 0).hi ==
        doctest::Approx(std::floor(1705032704.0 / 256)));
  CHECK(over("uint a = 65537u + uint(p.x); return float(a * a);", 0, 0).lo == doctest::Approx(131073));
  const Interval wrapped = over("return float(4294967290u + uint(p.x));", 10.5, 20.5);
  CHECK(wrapped.lo == doctest::Approx(4));
  CHECK(wrapped.hi == doctest::Approx(14));
  CHECK(over("return float(4294967290u + uint(p.x));", 2.5, 20.5).hi > 4e9);
  CHECK(over("return float((int(p.x) + 2147483647) + 1);", 0, 0).hi == doctest::Approx(-2147483648.0));
}
