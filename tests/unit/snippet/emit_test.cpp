#include <algorithm>
#include <bit>
#include <cstdint>
#include <numbers>

#include "compiler/snippet/evaluate.h"
#include "emitted.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::tests;
using namespace dmvv::compiler::snippet;

namespace {

/// A program by hand, of one run; registers as program.h numbers them.
Program straight(std::vector<Constant> constants, std::vector<Type> temporaries,
                 std::vector<Instruction> instructions) {
  Program program;
  program.constants = std::move(constants);
  program.temporaries = std::move(temporaries);
  program.result = instructions.back().result;
  program.instructions = std::move(instructions);
  Node run;
  run.count = static_cast<std::uint32_t>(program.instructions.size());
  program.body.push_back(run);
  return program;
}

constexpr std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }

/// The emitted program agrees with the original, in double, at points of the cube.
void check_same(const Snippet& original, double t_ms = 0.0) {
  const Snippet again = snippet(read_back(original, t_ms));
  for (const glm::dvec3& p : points_of_cube(200)) {
    const Value expected = original.evaluate(p, t_ms), got = again.evaluate(p, t_ms);
    REQUIRE(expected.finished);
    CHECK_MESSAGE(got.f == expected.f, original.glsl("f", 0));
  }
}

double error_of(const char* body, double t_ms, double expected) {
  const Snippet original = snippet(read_body(body));
  return std::abs(snippet(read_back(original, t_ms)).evaluate(glm::dvec3(0.0), t_ms).f - expected);
}

bool has(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

/// A text without its comment lines.
std::string code_of(const std::string& text) {
  std::string code;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin) + 1;
    const std::string line = text.substr(begin, end - begin);
    if (!has(line, "//")) code += line;
    begin = end;
  }
  return code;
}

}  // namespace

TEST_CASE("a temporary with one use stands where it is used, others have a line") {
  // d = x - y; result = d * d + |y|
  const Program program =
      straight({}, {Type::real, Type::real, Type::real, Type::real},
               {{Op::f_sub, 4, {0, 1}}, {Op::f_mul, 5, {4, 4}}, {Op::f_abs, 6, {1}}, {Op::f_add, 7, {5, 6}}});
  CHECK(snippet(program).glsl("f3", 9) ==
        "float f3(vec3 p) {\n"
        "  float r0 = p.x - p.y;\n"
        "  return r0 * r0 + abs(p.y);\n"
        "}\n");
}

TEST_CASE("parentheses keep the order of operations") {
  for (const char* body : {"return p.x - (p.y - p.z);", "return p.x / (p.y * 3.0) * 2.0;", "return -(-p.x) - -p.y;",
                           "return (p.x + p.y) * (p.x - p.y) / (p.z + 2.0);", "return p.x + (p.y + p.z);",
                           "return p.x * -0.5 - (-0.25 - p.y);"}) {
    check_same(snippet(read_body(body)));
  }
}

TEST_CASE("equal programs give equal text but for the name and the first time value") {
  const char* const body = "return length(p) - 0.3 * sin(t / 500.0);";
  const Snippet a = snippet(read_body(body)), b = snippet(read_body(body));
  CHECK(a.glsl("f", 0) == b.glsl("f", 0));
  CHECK(a.glsl("f", 0) == snippet(read_body("float r = 0.3*sin(t/500.); return length(p) - r;")).glsl("f", 0));
  CHECK(a.glsl("f", 0) != snippet(read_body("return length(p) - 0.4 * sin(t / 500.0);")).glsl("f", 0));
  // Time values that differ tell snippets apart whose code is the same.
  const auto of = [](const char* text) { return snippet(read_body(text)).glsl("f", 0); };
  CHECK(of("return p.x - sin(t / 500.0);") != of("return p.x - sin(t / 1000.0);"));
  CHECK(of("return sin(p.x + t);") != of("return sin(p.x * (1.0 + t));"));
  std::string moved = a.glsl("g", 17);
  CHECK(has(moved, "time_values[17]"));
  moved.replace(moved.find("time_values[17]"), 15, "time_values[0]");
  moved.replace(moved.find("g("), 2, "f(");
  CHECK(moved == a.glsl("f", 0));
}

