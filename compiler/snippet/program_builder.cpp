#include "compiler/snippet/program_builder.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <functional>
#include <utility>

#include "compiler/snippet/operands.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr Register unnumbered = 0xffffffffu;

Op copy_op(Type type) {
  constexpr Op ops[] = {Op::f_copy, Op::i_copy, Op::u_copy, Op::b_copy};
  return ops[static_cast<std::size_t>(type)];
}

bool is_array_op(Op op) { return info(op).operands[0] == 'a'; }

/// Calls visit(register&) for each register an instruction reads.
template <class Instr, class Visit>
void for_each_operand(Instr& instruction, const Visit& visit) {
  const std::string_view operands = info(instruction.op).operands;
  for (std::size_t i = 0; i < operands.size(); ++i) {
    if (operands[i] != 'a') visit(instruction.operands[i]);
  }
}

bool leaves(const Sequence& sequence) {
  return std::any_of(sequence.begin(), sequence.end(), [](const Node& node) {
    return node.kind == Node::Kind::leave || node.kind == Node::Kind::repeat || leaves(node.body) || leaves(node.other);
  });
}

}  // namespace

ProgramBuilder::ProgramBuilder() {
  for (Register i = 0; i < Program::input_count; ++i) add(Type::real, Kind::input);
  begin();
}

Register ProgramBuilder::add(Type type, Kind kind, std::uint32_t bits) {
  registers_.push_back({type, kind, bits});
  return static_cast<Register>(registers_.size() - 1);
}

Register ProgramBuilder::constant(Type type, std::uint32_t bits) {
  const auto [place, is_new] = constants_.try_emplace({type, bits}, 0);
  if (is_new) place->second = add(type, Kind::constant, bits);
  return place->second;
}

Register ProgramBuilder::real(float value) { return constant(Type::real, std::bit_cast<std::uint32_t>(value)); }
Register ProgramBuilder::integer(std::int32_t value) {
  return constant(Type::integer, static_cast<std::uint32_t>(value));
}
Register ProgramBuilder::variable(Type type) { return add(type, Kind::variable); }

Register ProgramBuilder::array(Type type, std::uint32_t size) {
  arrays_.push_back({type, size});
  return static_cast<Register>(arrays_.size() - 1);
}

void ProgramBuilder::push(const Instruction& instruction) {
  Sequence& sequence = scopes_.back().sequence;
  const auto here = static_cast<std::uint32_t>(instructions_.size());
  const bool joins = !sequence.empty() && sequence.back().kind == Node::Kind::run &&
                     sequence.back().first + sequence.back().count == here;
  if (!joins) sequence.push_back({.kind = Node::Kind::run, .first = here, .count = 0, .body = {}, .other = {}});
  ++sequence.back().count;
  instructions_.push_back(instruction);
}

Register ProgramBuilder::emit(Op op, std::initializer_list<Register> operands) {
  assert(operands.size() == info(op).operands.size());
  Instruction instruction{.op = op};
  std::copy(operands.begin(), operands.end(), instruction.operands.begin());
  const Key key{op, instruction.operands};
  if (!is_array_op(op)) {
    const auto [place, is_new] = known_.try_emplace(key, 0);
    if (!is_new) return place->second;
    scopes_.back().known.push_back(key);
    place->second = static_cast<Register>(registers_.size());
  }
  instruction.result = add(type_of_letter(info(op).result), Kind::temporary);
  push(instruction);
  return instruction.result;
}

void ProgramBuilder::store(Op op, Register array, Register index, Register value) {
  push({.op = op, .operands = {array, index, value}});
}

void ProgramBuilder::assign(Register variable, Register value) {
  if (variable != value) push({.op = copy_op(type(variable)), .result = variable, .operands = {value}});
}

Register ProgramBuilder::copy(Register value) {
  const Register result = add(type(value), Kind::temporary);
  push({.op = copy_op(type(value)), .result = result, .operands = {value}});
  return result;
}

void ProgramBuilder::begin() { scopes_.emplace_back(); }

Sequence ProgramBuilder::end() {
  for (const Key& key : scopes_.back().known) known_.erase(key);
  Sequence sequence = std::move(scopes_.back().sequence);
  scopes_.pop_back();
  return sequence;
}

void ProgramBuilder::append(Node node) { scopes_.back().sequence.push_back(std::move(node)); }

void ProgramBuilder::append(Sequence sequence) {
  for (Node& node : sequence) append(std::move(node));
}

/// Makes variables of temporaries that are used outside the sequence that assigns them.
void ProgramBuilder::promote(const Sequence& sequence, std::vector<bool>& visible) {
  std::vector<Register> mine;
  const auto use = [&](Register r) {
    if (registers_[r].kind == Kind::temporary && !visible[r]) registers_[r].kind = Kind::variable;
  };
  for (const Node& node : sequence) {
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      for_each_operand(instructions_[i], use);
      if (is_store(instructions_[i].op)) continue;
      visible[instructions_[i].result] = true;
      mine.push_back(instructions_[i].result);
    }
    if (node.kind == Node::Kind::branch) use(node.condition);
    promote(node.body, visible);
    promote(node.other, visible);
  }
  for (const Register r : mine) visible[r] = false;
}

