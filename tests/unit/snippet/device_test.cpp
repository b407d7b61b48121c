// Every operation on the device, over all magnitudes, against double: within the bounds that IntervalDomain<float32>
// gives it (interval.h). Prints the largest error as a share of its bound.
#include <algorithm>
#include <bit>
#include <limits>

#include "compiler/compile.h"
#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/interval.h"
#include "compiler/snippet/machine.h"
#include "device_program.h"
#include "emitted.h"
#include "runtime/runtime.h"

using namespace dmvv;
using namespace dmvv::tests;
using namespace dmvv::compiler::snippet;

namespace {

using Domain = IntervalDomain<Rounding::float32>;

runtime::Device open_device() {
  auto opened = runtime::Device::create({.name = "", .validation = true});
  REQUIRE_MESSAGE(opened, opened.error().message);
  return std::move(*opened);
}

/// The values of a snippet at points, as the device computes them.
std::vector<double> on_device(runtime::Device& device, const Snippet& snippet, const std::vector<glm::dvec3>& points) {
  compiler::Program program = points_program(snippet);
  const auto compiled = compiler::to_spirv(program, compiler::Source::points);
  REQUIRE_MESSAGE(compiled, (compiled ? std::string() : compiled.error().reasons.at(0)));
  auto evaluator = runtime::Evaluator::create(device, program);
  REQUIRE_MESSAGE(evaluator, evaluator.error().message);
  const auto answers = evaluator->probe(points);
  REQUIRE_MESSAGE(answers, answers.error().message);
  std::vector<double> values;
  for (const auto& answer : *answers) values.push_back(answer.rgba.r);
  return values;
}

/// Floats of every magnitude and sign, densely where functions turn, and the special ones. NaN is left out: what
/// becomes of it is open.
class Floats {
 public:
  double next() {
    const double sign = random_() % 2 == 0 ? 1.0 : -1.0;
    switch (random_() % 8) {
      case 0:
        return special[random_() % std::size(special)];
      case 1:
        return rounded(sign * std::exp2(in(-149.0, 128.0)));
      case 2:
        return rounded(sign * std::exp2(in(-30.0, 24.0)));
      case 3:
        return rounded(sign * (1.0 - std::exp2(in(-24.0, 0.0))));
      case 4:
        return rounded(sign * (1.0 + std::exp2(in(-23.0, 0.0))));
      case 5:
        return rounded(in(-100.0, 100.0));
      default:
        return rounded(in(-4.0, 4.0));
    }
  }

 private:
  static double rounded(double x) { return static_cast<double>(static_cast<float>(x)); }
  double in(double lo, double hi) { return lo + (hi - lo) * (static_cast<double>(random_()) * 0x1p-32); }

  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr double special[] = {0.0,
                                       -0.0,
                                       1.0,
                                       -1.0,
                                       0.5,
                                       2.0,
                                       3.0,
                                       -0.5,
                                       1e-45f,
                                       -1e-45f,
                                       0x1p-126,
                                       std::numeric_limits<float>::max(),
                                       -std::numeric_limits<float>::max(),
                                       infinity,
                                       -infinity,
                                       88.0,
                                       -88.0,
                                       1.5707964f,
                                       3.1415927f};
  std::mt19937 random_{12};
};

constexpr Op all_ops[] = {
#define DMVV_OP(name, result, operands) Op::name,
#include "compiler/snippet/ops.def"
#undef DMVV_OP
};

/// `result = op(p.x, p.y, p.z)`, integer operands by conversion.
Program program_of(Op op) {
  const OpInfo& table = info(op);
  Program program;
  std::array<Register, 3> operands{};
  const auto add = [&](Type type, Op made, std::array<Register, 3> from) {
    program.temporaries.push_back(type);
    program.instructions.push_back({made, program.register_count() - 1, from});
    return program.register_count() - 1;
  };
  for (std::size_t k = 0; k < table.operands.size(); ++k) {
    const auto input = static_cast<Register>(k);
    operands[k] = table.operands[k] == 'i' ? add(Type::integer, Op::i_from_f, {input}) : input;
  }
  program.result = add(Type::real, op, operands);
  Node run;
  run.count = static_cast<std::uint32_t>(program.instructions.size());
  program.body.push_back(run);
  return program;
}

bool is_measured(Op op) {
  const OpInfo& table = info(op);
  return table.result == 'f' && table.operands.find_first_not_of("fi") == std::string_view::npos && op != Op::f_from_i;
}

struct Worst {
  double share = 0.0;  ///< of the bound
  double error = 0.0, relative = 0.0;
  glm::dvec3 at{0.0};
  double got = 0.0, exact = 0.0;
  std::size_t bounded = 0;  ///< points where there is a finite bound
};

/// Fails where a value is outside of its interval.
Worst measure(Op op, const std::vector<glm::dvec3>& points, const std::vector<double>& got) {
  const OpInfo& table = info(op);
  const Instruction instruction{.op = op, .result = 3, .operands = {0, 1, 2}};
  Worst worst;
  std::size_t outside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Cell<Domain> boxes[4];
    Cell<PointDomain<double>> cells[4];
    for (int k = 0; k < 3; ++k) {
      const double x = points[i][k];
      boxes[k].f = Domain::flushed({x, x});
      cells[k].f = x;
      if (static_cast<std::size_t>(k) >= table.operands.size() || table.operands[static_cast<std::size_t>(k)] != 'i')
        continue;
      boxes[k].i = Domain::i_from_f({x, x});
      cells[k].i = static_cast<std::uint32_t>(PointDomain<double>::i_from_f(x));
    }
    execute<Domain>(instruction, boxes);
    execute<PointDomain<double>>(instruction, cells);
    const Interval& bound = boxes[3].f;
    const double exact = cells[3].f;
    const bool holds = std::isnan(got[i]) ? bound.maybe_nan : bound.lo <= got[i] && got[i] <= bound.hi;
    if (!holds && !bound.maybe_nan && ++outside < 4) {
      FAIL_CHECK(fmt::format("{}({}, {}, {}): {} not in [{}, {}], {} in double", table.name, points[i].x, points[i].y,
                             points[i].z, got[i], bound.lo, bound.hi, exact));
    }
    if (!std::isfinite(bound.lo) || !std::isfinite(bound.hi) || bound.maybe_nan || !std::isfinite(exact)) continue;
    ++worst.bounded;
    const double error = got[i] - exact, allowed = error < 0.0 ? exact - bound.lo : bound.hi - exact;
    if (std::abs(error) <= 0x1p-126) continue;  // may be flushed
    if (!(allowed > 0.0) || std::abs(error) / allowed <= worst.share) continue;
    worst = {
        std::abs(error) / allowed, std::abs(error), std::abs(error / exact), points[i], got[i], exact, worst.bounded};
  }
  CHECK(outside == 0);
  return worst;
}

}  // namespace

