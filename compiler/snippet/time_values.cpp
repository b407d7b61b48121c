// A split is a binding-time analysis (Jones, Gomard, Sestoft 1993, "Partial Evaluation and Automatic Program
// Generation", chapter 4) with three levels: constant, time, space. A register that is at most `time` goes to the
// schedule; where something of level `space` uses it, its value is captured.
#include "compiler/snippet/time_values.h"

#include <map>
#include <utility>

#include "compiler/snippet/binding_times.h"
#include "compiler/snippet/operands.h"
#include "compiler/snippet/periods.h"
#include "compiler/snippet/slice_program.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr std::size_t most_hoisted = 512;

Op copy_of(Type type) {
  switch (type) {
    case Type::real:
      return Op::f_copy;
    case Type::integer:
      return Op::i_copy;
    case Type::unsigned_integer:
      return Op::u_copy;
    case Type::boolean:
      return Op::b_copy;
  }
  return Op::f_copy;
}

/// Walks a program once and writes both parts. The schedule keeps what is at most `time`, in its order: branches,
/// loops and blocks that space decides over are dissolved there, which is sound because nothing that they assign is
/// left but temporaries.
class Splitter {
 public:
  Splitter(const Program& program, const Levels& levels, const Periods& periods)
      : program_(program),
        levels_(levels),
        periods_(periods),
        varies_(program.register_count(), false),
        loops_assigning_(program.register_count() + program.arrays.size(), 0) {}

  TimeSplit run() {
    residual_ = program_;
    residual_.instructions.clear();
    residual_.body.clear();
    capture(Program::t, schedule_);
    split(program_.body, Level::constant, residual_.body, schedule_);
    residual_.result = captured(program_.result, Period::none, schedule_);
    residual_ = reaching(residual_, {&residual_.result, 1});
    return finish();
  }

 private:
  /// A captured value, and what of it matters: one hoisted value.
  struct Read {
    Register capture;
    Period period;
    bool needed = false;
  };

  void split(const Sequence& sequence, Level decided, Sequence& residual, Sequence& schedule) {
    for (const Node& node : sequence) {
      switch (node.kind) {
        case Node::Kind::run:
          split_run(node, residual, schedule);
          break;
        case Node::Kind::leave:
        case Node::Kind::repeat:
          residual.push_back(node);
          if (decided != Level::space) schedule.push_back(node);
          break;
        default:
          split_construct(node, decided, residual, schedule);
      }
    }
  }

