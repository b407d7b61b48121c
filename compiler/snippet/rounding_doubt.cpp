#include "compiler/snippet/rounding_doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "compiler/snippet/device_values.h"
#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/time_values.h"

namespace dmvv::compiler::snippet {
namespace {

constexpr double least_factor = 100.0;  // that a message names

const Instruction* made_by(const Program& program, Register r) {
  if (!program.is_temporary(r)) return nullptr;
  const auto found = std::ranges::find_if(program.instructions, [r](const Instruction& instruction) {
    return info(instruction.op).result != '-' && instruction.result == r;
  });
  return found == program.instructions.end() ? nullptr : &*found;
}

std::string_view name_of(Op op) {
  switch (op) {
    case Op::f_fract:
      return "fract";
    case Op::f_floor:
      return "floor";
    case Op::f_ceil:
      return "ceil";
    case Op::f_trunc:
      return "trunc";
    case Op::f_round:
      return "round";
    case Op::f_mod:
    case Op::f_rem:
      return "mod";
    default:
      return "the whole part";
  }
}

/// "a product of 43758.5 and a sine", as far as it is one.
std::string operand_in_words(const Program& program, Register operand) {
  const Instruction* product = made_by(program, operand);
  if (product == nullptr || product->op != Op::f_mul) return "a value";
  auto [factor, other] = std::pair(product->operands[0], product->operands[1]);
  if (program.is_constant(other)) std::swap(factor, other);
  if (!program.is_constant(factor)) return "a product";
  const double value = std::bit_cast<float>(program.constant(factor).bits);
  if (!(std::abs(value) >= least_factor)) return "a product";
  const Instruction* wave = made_by(program, other);
  const bool is_sine = wave != nullptr && wave->op == Op::f_sin, is_cosine = wave != nullptr && wave->op == Op::f_cos;
  return fmt::format("a product of {:.6g} and {}", value, is_sine ? "a sine" : is_cosine ? "a cosine" : "a value");
}

}  // namespace

RoundingDoubt rounding_doubt(const Snippet& snippet, const glm::vec3& p, float t_ms) {
  const TimeSplit& split = snippet.time_split();
  const Program& program = split.residual;
  const std::array<Interval, Program::input_count> inputs{Interval{p.x, p.x}, {p.y, p.y}, {p.z, p.z}, {t_ms, t_ms}};
  const BoxAndJump found = evaluate_box_and_jump(program, inputs, device_values(split, {t_ms, t_ms}));
  RoundingDoubt doubt;
  doubt.bounds = found.value;
  doubt.exact = snippet.evaluate(glm::dvec3(p), t_ms).f;
  doubt.single = snippet.evaluate_single(p, t_ms);
  if (!found.jump) return doubt;
  const Instruction& jump = program.instructions[found.jump->instruction];
  doubt.jump = fmt::format("{} of {}", name_of(jump.op), operand_in_words(program, jump.operands[0]));
  doubt.operand_width = found.jump->operand_width;
  return doubt;
}

}  // namespace dmvv::compiler::snippet