TEST_CASE("each operation of the device errs no more than its bound") {
  runtime::Device device = open_device();
  for (const Op op : all_ops) {
    if (!is_measured(op)) continue;
    Floats floats;
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 40000; ++i) {
      const double x = floats.next(), y = floats.next();
      points.push_back({x, y, floats.next()});
    }
    const Worst worst = measure(op, points, on_device(device, snippet(program_of(op)), points));
    MESSAGE(fmt::format("{:<18} {:.2f} of its bound; {} off, {} relative, at {} {} {}: {} for {}", info(op).name,
                        worst.share, worst.error, worst.relative, worst.at.x, worst.at.y, worst.at.z, worst.got,
                        worst.exact));
    CHECK(worst.share <= 1.0);
    CHECK(worst.bounded > points.size() / 10);
  }
  for (const std::string& message : device.validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("what a driver may rewrite stays within the interval, without precise") {
  // Rewritten by a law of the reals, an expression has the value that double has: intervals hold both. Where the law
  // fails (an infinity, a zero divisor), they allow a NaN, and with it anything.
  runtime::Device device = open_device();
  const std::vector<glm::dvec3> points = points_of_cube(512);
  for (const char* body : {
           "return (p.x + p.y) - p.y;",
           "return (p.x + 12582912.0) - 12582912.0;",
           "return (1e10 + p.x) - 1e10 - p.x;",
           "float big = 1e38 * (2.0 + p.x); float inf = big * 10.0; return (inf - inf) + p.y;",
           "float inf = exp(200.0 + p.x); return inf * 0.0 + p.y;",
           "float z = p.x - p.x; return p.y / z;",
           "float z = p.x - p.x; return z / z + p.y;",
           "return p.x * p.y / p.y;",
           "return sqrt(p.x) * sqrt(p.x);",
           "return sqrt(p.x * p.x) - abs(p.x);",
           "return exp(log(abs(p.x))) - abs(p.x);",
           "return p.x * 3.0 * 0.3333333 - p.x;",
           "return p.x * (p.y + 1e7) - p.x * p.y;",
           "return p.x * 1e7 + p.y * 1e7 - (p.x + p.y) * 1e7;",
           "return 1.0 / (1.0 / (p.x + 3.0)) - 3.0;",
           "return min(sqrt(p.x), 0.25) + max(log(p.y), -0.5);",
           "return !(sqrt(p.x) < p.y) ? 1.0 : 2.0;",
           "return sqrt(p.x) != sqrt(p.x) ? 1.0 : 2.0;",
           "return isnan(sqrt(p.x)) || isinf(1.0 / (p.y - p.y)) ? 1.0 : p.z;",
           "float a = p.x * p.y; return a * a - p.x * p.x * (p.y * p.y);",
           "return mix(p.x, p.y, 1e6 * p.z) - mix(p.x, p.y, 1e6 * p.z + 1.0);",
       }) {
    CAPTURE(body);
    const Snippet shown = snippet(read_body(body));
    const std::vector<double> got = on_device(device, shown, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Interval bound = shown.evaluate({points[i], points[i]}, {0.0, 0.0}, Rounding::float32);
      const bool holds = bound.maybe_nan || (bound.lo <= got[i] && got[i] <= bound.hi);
      CHECK_MESSAGE(holds, fmt::format("{} not in [{}, {}] at {} {} {}", got[i], bound.lo, bound.hi, points[i].x,
                                       points[i].y, points[i].z));
    }
  }
  for (const std::string& message : device.validation_messages()) FAIL_CHECK(message);
}