/// Removes instructions whose result nothing needs, and branches that have become empty.
void ProgramBuilder::remove_dead(Sequence& body, Register result) {
  std::vector<bool> live(registers_.size()), live_array(arrays_.size());
  std::vector<bool> kept(instructions_.size());
  live[result] = true;
  bool changed = true;

  const auto mark = [&](Register& r) {
    if (!live[r]) changed = live[r] = true;
  };
  const std::function<bool(Sequence&)> visit = [&](Sequence& sequence) {  // true if it does something
    bool does = false;
    for (auto node = sequence.rbegin(); node != sequence.rend(); ++node) {
      const bool inner = static_cast<int>(visit(node->other)) | static_cast<int>(visit(node->body));
      const bool needed = inner || node->kind == Node::Kind::loop || leaves(node->body) || leaves(node->other) ||
                          node->kind == Node::Kind::leave || node->kind == Node::Kind::repeat;
      if (node->kind == Node::Kind::branch && needed) mark(node->condition);
      does |= needed;
      for (std::uint32_t i = node->first + node->count; i-- > node->first;) {
        Instruction& instruction = instructions_[i];
        const bool store = is_store(instruction.op);
        if (!kept[i] && (store ? live_array[instruction.operands[0]] : live[instruction.result])) {
          kept[i] = changed = true;
          for_each_operand(instruction, mark);
          if (!store && is_array_op(instruction.op)) live_array[instruction.operands[0]] = true;
        }
        does |= kept[i];
      }
    }
    return does;
  };
  while (std::exchange(changed, false)) visit(body);

  std::vector<Instruction> instructions;
  const std::function<void(Sequence&)> sweep = [&](Sequence& sequence) {
    for (Node& node : sequence) {
      const auto first = static_cast<std::uint32_t>(instructions.size());
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        if (kept[i]) instructions.push_back(instructions_[i]);
      }
      node.first = node.kind == Node::Kind::run ? first : 0;
      node.count = static_cast<std::uint32_t>(instructions.size()) - first;
      sweep(node.body);
      sweep(node.other);
    }
    std::erase_if(sequence, [](const Node& node) {
      const bool empty = node.body.empty() && node.other.empty();
      return (node.kind == Node::Kind::run && node.count == 0) ||
             ((node.kind == Node::Kind::branch || node.kind == Node::Kind::block) && empty);
    });
  };
  sweep(body);
  instructions_ = std::move(instructions);
}

/// Final numbers, in the order of first appearance.
Program ProgramBuilder::number(const Sequence& body, Register result) {
  Program program;
  program.body = body;
  program.instructions = instructions_;
  std::vector<Register> numbers(registers_.size(), unnumbered);
  std::vector<Register> array_numbers(arrays_.size(), unnumbered);
  for (Register r = 0; r < Program::input_count; ++r) numbers[r] = r;

  const auto name = [&](Register r) {  // its place in its group
    if (numbers[r] != unnumbered) return;
    const auto take = [&](auto& list, auto value) {
      list.push_back(value);
      numbers[r] = static_cast<Register>(list.size() - 1);
    };
    const RegisterInfo& info_of_r = registers_[r];
    if (info_of_r.kind == Kind::constant) take(program.constants, Constant{info_of_r.type, info_of_r.bits});
    if (info_of_r.kind == Kind::variable) take(program.variables, info_of_r.type);
    if (info_of_r.kind == Kind::temporary) take(program.temporaries, info_of_r.type);
  };
  for (const Instruction& instruction : instructions_) {
    for_each_operand(instruction, name);
    if (!is_store(instruction.op)) name(instruction.result);
    if (!is_array_op(instruction.op)) continue;
    Register& array_number = array_numbers[instruction.operands[0]];
    if (array_number != unnumbered) continue;
    array_number = static_cast<Register>(program.arrays.size());
    program.arrays.push_back(arrays_[instruction.operands[0]]);
  }
  const std::function<void(const Sequence&)> name_conditions = [&](const Sequence& sequence) {
    for (const Node& node : sequence) {
      if (node.kind == Node::Kind::branch) name(node.condition);
      name_conditions(node.body);
      name_conditions(node.other);
    }
  };
  name_conditions(body);
  name(result);

  const auto finally = [&](Register r) {
    switch (registers_[r].kind) {
      case Kind::input:
        return r;
      case Kind::constant:
        return program.first_constant() + numbers[r];
      case Kind::variable:
        return program.first_variable() + numbers[r];
      case Kind::temporary:
        break;
    }
    return program.first_temporary() + numbers[r];
  };
  for (Instruction& instruction : program.instructions) {
    for_each_operand(instruction, [&](Register& r) { r = finally(r); });
    if (!is_store(instruction.op)) instruction.result = finally(instruction.result);
    if (is_array_op(instruction.op)) instruction.operands[0] = array_numbers[instruction.operands[0]];
  }
  const std::function<void(Sequence&)> rename_conditions = [&](Sequence& sequence) {
    for (Node& node : sequence) {
      if (node.kind == Node::Kind::branch) node.condition = finally(node.condition);
      rename_conditions(node.body);
      rename_conditions(node.other);
    }
  };
  rename_conditions(program.body);
  program.result = finally(result);
  return program;
}

Program ProgramBuilder::finish(Register result) {
  Sequence body = end();
  // The final copy into the result's variable: return its source.
  if (!body.empty() && body.back().kind == Node::Kind::run && body.back().count != 0) {
    const Instruction& last = instructions_[body.back().first + body.back().count - 1];
    if (last.op == Op::f_copy && last.result == result) {
      result = last.operands[0];
      --body.back().count;
    }
  }
  remove_dead(body, result);
  std::vector<bool> visible(registers_.size());
  promote(body, visible);
  // The result is read at the very end: outside every sequence but the outermost.
  if (registers_[result].kind == Kind::temporary) {
    const bool outermost = std::any_of(body.begin(), body.end(), [&](const Node& node) {
      const auto run = std::span(instructions_).subspan(node.first, node.count);
      return std::any_of(run.begin(), run.end(), [&](const Instruction& i) { return i.result == result; });
    });
    if (!outermost) registers_[result].kind = Kind::variable;
  }
  return number(body, result);
}

}  // namespace dmvv::compiler::snippet
