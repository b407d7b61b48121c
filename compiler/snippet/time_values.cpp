// Binding-time analysis (Jones, Gomard, Sestoft 1993, "Partial Evaluation and Automatic Program Generation", chapter 4)
// with three levels: constant, time, space. A register that is at most `time` goes to the schedule; where something of
// level `space` uses it, its value is captured.
#include "compiler/snippet/time_values.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/interval.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr std::size_t most_hoisted = 512;
constexpr int most_rounds = 32;  // of the fixed point; more than a handful is no program of a person

/// Beyond it a time value is reduced by its period. Below, reducing could lose more than it wins: with |b| > 256 the
/// error of float32 a + b exceeds that of a + (b mod 2 pi) for every |a| <= 126.
constexpr double reduced_beyond = 256.0;

/// Calls use(operand, letter) for each operand, as the table lists them.
template <class Use>
void for_operands(const Instruction& instruction, Use use) {
  const std::string_view letters = info(instruction.op).operands;
  for (std::size_t k = 0; k < letters.size(); ++k) use(k, letters[k]);
}

bool is_store(const Instruction& instruction) { return info(instruction.op).result == '-'; }

// ---- what reaches the result ----

/// Marks instructions and control flow backward from the results.
class Reach {
 public:
  explicit Reach(const Program& program)
      : program_(program),
        node_of_(program.instructions.size(), 0),
        needed_(program.instructions.size(), false),
        register_seen_(program.register_count(), false),
        array_seen_(program.arrays.size(), false),
        assignments_(program.register_count()),
        stores_(program.arrays.size()) {
    places_.push_back({});  // the whole program: always there
    places_[0].needed = true;
    enter(program.body, 0, 0, 0);
  }

  Program run(std::span<const Register> results) {
    for (const Register r : results) need_register(r);
    while (!pending_.empty()) {
      const std::uint32_t i = pending_.back();
      pending_.pop_back();
      need_place(node_of_[i]);
      const Instruction& instruction = program_.instructions[i];
      for_operands(instruction, [&](std::size_t k, char letter) {
        letter == 'a' ? need_array(instruction.operands[k]) : need_register(instruction.operands[k]);
      });
    }
    Program kept = program_;
    kept.instructions.clear();
    std::uint32_t place = 0;
    kept.body = keep(program_.body, kept.instructions, place);
    return kept;
  }

 private:
  struct Place {
    const Node* node = nullptr;
    std::uint32_t parent = 0;
    bool needed = false;
    std::vector<std::uint32_t> exits;  ///< of a loop or block: the nodes that leave or repeat it
  };

  void enter(const Sequence& sequence, std::uint32_t parent, std::uint32_t left, std::uint32_t repeated) {
    for (const Node& node : sequence) {
      const auto place = static_cast<std::uint32_t>(places_.size());
      places_.push_back({&node, parent, false, {}});
      if (node.kind == Node::Kind::run) list(node, place);
      if (node.kind == Node::Kind::leave) places_[left].exits.push_back(place);
      if (node.kind == Node::Kind::repeat) places_[repeated].exits.push_back(place);
      const bool is_loop = node.kind == Node::Kind::loop, catches = is_loop || node.kind == Node::Kind::block;
      enter(node.body, place, catches ? place : left, is_loop ? place : repeated);
      enter(node.other, place, catches ? place : left, is_loop ? place : repeated);
    }
  }

  void list(const Node& node, std::uint32_t place) {
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Instruction& instruction = program_.instructions[i];
      node_of_[i] = place;
      (is_store(instruction) ? stores_[instruction.operands[0]] : assignments_[instruction.result]).push_back(i);
    }
  }

  void need_instructions(const std::vector<std::uint32_t>& instructions) {
    for (const std::uint32_t i : instructions) {
      if (needed_[i]) continue;
      needed_[i] = true;
      pending_.push_back(i);
    }
  }

  void need_register(Register r) {
    if (r >= program_.register_count() || register_seen_[r]) return;
    register_seen_[r] = true;
    need_instructions(assignments_[r]);
  }

  void need_array(Register array) {
    if (array_seen_[array]) return;
    array_seen_[array] = true;
    need_instructions(stores_[array]);
  }

  void need_place(std::uint32_t place) {
    for (; !places_[place].needed; place = places_[place].parent) {
      places_[place].needed = true;
      if (places_[place].node->kind == Node::Kind::branch) need_register(places_[place].node->condition);
      for (const std::uint32_t exit : places_[place].exits) need_place(exit);
    }
  }

  Sequence keep(const Sequence& sequence, std::vector<Instruction>& instructions, std::uint32_t& place) const {
    Sequence kept;
    for (const Node& node : sequence) {
      const bool needed = places_[++place].needed;
      Node copy;
      copy.kind = node.kind;
      copy.condition = node.condition;
      copy.first = static_cast<std::uint32_t>(instructions.size());
      if (node.kind == Node::Kind::run) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          if (needed_[i]) instructions.push_back(program_.instructions[i]);
        }
        copy.count = static_cast<std::uint32_t>(instructions.size()) - copy.first;
      } else {
        copy.first = 0;
      }
      copy.body = keep(node.body, instructions, place);
      copy.other = keep(node.other, instructions, place);
      if (needed) kept.push_back(std::move(copy));
    }
    return kept;
  }

  const Program& program_;
  std::vector<Place> places_;
  std::vector<std::uint32_t> node_of_;
  std::vector<bool> needed_, register_seen_, array_seen_;
  std::vector<std::vector<std::uint32_t>> assignments_, stores_;
  std::vector<std::uint32_t> pending_;
};