  void split_run(const Node& node, Sequence& residual, Sequence& schedule) {
    Node kept;
    kept.first = static_cast<std::uint32_t>(residual_.instructions.size());
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      Instruction instruction = program_.instructions[i];
      const bool scheduled = levels_.of(instruction) != Level::space;
      note_variation(instruction);
      for_operands(instruction, [&](std::size_t k, char letter) {
        if (letter == 'a') return;
        instruction.operands[k] = captured(instruction.operands[k], periods_.of_use(instruction, k), schedule);
      });
      residual_.instructions.push_back(instruction);
      if (scheduled) append(schedule, program_.instructions[i]);
      if (!is_store(instruction) && program_.is_temporary(instruction.result)) capture(instruction.result, schedule);
      const bool assigns = !is_store(instruction) && program_.is_variable(instruction.result);
      if (assigns && levels_.of(instruction) == Level::time) ++epoch_;
    }
    kept.count = static_cast<std::uint32_t>(residual_.instructions.size()) - kept.first;
    residual.push_back(kept);
  }

  void split_construct(const Node& node, Level decided, Sequence& residual, Sequence& schedule) {
    const Level inside = levels_.control(node, decided);
    const bool is_branch = node.kind == Node::Kind::branch, is_loop = node.kind == Node::Kind::loop;
    const bool dissolved = is_branch ? levels_.of(node.condition) == Level::space : inside == Level::space;
    Node kept, scheduled;
    kept.kind = scheduled.kind = node.kind;
    if (is_branch) {
      kept.condition = captured(node.condition, Period::none, schedule);
      scheduled.condition = node.condition;
    }
    ++epoch_;
    if (is_loop) count_assignments(node, 1);
    split(node.body, inside, kept.body, dissolved ? schedule : scheduled.body);
    ++epoch_;
    split(node.other, inside, kept.other, dissolved ? schedule : scheduled.other);
    ++epoch_;
    if (is_loop) count_assignments(node, -1);
    residual.push_back(std::move(kept));
    if (!dissolved) schedule.push_back(std::move(scheduled));
  }

  /// Keeps, for every variable and array, how many of the loops around the current place assign it.
  void count_assignments(const Node& node, int by) {
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Instruction& instruction = program_.instructions[i];
      if (is_store(instruction)) loops_assigning_[array_slot(instruction.operands[0])] += by;
      if (!is_store(instruction)) loops_assigning_[instruction.result] += by;
    }
    for (const Node& inner : node.body) count_assignments(inner, by);
    for (const Node& inner : node.other) count_assignments(inner, by);
  }

  std::size_t array_slot(Register array) const { return program_.register_count() + array; }

  /// Does a register change from round to round of a loop around the current place?
  bool varies(Register r) const {
    return program_.is_temporary(r) ? varies_[r] : program_.is_variable(r) && loops_assigning_[r] > 0;
  }

  void note_variation(const Instruction& instruction) {
    if (is_store(instruction) || !program_.is_temporary(instruction.result)) return;
    for_operands(instruction, [&](std::size_t k, char letter) {
      const Register operand = instruction.operands[k];
      if (letter == 'a' ? loops_assigning_[array_slot(operand)] > 0 : varies(operand)) {
        varies_[instruction.result] = true;
      }
    });
  }

  bool is_hoisted(Register r) const { return levels_.of(r) == Level::time && !varies(r); }

  /// Captures a value where it is made (a variable: where it is read), so that every later reader finds it.
  Register capture(Register r, Sequence& schedule) {
    if (!is_hoisted(r)) return 0;
    const auto next = static_cast<Register>(captures_.size());
    const auto [found, is_new] = capture_of_.try_emplace({r, program_.is_variable(r) ? epoch_ : 0}, next);
    if (is_new) {
      captures_.push_back(r);
      append(schedule, {copy_of(program_.type(r)), capture_variable(next), {r}});
    }
    return found->second;
  }

  /// What the residual reads in place of a register: the register itself, or what was captured of it.
  Register captured(Register r, Period period, Sequence& schedule) {
    if (!is_hoisted(r)) return r;
    const Register from = capture(r, schedule);
    const auto next = static_cast<Register>(reads_.size());
    const auto [found, is_new] = read_of_.try_emplace({from, period}, next);
    if (is_new) reads_.push_back({from, period});
    return program_.register_count() + found->second;
  }

  void append(Sequence& schedule, const Instruction& instruction) {
    if (schedule.empty() || schedule.back().kind != Node::Kind::run ||
        schedule.back().first + schedule.back().count != scheduled_.size()) {
      schedule.emplace_back();
      schedule.back().first = static_cast<std::uint32_t>(scheduled_.size());
    }
    scheduled_.push_back(instruction);
    ++schedule.back().count;
  }

  /// Until the number of captures is known, their variables stand beyond all registers.
  Register capture_variable(Register capture) const { return program_.register_count() + capture; }

  TimeSplit finish();
  void number_needed();
  std::uint32_t add_slots(TimeSplit& split, Register variable, Period period);

  const Program& program_;
  const Levels& levels_;
  const Periods& periods_;
  std::vector<bool> varies_;
  std::vector<int> loops_assigning_;
  std::uint64_t epoch_ = 1;  ///< moves on wherever a variable of level time may have changed
  std::map<std::pair<Register, std::uint64_t>, Register> capture_of_;  ///< of a register, at an epoch
  std::vector<Register> captures_;
  std::map<std::pair<Register, Period>, Register> read_of_;
  std::vector<Read> reads_;
  Program residual_;
  Sequence schedule_;
  std::vector<Instruction> scheduled_;
};

template <class Change>
void change_conditions(Sequence& sequence, Change change) {
  for (Node& node : sequence) {
    if (node.kind == Node::Kind::branch) node.condition = change(node.condition);
    change_conditions(node.body, change);
    change_conditions(node.other, change);
  }
}

template <class Change>
void change_registers(Program& program, Change change) {
  for (Instruction& instruction : program.instructions) {
    for_operands(instruction, [&](std::size_t k, char letter) {
      if (letter != 'a') instruction.operands[k] = change(instruction.operands[k]);
    });
    if (!is_store(instruction)) instruction.result = change(instruction.result);
  }
  change_conditions(program.body, change);
  program.result = change(program.result);
}

/// The program with those of its registers alone that it uses, in their order. A schedule has the registers of the
/// whole program, and every slot evaluates its part anew.
Program compacted(Program program) {
  std::vector<bool> used(program.register_count(), false);
  change_registers(program, [&](Register r) {
    used[r] = true;
    return r;
  });
  std::vector<Register> number(program.register_count());
  Register next = 0;
  const auto keep = [&](Register first, auto& group) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < group.size(); ++k) {
      if (!used[first + k]) continue;
      number[first + k] = next++;
      group[kept++] = group[k];
    }
    group.resize(kept);
  };
  const Register constants = program.first_constant(), variables = program.first_variable();
  const Register temporaries = program.first_temporary();
  for (; next < Program::input_count; ++next) number[next] = next;
  keep(constants, program.constants);
  keep(variables, program.variables);
  keep(temporaries, program.temporaries);
  change_registers(program, [&](Register r) { return number[r]; });
  return program;
}

