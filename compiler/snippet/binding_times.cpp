// Levels rise until nothing changes any more: what a loop assigns may be read further up, in its next round.
#include "compiler/snippet/binding_times.h"

#include <algorithm>

#include "compiler/snippet/operands.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr int most_rounds = 32;  // of the fixed point; more than a handful is no program of a person

}  // namespace

Levels::Levels(const Program& program, bool only_t)
    : program_(program),
      only_t_(only_t),
      registers_(program.register_count(), Level::constant),
      arrays_(program.arrays.size(), Level::constant) {
  for (const Register r : {Program::p_x, Program::p_y, Program::p_z}) registers_[r] = Level::space;
  registers_[Program::t] = Level::time;
  for (int round = 0; round < most_rounds && changed_; ++round) {
    changed_ = false;
    visit(program.body, Level::constant);
  }
  if (changed_) give_up();
}

Level Levels::of(const Instruction& instruction) const {
  return is_store(instruction) ? arrays_[instruction.operands[0]] : registers_[instruction.result];
}

Level Levels::control(const Node& node, Level outside) const {
  if (node.kind == Node::Kind::branch) return std::max(outside, of(node.condition));
  return std::max({outside, exits(node.body, Level::constant), exits(node.other, Level::constant)});
}

/// The highest level that decides over an exit to outside the sequence.
Level Levels::exits(const Sequence& sequence, Level decided) const {
  Level highest = Level::constant;
  for (const Node& node : sequence) {
    if (node.kind == Node::Kind::leave || node.kind == Node::Kind::repeat) highest = std::max(highest, decided);
    if (node.kind == Node::Kind::branch) {
      const Level inside = std::max(decided, of(node.condition));
      highest = std::max({highest, exits(node.body, inside), exits(node.other, inside)});
    }
    // Leaving a block goes no further, but then what decides over it also decides over a repeat after it.
    if (node.kind == Node::Kind::block && repeats(node.body)) highest = std::max(highest, exits(node.body, decided));
  }
  return highest;
}

void Levels::visit(const Sequence& sequence, Level decided) {
  for (const Node& node : sequence) {
    if (node.kind == Node::Kind::run) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) assign(program_.instructions[i], decided);
    } else {
      const Level inside = control(node, decided);
      visit(node.body, inside);
      visit(node.other, inside);
    }
  }
}

void Levels::assign(const Instruction& instruction, Level decided) {
  Level level = Level::constant;
  for_operands(instruction, [&](std::size_t k, char letter) {
    const Register operand = instruction.operands[k];
    level = std::max(
        level, letter == 'a' ? (is_store(instruction) ? Level::constant : arrays_[operand]) : registers_[operand]);
  });
  if (only_t_ && level == Level::time) level = Level::space;
  const bool temporary = !is_store(instruction) && program_.is_temporary(instruction.result);
  raise(is_store(instruction) ? arrays_[instruction.operands[0]] : registers_[instruction.result],
        temporary ? level : std::max(level, decided));
}

void Levels::raise(Level& level, Level to) {
  if (to <= level) return;
  level = to;
  changed_ = true;
}

/// All variables and arrays depend on space: a fixed point in one round.
void Levels::give_up() {
  std::fill(registers_.begin() + program_.first_variable(), registers_.begin() + program_.first_temporary(),
            Level::space);
  std::ranges::fill(arrays_, Level::space);
  visit(program_.body, Level::constant);
}

}  // namespace dmvv::compiler::snippet