TEST_CASE("constants read back to the bit") {
  std::mt19937 random(7);
  std::vector<Constant> constants = {{Type::real, bits(0.1f)},        {Type::real, bits(-0.0f)},
                                     {Type::real, bits(1e-45f)},      {Type::real, bits(3.4028235e38f)},
                                     {Type::real, bits(16777216.0f)}, {Type::real, bits(-1e-10f)},
                                     {Type::real, bits(1e10f)},       {Type::real, bits(8.589973e9f)}};
  while (constants.size() < 400) {
    const auto word = static_cast<std::uint32_t>(random());
    if (std::isfinite(std::bit_cast<float>(word))) constants.push_back({Type::real, word});
  }
  // A sum of p.x * constant: none of them can be folded.
  const auto count = static_cast<Register>(constants.size());
  const Register first = Program::input_count + count;
  std::vector<Instruction> instructions;
  Register sum = Program::p_y;
  for (Register c = 0; c < count; ++c) {
    instructions.push_back({Op::f_fma, first + c, {Program::p_x, Program::input_count + c, sum}});
    sum = first + c;
  }
  const Program program = straight(constants, std::vector<Type>(count, Type::real), instructions);
  const Program again = read_back(snippet(program), 0.0);
  for (const Constant& constant : constants) {
    CHECK_MESSAGE(std::ranges::count(again.constants, constant) == 1, std::bit_cast<float>(constant.bits));
  }
}

TEST_CASE("infinities, NaN and the smallest integer have literals") {
  const Program program =
      straight({{Type::real, bits(INFINITY)}, {Type::integer, 0x80000000u}}, {Type::real, Type::real, Type::real},
               {{Op::f_min, 6, {4, 0}}, {Op::f_from_i, 7, {5}}, {Op::f_add, 8, {6, 7}}});
  const Snippet again = snippet(read_back(snippet(program), 0.0));
  CHECK(again.evaluate({0.5, 0, 0}, 0).f == 0.5 - 2147483648.0);
}

TEST_CASE("operations that GLSL returns by parameters, or does not have") {
  // high words of products, parts of a float, remainders by C's rules
  const Program program = straight(
      {{Type::real, bits(1e9f)}, {Type::integer, 7}, {Type::unsigned_integer, 0xdeadbeefu}, {Type::real, bits(0.3f)}},
      {Type::integer, Type::integer, Type::integer, Type::unsigned_integer, Type::unsigned_integer, Type::real,
       Type::integer, Type::real, Type::real, Type::real, Type::real, Type::real, Type::real, Type::real, Type::real,
       Type::real, Type::real},
      {{Op::f_mul, 13, {0, 4}},
       {Op::i_from_f, 8, {13}},
       {Op::i_mul_high, 9, {8, 8}},
       {Op::i_rem, 10, {8, 5}},
       {Op::u_from_i, 11, {8}},
       {Op::u_mul_high, 12, {11, 6}},
       {Op::i_frexp_exponent, 14, {1}},
       {Op::f_frexp_mantissa, 15, {1}},
       {Op::f_rem, 16, {0, 7}},
       {Op::f_from_i, 17, {9}},
       {Op::f_from_i, 18, {10}},
       {Op::f_from_u, 19, {12}},
       {Op::f_from_i, 20, {14}},
       {Op::f_add, 21, {15, 16}},
       {Op::f_fma, 22, {17, 18, 19}},
       {Op::f_fma, 23, {20, 21, 22}},
       {Op::f_add, 24, {23, 20}}});
  const Snippet again = snippet(read_back(snippet(program), 0.0));
  for (const glm::dvec3& p : points_of_cube(100)) {
    const double scaled = p.x * 1e9;
    const auto i = static_cast<std::int64_t>(scaled);
    const auto low = static_cast<std::uint32_t>(i);
    int exponent = 0;
    const double mantissa = std::frexp(p.y, &exponent);
    const double high = static_cast<double>((i * i) >> 32);
    const double remainder = static_cast<double>(i % 7);
    const double unsigned_high = static_cast<double>((std::uint64_t{low} * 0xdeadbeefu) >> 32);
    const double expected = exponent * (mantissa + std::fmod(p.x, static_cast<double>(0.3f))) +
                            (high * remainder + unsigned_high) + exponent;
    CHECK(again.evaluate(p, 0).f == doctest::Approx(expected).epsilon(1e-12));
    CHECK(snippet(program).evaluate(p, 0).f == doctest::Approx(expected).epsilon(1e-12));
  }
}