/// Numbers the reads that are left in the residual, in the order of their places.
void Splitter::number_needed() {
  const Register base = program_.register_count();
  change_registers(residual_, [&](Register r) {
    if (r >= base) reads_[r - base].needed = true;
    return r;
  });
  std::vector<Register> number(reads_.size());
  Register next = base;
  for (std::size_t k = 0; k < reads_.size(); ++k) number[k] = reads_[k].needed ? next++ : base;
  change_registers(residual_, [&](Register r) { return r < base ? r : number[r - base]; });
  std::erase_if(reads_, [](const Read& read) { return !read.needed; });
}

TimeSplit Splitter::finish() {
  number_needed();
  TimeSplit split;
  split.residual = std::move(residual_);
  Program& schedule = split.schedule;
  schedule = program_;
  schedule.instructions = std::move(scheduled_);
  schedule.body = std::move(schedule_);

  // Registers move up: constants of the conversions and variables of the captures come in between.
  const std::vector<Constant> more = {
      {Type::real, 0}, {Type::real, 0x3f800000}, {Type::unsigned_integer, 16}, {Type::unsigned_integer, 0xffff}};
  schedule.constants.insert(schedule.constants.end(), more.begin(), more.end());
  for (const Register source : captures_) schedule.variables.push_back(program_.type(source));
  const auto first_capture = schedule.first_temporary() - static_cast<Register>(captures_.size());
  change_registers(schedule, [&](Register r) {
    if (r >= program_.register_count()) return first_capture + (r - program_.register_count());
    if (program_.is_temporary(r)) return schedule.first_temporary() + (r - program_.first_temporary());
    if (program_.is_variable(r)) return schedule.first_variable() + (r - program_.first_variable());
    return r;
  });

  Node conversions;
  conversions.first = static_cast<std::uint32_t>(schedule.instructions.size());
  for (const Read& read : reads_) {
    const Register variable = first_capture + read.capture;
    split.hoisted.push_back({schedule.type(variable), add_slots(split, variable, read.period)});
  }
  conversions.count = static_cast<std::uint32_t>(schedule.instructions.size()) - conversions.first;
  schedule.body.push_back(conversions);
  std::vector<Register> results;
  for (const TimeSlot& slot : split.slots) results.push_back(slot.result);
  schedule = reaching(schedule, results);
  for (TimeSlot& slot : split.slots) {
    Program part = reaching(schedule, {&slot.result, 1});
    part.result = slot.result;
    slot.program = compacted(std::move(part));
  }
  return split;
}

/// A float holds what is no float exactly: a bool as 0 or 1, an integer in halves of 16 bits.
std::uint32_t Splitter::add_slots(TimeSplit& split, Register variable, Period period) {
  Program& schedule = split.schedule;
  const auto first = static_cast<std::uint32_t>(split.slots.size());
  const Register zero = schedule.first_variable() - 4, one = zero + 1, sixteen = zero + 2, low_bits = zero + 3;
  const auto compute = [&](Type type, Op op, std::array<Register, 3> operands) {
    schedule.temporaries.push_back(type);
    schedule.instructions.push_back({op, schedule.register_count() - 1, operands});
    return schedule.register_count() - 1;
  };
  constexpr Type real = Type::real, unsigned_integer = Type::unsigned_integer;
  switch (schedule.type(variable)) {
    case Type::real:
      split.slots.push_back({variable, period, {}});
      break;
    case Type::boolean:
      split.slots.push_back({compute(real, Op::f_select, {variable, one, zero}), Period::none, {}});
      break;
    case Type::integer: {
      const Register high = compute(Type::integer, Op::i_shr, {variable, sixteen});
      split.slots.push_back({compute(real, Op::f_from_i, {high}), Period::none, {}});
      const Register bits = compute(unsigned_integer, Op::u_from_i, {variable});
      const Register low = compute(unsigned_integer, Op::u_and, {bits, low_bits});
      split.slots.push_back({compute(real, Op::f_from_u, {low}), Period::none, {}});
      break;
    }
    case Type::unsigned_integer: {
      const Register high = compute(unsigned_integer, Op::u_shr, {variable, sixteen});
      split.slots.push_back({compute(real, Op::f_from_u, {high}), Period::none, {}});
      const Register low = compute(unsigned_integer, Op::u_and, {variable, low_bits});
      split.slots.push_back({compute(real, Op::f_from_u, {low}), Period::none, {}});
      break;
    }
  }
  return first;
}

}  // namespace

TimeSplit split_time(const Program& program) {
  const Periods periods(program);
  TimeSplit split = Splitter(program, Levels(program, false), periods).run();
  if (split.slots.size() <= most_hoisted) return split;
  return Splitter(program, Levels(program, true), periods).run();
}

}  // namespace dmvv::compiler::snippet
