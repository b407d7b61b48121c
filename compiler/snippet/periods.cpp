// Periods are carried backward, from sines and fractions through sums to their summands.
#include "compiler/snippet/periods.h"

#include "compiler/snippet/operands.h"

namespace dmvv::compiler::snippet {

Periods::Periods(const Program& program) : program_(program), periods_(program.register_count(), unused) {
  if (program.result < periods_.size()) periods_[program.result] = Period::none;
  std::vector<std::uint32_t> order;
  list(program.body, order);
  for (auto i = order.rbegin(); i != order.rend(); ++i) {  // every use of a temporary comes after it
    const Instruction& instruction = program.instructions[*i];
    for_operands(instruction, [&](std::size_t k, char letter) {
      if (letter != 'f') return;
      Period& period = periods_[instruction.operands[k]];
      const Period here = of_use(instruction, k);
      period = period == unused || period == here ? here : Period::none;
    });
  }
}

Period Periods::of_use(const Instruction& instruction, std::size_t k) const {
  switch (instruction.op) {
    case Op::f_sin:
    case Op::f_cos:
    case Op::f_tan:
      return Period::turn;
    case Op::f_fract:
      return Period::one;
    case Op::f_fma:
      if (k != 2) return Period::none;
      break;
    case Op::f_add:
    case Op::f_sub:
    case Op::f_neg:
      break;
    default:
      return Period::none;
  }
  const Period period = program_.is_temporary(instruction.result) ? periods_[instruction.result] : Period::none;
  return period == unused ? Period::none : period;
}

void Periods::list(const Sequence& sequence, std::vector<std::uint32_t>& order) const {
  for (const Node& node : sequence) {
    for (std::uint32_t i = 0; i < node.count; ++i) order.push_back(node.first + i);
    list(node.body, order);
    list(node.other, order);
  }
}

}  // namespace dmvv::compiler::snippet