// ---- binding times ----

enum class Level : std::uint8_t { constant, time, space };

bool repeats(const Sequence& sequence) {
  return std::ranges::any_of(sequence, [](const Node& node) {
    if (node.kind == Node::Kind::loop) return false;
    return node.kind == Node::Kind::repeat || repeats(node.body) || repeats(node.other);
  });
}

/// The level of every register and array: the least fixed point of
///   a temporary    the highest of its operands
///   a variable, an array    the highest of what is assigned to it, anywhere, and of what decides whether it is.
class Levels {
 public:
  Levels(const Program& program, bool only_t)
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

  Level of(Register r) const { return registers_[r]; }
  Level of_array(Register array) const { return arrays_[array]; }

  /// Of what an instruction assigns.
  Level of(const Instruction& instruction) const {
    return is_store(instruction) ? arrays_[instruction.operands[0]] : registers_[instruction.result];
  }

  /// The level of what decides whether and how often the inside of a node runs.
  Level control(const Node& node, Level outside) const {
    if (node.kind == Node::Kind::branch) return std::max(outside, of(node.condition));
    return std::max({outside, exits(node.body, Level::constant), exits(node.other, Level::constant)});
  }

 private:
  /// The highest level that decides over an exit to outside the sequence.
  Level exits(const Sequence& sequence, Level decided) const {
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

  void visit(const Sequence& sequence, Level decided) {
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

  void assign(const Instruction& instruction, Level decided) {
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

  void raise(Level& level, Level to) {
    if (to <= level) return;
    level = to;
    changed_ = true;
  }

  /// All variables and arrays depend on space: a fixed point in one round.
  void give_up() {
    std::fill(registers_.begin() + program_.first_variable(), registers_.begin() + program_.first_temporary(),
              Level::space);
    std::ranges::fill(arrays_, Level::space);
    visit(program_.body, Level::constant);
  }

  const Program& program_;
  bool only_t_;
  std::vector<Level> registers_, arrays_;
  bool changed_ = true;
};

// ---- periods ----

/// For each temporary, the period modulo which alone its value matters.
class Periods {
 public:
  explicit Periods(const Program& program) : program_(program), periods_(program.register_count(), unused) {
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

  /// The period modulo which alone operand k matters to the instruction.
  Period of_use(const Instruction& instruction, std::size_t k) const {
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

 private:
  static constexpr Period unused = static_cast<Period>(255);

  void list(const Sequence& sequence, std::vector<std::uint32_t>& order) const {
    for (const Node& node : sequence) {
      for (std::uint32_t i = 0; i < node.count; ++i) order.push_back(node.first + i);
      list(node.body, order);
      list(node.other, order);
    }
  }

  const Program& program_;
  std::vector<Period> periods_;
};

// ---- the split ----

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

/// atan2 of sine and cosine rather than a remainder by a rounded 2 pi: the library reduces huge arguments exactly.
double reduce(double value, Period period) {
  if (period == Period::none || !(std::abs(value) > reduced_beyond) || !std::isfinite(value)) return value;
  if (period == Period::one) return value - std::floor(value);
  return std::atan2(std::sin(value), std::cos(value));
}

}  // namespace

Program reaching(const Program& program, std::span<const Register> results) { return Reach(program).run(results); }

TimeSplit split_time(const Program& program) {
  const Periods periods(program);
  TimeSplit split = Splitter(program, Levels(program, false), periods).run();
  if (split.slots.size() <= most_hoisted) return split;
  return Splitter(program, Levels(program, true), periods).run();
}

std::vector<float> time_values(std::span<const TimeSlot> slots, double t_ms) {
  std::vector<float> values;
  values.reserve(slots.size());
  for (const TimeSlot& slot : slots) {
    values.push_back(
        static_cast<float>(reduce(evaluate_point<double>(slot.program, {0.0, 0.0, 0.0, t_ms}).f, slot.period)));
  }
  return values;
}

std::vector<float> Snippet::time_values(double t_ms) const { return snippet::time_values(split_->slots, t_ms); }

std::size_t Snippet::time_value_count() const { return split_->slots.size(); }

// ---- intervals ----

namespace {

constexpr double float_unit = 0x1p-24, double_unit = 0x1p-53, smallest_normal = 0x1p-126;

double size(const Interval& a) { return std::max(std::abs(a.lo), std::abs(a.hi)); }

Interval widened(const Interval& a, double by) { return {a.lo - by, a.hi + by, a.maybe_nan}; }

/// What a period leaves of an interval of values: moved by whole periods, so that it begins within half of one of 0.
/// The device's value may be a whole period from the one here: the sums it enters round as much coarser.
Interval reduced(const Interval& value, Period period) {
  if (period == Period::none || !(size(value) > reduced_beyond) || !std::isfinite(size(value))) return value;
  const double length = period == Period::turn ? 2.0 * std::numbers::pi : 1.0;
  if (value.hi - value.lo >= length) return {-length, length, value.maybe_nan};
  const double lo = reduce(value.lo, period);
  // Of values on both sides of the limit some are left as they are, large.
  const bool some_stay = std::min(std::abs(value.lo), std::abs(value.hi)) <= reduced_beyond;
  const double coarser = float_unit * ((some_stay ? reduced_beyond : 0.0) + 2.0 * length);
  return widened({lo, lo + (value.hi - value.lo), value.maybe_nan}, coarser + 4.0 * double_unit * size(value));
}

/// A slot as a device reads it, and the double that it stands for.
Interval slot_values(const TimeSlot& slot, const Interval& t_ms) {
  const std::array<Interval, Program::input_count> inputs{Interval{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, t_ms};
  if (t_ms.lo != t_ms.hi) {
    const Interval value = reduced(evaluate_box(slot.program, inputs, Rounding::real), slot.period);
    return widened(value, float_unit * size(value) + smallest_normal);
  }
  const double exact = evaluate_point<double>(slot.program, {0.0, 0.0, 0.0, t_ms.lo}).f;
  if (std::isnan(exact)) return unknown_interval;
  const double value = reduce(exact, slot.period), device = static_cast<float>(value);
  if (!std::isfinite(device)) return {std::min(value, device), std::max(value, device), true};
  // The reference adds what was not reduced, and rounds it.
  const double apart = value == exact ? 0.0 : 4.0 * double_unit * std::abs(exact);
  return widened({std::min(value, device), std::max(value, device)}, apart);
}

std::int64_t whole(double x) { return std::llround(std::clamp(x, -0x1p33, 0x1p33)); }

/// From its halves of 16 bits. What does not fit the type is any value of it.
IntegerInterval joined(const Interval& high, const Interval& low, const IntegerInterval& type) {
  if (high.maybe_nan || low.maybe_nan) return type;
  const bool one_high = whole(high.lo) == whole(high.hi);
  const IntegerInterval value{whole(high.lo) * 65536 + (one_high ? whole(low.lo) : 0),
                              whole(high.hi) * 65536 + (one_high ? whole(low.hi) : 65535)};
  return value.lo < type.lo || value.hi > type.hi ? type : value;
}

}  // namespace

std::vector<BoxValue> device_values(const TimeSplit& split, const Interval& t_ms) {
  std::vector<BoxValue> values;
  values.reserve(split.hoisted.size());
  for (const Hoisted& hoisted : split.hoisted) {
    const auto slot = [&](std::uint32_t k) { return slot_values(split.slots[hoisted.first_slot + k], t_ms); };
    BoxValue value;
    switch (hoisted.type) {
      case Type::real:
        value.f = slot(0);
        break;
      case Type::boolean: {
        const Interval bit = slot(0);
        value.i =
            bit.maybe_nan ? IntegerIntervalOps::any_bool : IntegerInterval{bit.lo > 0.5 ? 1 : 0, bit.hi < 0.5 ? 0 : 1};
        break;
      }
      case Type::integer:
        value.i = joined(slot(0), slot(1), IntegerIntervalOps::any_int);
        break;
      case Type::unsigned_integer:
        value.i = joined(slot(0), slot(1), IntegerIntervalOps::any_uint);
        break;
    }
    values.push_back(value);
  }
  return values;
}

}  // namespace dmvv::compiler::snippet