TEST_CASE("a value is read before its variable changes, however late it is used") {
  // old = v; v = v + 1; result = old * 10 + v, v starting at x
  Program program;
  program.constants = {{Type::real, bits(1.0f)}, {Type::real, bits(10.0f)}};
  program.variables = {Type::real};
  program.temporaries = {Type::real, Type::real, Type::real, Type::real};
  program.instructions = {{Op::f_copy, 6, {0}}, {Op::f_copy, 7, {6}},   {Op::f_add, 8, {6, 4}},
                          {Op::f_copy, 6, {8}}, {Op::f_mul, 9, {7, 5}}, {Op::f_add, 10, {9, 6}}};
  Node run;
  run.count = 6;
  program.body = {run};
  program.result = 10;
  const Snippet original = snippet(program);
  CHECK(original.evaluate({0.5, 0, 0}, 0).f == 0.5 * 10 + 1.5);
  check_same(original);
}

TEST_CASE("an array element is read before it changes, and no index leaves the array") {
  check_same(snippet(read_body(R"(
    float a[3] = float[3](1.0, 2.0, p.z);
    int i = int(floor(p.x * 8.0));
    float old = a[clamp(i, 0, 2)];
    a[clamp(i, 0, 2)] = p.y;
    return old * 100.0 + a[1];)")));
  const std::string text =
      snippet(read_body("float a[3] = float[3](1.0, 2.0, 4.0); return a[int(p.x * 8.0)];")).glsl("f", 0);
  CHECK(has(text, "float a0[3] = float[3](1.0, 2.0, 4.0);"));
  CHECK(has(text, "a0[clamp(int(8.0 * p.x), 0, 2)]") != has(text, "a0[clamp(int(p.x * 8.0), 0, 2)]"));
}

TEST_CASE("control flow: exits of loops and blocks at every depth") {
  for (const char* body : {
           // a return from the middle of nested loops
           "for (int i = 0; i < 4; ++i) for (int j = 0; j < 4; ++j) { if (p.x * 4.0 < float(i * j)) return float(i - "
           "j); }"
           " return p.y;",
           // continue with a step that matters
           "float s = 0.0; for (int i = 0; i < 9; i += 2) { if (p.x > 0.1 * float(i)) continue; s += float(i); } "
           "return s;",
           // do-while with continue and break
           "float s = p.x; int n = 0; do { ++n; s = s * 1.5 + 0.25; if (s < 0.0) continue; if (s > 3.0) break; s += "
           "0.1; }"
           " while (n < 6); return s;",
           // a switch that falls through, inside a loop that it repeats
           "float s = 0.0; for (int i = 0; i < 5; ++i) { switch (int(p.x * 3.0) + i) { case 0: s += 1.0; case 1: s += "
           "10.0;"
           " break; case 2: continue; default: s -= p.y; } s += 0.5; } return s;",
           // returns that leave nothing behind, on both sides
           "if (p.x < 0.0) { if (p.y < 0.0) return 1.0; if (p.z < 0.0) return 2.0; } else { if (p.y < 0.5) return 3.0; "
           "}"
           " return 4.0 + p.x;",
           "float s = 1.0; while (s < 50.0) { s *= 1.0 + abs(p.x); if (s > 10.0 && p.y > 0.0) break; s += 1.0; } "
           "return s;",
       }) {
    check_same(snippet(read_body(body)));
  }
}

TEST_CASE("early returns become branches, not switches") {
  const std::string text =
      snippet(read_body("if (p.x > 0.5) return p.x; if (p.y > 0.5) return p.y; return p.z;")).glsl("f", 0);
  CHECK_FALSE(has(text, "switch"));
  CHECK_FALSE(has(text, "break"));
}

TEST_CASE("time: a static snippet has none of it") {
  const Snippet still = snippet(read_body("return length(p) - 0.5 * cos(1.0) + 0.0;"));
  CHECK(still.time_value_count() == 0);
  CHECK(still.time_values(1234.5).empty());
  CHECK_FALSE(has(still.glsl("f", 0), "time"));
}

TEST_CASE("time: what depends on t alone leaves the shader, whole") {
  const Snippet moving =
      snippet(read_body("float a = sin(t / 1000.0) * 0.5 + 0.25; return length(p - vec3(a, a, 0.0)) - a * a;"));
  const std::string text = moving.glsl("f", 0);
  CHECK(moving.time_value_count() == 2);
  CHECK_FALSE(has(code_of(text), "sin"));
  const auto values = moving.time_values(777.0);
  const double a = std::sin(0.777) * 0.5 + 0.25;
  CHECK(values[0] == static_cast<float>(a));
  CHECK(values[1] == static_cast<float>(a * a));
}

TEST_CASE("time: exact for long runs") {
  for (const double t : {0.0, 1.0, 3'600'000.0, 3'600'000.25, 86'400'000.0, 31'536'000'000.0}) {
    CAPTURE(t);
    CHECK(error_of("return sin(t / 1000.0);", t, std::sin(t / 1000.0)) <= 1e-7);
    // The period is the float 6.2831853, as the author's literal says.
    const double angle = std::fmod(t, 4000.0) / 4000.0 * static_cast<double>(6.2831853f);
    CHECK(error_of("return cos(mod(t, 4000.0) / 4000.0 * 6.2831853);", t, std::cos(angle)) <= 1e-7);
  }
}

TEST_CASE("time: two frames of an hour-long run differ as they should") {
  // float32 steps by 0.25 ms at an hour: 0.1 ms would be lost.
  const Snippet moving = snippet(read_body("return p.x - sin(t / 1000.0);"));
  const double t = 3'600'000.0;
  const float before = moving.time_values(t)[0], after = moving.time_values(t + 0.1)[0];
  CHECK(after - before == doctest::Approx(std::sin((t + 0.1) / 1000) - std::sin(t / 1000)).epsilon(0.01));
}

TEST_CASE("time: a phase added to space is reduced by its period where float32 would lose it") {
  const Snippet wave = snippet(read_body("return sin(8.0 * p.x + 0.25 * t) + fract(p.y - t * 0.5);"));
  for (const double t : {3'600'000.0, 86'400'007.0}) {
    for (const float value : wave.time_values(t)) CHECK(std::abs(value) <= std::numbers::pi_v<float>);
    const Snippet shader = snippet(read_back(wave, t));
    for (const glm::dvec3& p : points_of_cube(100)) {
      const double turned = std::sin(8.0 * p.x + 0.25 * t), moved = p.y - t * 0.5;
      // The phase is rounded once: half an ulp of pi, and of 1.
      CHECK(std::abs(shader.evaluate(p, t).f - turned - (moved - std::floor(moved))) <= 2e-7);
    }
  }
}

TEST_CASE("time: a phase that is used for more than its period is not reduced") {
  const Snippet both = snippet(read_body("float a = p.x + 0.25 * t; return sin(a) + 0.001 * a;"));
  REQUIRE(both.time_value_count() == 1);
  CHECK(both.time_values(4'000'000.0)[0] == 1'000'000.0f);
  const Snippet small = snippet(read_body("return sin(p.x + 0.25 * t);"));
  CHECK(small.time_values(400.0)[0] == 100.0f);  // nothing to win below 256
  const Snippet scaled = snippet(read_body("return sin(3.0 * (p.x + 0.25 * t));"));
  CHECK(scaled.time_values(4'000'000.0)[0] == 1'000'000.0f);
}

TEST_CASE("time: decisions and whole numbers stay exact") {
  // At 40,000,001 ms neither t nor t / 7 is a float.
  const Snippet counted = snippet(read_body("int n = int(t); return p.x * float(n % 7) + float(n % 1000);"));
  const Snippet chosen = snippet(
      read_body("int n = int(t); float a[2] = float[2](p.x, p.y); return a[n & 1] + (t < 40000001.0 ? p.x : p.z);"));
  const Snippet words = snippet(read_body(
      "uint n = uint(t) * 2654435769u; return p.x * float((n >> 5) % 11u) + (p.y > 0.0 ? float(n & 3u) : 0.5);"));
  for (const double t : {0.0, 7.0, 39'999'999.0, 40'000'001.0, 40'000'003.0}) {
    for (const Snippet& each : {counted, chosen, words}) check_same(each, t);
  }
}

TEST_CASE("time: loops, branches and arrays that only t decides over are gone") {
  const Snippet stepped = snippet(read_body(R"(
    float a[3] = float[3](0.0, 0.5, t * 0.125);
    int n = int(mod(floor(t * 0.5), 5.0));
    float s = 0.0;
    for (int i = 0; i < n; ++i) {
      if (i == 3) continue;
      s += a[i % 3];
    }
    return p.x * s;)"));
  CHECK(stepped.time_value_count() == 1);
  CHECK_FALSE(has(code_of(stepped.glsl("f", 0)), "for"));
  // n = 4: i = 0, 1, 2 (3 is left out), so 0 + 0.5 + 8/8
  CHECK(stepped.time_values(8.0)[0] == 1.5f);
  CHECK(stepped.time_values(2.0)[0] == 0.0f);
}

TEST_CASE("time: what changes from round to round stays, with its parts hoisted") {
  const Snippet rounds = snippet(read_body(R"(
    float d = 1.0;
    for (int i = 0; i < 4; ++i) d = min(d, abs(p.x - float(i) * sin(t * 0.25)));
    return d;)"));
  CHECK(rounds.time_value_count() == 1);
  CHECK_FALSE(has(code_of(rounds.glsl("f", 0)), "sin"));
  for (const double t : {0.0, 3.0, 1000.0}) {
    const Snippet again = snippet(read_back(rounds, t));
    for (const glm::dvec3& p : points_of_cube(50)) {
      double d = 1.0;
      for (int i = 0; i < 4; ++i) d = std::min(d, std::abs(p.x - i * std::sin(t * 0.25)));
      CHECK(again.evaluate(p, t).f == doctest::Approx(d).epsilon(1e-6));
    }
  }
}

TEST_CASE("time: a variable of t is read where it stands, not where it ends") {
  const Snippet changing = snippet(read_body(R"(
    float a = t;
    if (t > 4.0) a = 2.0 * t;
    float early = p.x * a;
    if (p.y > 0.0) early += a;
    a += 1.0;
    while (a < 100.0) a *= 2.0;
    return early + p.z * a;)"));
  for (const double t : {1.0, 8.0, 64.0, 200.0}) check_same(changing, t);
}

TEST_CASE("time: more values than a shader should read give t alone") {
  std::string body = "float d = 0.0;\n";
  for (int i = 0; i < 600; ++i) body += fmt::format("d += p.x * sin(t * {}.0);\n", i + 1);
  const Snippet busy = snippet(read_body(body + "return d;"));
  CHECK(busy.time_value_count() == 1);
  CHECK(busy.time_values(2.5)[0] == 2.5f);
  check_same(busy, 2.5);
}

TEST_CASE("time: float32 intervals hold what a device makes of time values, over moments and spans") {
  const char* const bodies[] = {
      "return length(p) - 0.5 - 0.1 * sin(t / 1000.0);",
      "return sin(8.0 * p.x + 0.25 * t) + fract(p.y + t * 0.001);",
      "return p.x - cos(p.y - (t / 7.0 - p.z));",
      "int i = int(t) % 7; return p.x * float(i) + (mod(t, 2.0) < 1.0 ? p.y : p.z);",
      "uint h = uint(t) * 2654435761u; return p.x + float(h >> 8) / 16777216.0 + float(int(h)) * 1e-9 * p.y;",
      "return p.x * t + p.y;",
      "bool late = t > 5000.0; return late ? p.x : p.y * 2.0;",
      "float s = p.x; for (int i = 0; i < 5; ++i) s += 0.1 * sin(float(i) * p.y + 0.001 * t * float(i)); return s;",
      "return sin(3.0 * (p.x + t)) + tan(0.1 * p.y) * cos(t + p.z);",
  };
  tests::Random random(5);
  for (const char* body : bodies) {
    CAPTURE(body);
    const auto program = read_body(body);
    const Snippet original = snippet(program);
    for (int round = 0; round < 60; ++round) {
      const double first = std::exp2(random.in(0.0, 36.0));
      const double span = round % 2 == 0 ? 0.0 : std::exp2(random.in(-3.0, 14.0));
      for (const double t : {first, first + 0.37 * span, first + span}) {
        const auto emitted = read_back(original, t);
        for (const glm::dvec3& p : points_of_cube(4)) {
          const Interval bound = original.evaluate({p, p}, {first, first + span}, Rounding::float32);
          const double device = evaluate_point<float>(emitted, {float(p.x), float(p.y), float(p.z), 0.0f}).f;
          const double exact = original.evaluate(p, t).f;
          CAPTURE(t);
          CAPTURE(span);
          CHECK_MESSAGE((bound.maybe_nan || (bound.lo <= device && device <= bound.hi)),
                        fmt::format("device {} not in [{}, {}]", device, bound.lo, bound.hi));
          CHECK_MESSAGE((bound.maybe_nan || (bound.lo <= exact && exact <= bound.hi)),
                        fmt::format("{} not in [{}, {}]", exact, bound.lo, bound.hi));
        }
      }
    }
  }
}

TEST_CASE("time: float32 intervals stay narrow far into a run") {
  for (const double t : {0.0, 3'600'000.25, 86'400'000.0, 31'536'000'000.0}) {
    for (const char* body : {"return length(p) - 0.5 - 0.1 * sin(t / 1000.0);", "return sin(8.0 * p.x + 0.25 * t);",
                             "return p.x + fract(p.y + t * 0.001);"}) {
      CAPTURE(body);
      CAPTURE(t);
      const Interval bound =
          snippet(read_body(body)).evaluate({glm::dvec3(0.3), glm::dvec3(0.3)}, {t, t}, Rounding::float32);
      CHECK_FALSE(bound.maybe_nan);
      CHECK(bound.hi - bound.lo < 1e-5);
    }
  }
}

namespace {

/// Bodies made at random: assignments to three floats and an array, branches, loops with exits, early returns, over p
/// and t. Numbers are small dyadic fractions, so that float32 is exact and every comparison can ask for equality.
class RandomBody {
 public:
  explicit RandomBody(std::uint32_t seed) : random_(seed) {}

  std::string make() {
    return "float a = p.x, b = t, c = 0.5;\nfloat m[3] = float[3](t, 1.0, p.y);\nint n = int(t);\n" +
           statements(4, 0, false) + "return a + b + c + m[1] + float(n);\n";
  }

 private:
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(random_()) % count; }
  const char* any_of(std::initializer_list<const char*> choices) {
    return *(choices.begin() + below(static_cast<std::uint32_t>(choices.size())));
  }
  const char* leaf() {
    return any_of({"p.x", "p.y", "p.z", "t", "a", "b", "c", "0.25", "1.0", "-2.0", "m[0]", "m[2]"});
  }
  const char* variable() { return any_of({"a", "b", "c", "m[1]", "m[n & 1]", "m[2]"}); }

  std::string value() {
    switch (below(5)) {
      case 0:
        return leaf();
      case 1:
        return fmt::format("min({}, {} + 0.5)", leaf(), leaf());
      case 2:
        return fmt::format("clamp({} - {}, -4.0, 4.0)", leaf(), leaf());
      case 3:
        return fmt::format("({} < {} ? {} : 0.5 * t)", leaf(), leaf(), leaf());
      default:
        return fmt::format("0.5 * (abs({}) - {})", leaf(), leaf());
    }
  }

  std::string condition() {
    switch (below(3)) {
      case 0:
        return fmt::format("t < {}.0", below(6));
      case 1:
        return fmt::format("{} > {}", leaf(), leaf());
      default:
        return fmt::format("n + {} < 5", below(6));
    }
  }

  std::string statements(int count, int depth, bool in_loop) {
    std::string text;
    for (int i = 0; i < count; ++i) text += statement(depth, in_loop);
    return text;
  }

  std::string statement(int depth, bool in_loop) {
    switch (below(depth < 3 ? 9 : 4)) {
      case 4:
        return fmt::format("if ({}) {{\n{}}}\n", condition(), statements(2, depth + 1, in_loop));
      case 5:
        return fmt::format("if ({}) {{\n{}}} else {{\n{}}}\n", condition(), statements(2, depth + 1, in_loop),
                           statements(1, depth + 1, in_loop));
      case 6:
      case 7:
        return fmt::format("for (int i{0} = 0; i{0} < {1}; ++i{0}) {{\n{2}}}\n", depth,
                           below(3) == 0 ? "n" : any_of({"2", "3"}), statements(3, depth + 1, true));
      case 8:
        if (!in_loop) return fmt::format("if ({}) return {};\n", condition(), value());
        return fmt::format("if ({}) {};\n", condition(), any_of({"break", "continue", "return a - b"}));
      default:
        break;
    }
    if (below(6) == 0) return "n = (n + 1) & 3;\n";
    return fmt::format("{} = clamp({}, -8.0, 8.0);\n", variable(), value());
  }

  std::mt19937 random_;
};

}  // namespace

TEST_CASE("programs made at random say the same when emitted, at every time") {
  std::size_t moving = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    const std::string body = RandomBody(seed).make();
    CAPTURE(body);
    const Snippet original = snippet(read_body(body));
    if (original.uses_time()) ++moving;
    for (const double t : {0.0, 1.0, 2.5, 4.0}) {
      const Snippet again = snippet(read_back(original, t));
      for (const glm::dvec3& p : points_of_cube(12)) {
        const double expected = original.evaluate(p, t).f, got = again.evaluate(p, t).f;
        CHECK_MESSAGE(got == expected, original.glsl("f", 0));
      }
    }
  }
  CHECK(moving > 60);
}
