// A program over a box. Where a condition is not decided both ways are taken and joined; so a state may leave a loop
// and stay in it at once, and what has left waits until the rest is out.
#include <bit>
#include <utility>

#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/interval.h"
#include "compiler/snippet/machine.h"
#include "compiler/snippet/steep.h"

namespace dmvv::compiler::snippet {

namespace {

/// Rounds of a loop that some part of the box may already have left.
constexpr int max_undecided_rounds = 64;

/// Sees each operation before it is executed; this one looks at nothing.
struct NoWatch {
  template <class Domain>
  void operator()(const Instruction&, std::uint32_t, const Cell<Domain>*) {}
};

/// Keeps the first operation that jumps within what is known of its operand.
struct JumpWatch {
  static constexpr double least_width = 0.25;
  std::optional<Jump> first;

  template <class Domain>
  void operator()(const Instruction& instruction, std::uint32_t number, const Cell<Domain>* cells) {
    if (first) return;
    switch (instruction.op) {
      case Op::f_fract:
      case Op::f_floor:
      case Op::f_ceil:
      case Op::f_trunc:
      case Op::f_round:
      case Op::i_from_f:
      case Op::u_from_f:
        return note(number, cells[instruction.operands[0]].f, 1.0);
      case Op::f_mod:
      case Op::f_rem: {
        const Interval& divisor = cells[instruction.operands[1]].f;
        return note(number, cells[instruction.operands[0]].f, std::max(std::abs(divisor.lo), std::abs(divisor.hi)));
      }
      default:
        return;
    }
  }

 private:
  void note(std::uint32_t number, const Interval& operand, double period) {
    const double width = (operand.hi - operand.lo) / period;
    if (width >= least_width && std::isfinite(width)) first = Jump{number, width};
  }
};

template <class Domain, class Watch = NoWatch>
class BoxMachine {
 public:
  using Cells = std::vector<Cell<Domain>>;
  using Real = typename Domain::Real;

  BoxMachine(const Program& program, const std::array<Real, Program::input_count>& inputs,
             std::span<const BoxValue> hoisted)
      : program_(program), cells_(program.register_count() + hoisted.size()), starts_(array_starts(program)) {
    for (Cell<Domain>& cell : cells_) cell.f = Interval{0.0, 0.0};
    for (Register r = 0; r < Program::input_count; ++r) cells_[r].f = inputs[r];
    for (std::size_t k = 0; k < program.constants.size(); ++k) {
      cells_[program.first_constant() + k] = constant(program.constants[k]);
    }
    for (std::size_t k = 0; k < hoisted.size(); ++k) {
      cells_[program.register_count() + k] = {Domain::flushed(hoisted[k].f), hoisted[k].i};
    }
    Cell<Domain> zero;
    zero.f = Interval{0.0, 0.0};
    memory_.assign(starts_.back(), zero);
  }

  const Watch& watch() const { return watch_; }

  Real run() {
    run(program_.body);
    return gave_up_ || !alive_ ? Real(unknown_interval) : cells_[program_.result].f;
  }

 private:
  /// What differs between two ways to the same place.
  struct State {
    Cells variables;
    Cells memory;
  };
  /// A place where a state may wait. (Not a std::optional: with sanitizers, g++ 12 takes that for uninitialised.)
  struct Place {
    bool is_taken = false;
    State waiting;
  };
  /// Where states wait that have left a loop or block, or begin its next round.
  struct Construct {
    bool is_loop;
    Place left;
    Place repeated;
  };

  static Cell<Domain> constant(const Constant& constant) {
    Cell<Domain> cell;
    cell.f = Interval{0.0, 0.0};
    const float value = std::bit_cast<float>(constant.bits);
    const bool is_real = constant.type == Type::real;
    if (is_real) cell.f = Domain::flushed(Interval{value, value});
    if (is_real && std::isnan(value)) cell.f = unknown_interval;
    const bool is_signed = constant.type == Type::integer;
    const std::int64_t whole = is_signed ? std::int64_t{static_cast<std::int32_t>(constant.bits)} : constant.bits;
    cell.i = {whole, whole};
    return cell;
  }

  // ---- states ----

  State state() {
    spend(program_.variables.size() + memory_.size());
    const auto first = cells_.begin() + program_.first_variable();
    return {{first, first + static_cast<std::ptrdiff_t>(program_.variables.size())}, memory_};
  }
  void restore(const State& state) {
    std::copy(state.variables.begin(), state.variables.end(), cells_.begin() + program_.first_variable());
    memory_ = state.memory;
  }
  static void join(Cell<Domain>& into, const Cell<Domain>& other) {
    into = {hull(into.f, other.f), hull(into.i, other.i)};
  }
  /// Adds a state to the current one.
  void join(const State& other) {
    spend(other.variables.size() + other.memory.size());
    Cell<Domain>* variables = cells_.data() + program_.first_variable();
    for (std::size_t k = 0; k < other.variables.size(); ++k) join(variables[k], other.variables[k]);
    for (std::size_t k = 0; k < other.memory.size(); ++k) join(memory_[k], other.memory[k]);
  }
  void resume(const Place& place) {
    if (!place.is_taken) return;
    if (alive_)
      join(place.waiting);
    else
      restore(place.waiting);
    alive_ = true;
  }
  void wait_in(Place& place) {
    if (!alive_) return;
    if (place.is_taken) join(place.waiting);
    place = {true, state()};
    alive_ = false;
  }

  void spend(std::size_t steps) {
    steps_ += steps;
    gave_up_ |= steps_ > Snippet::step_budget;
  }

  // ---- control flow; alive_: some state has come this far and has not left ----

  void run(const Sequence& sequence) {
    for (const Node& node : sequence) {
      if (!alive_ || gave_up_) return;
      spend(1);
      run(node);
    }
  }

  void run(const Node& node) {
    switch (node.kind) {
      case Node::Kind::run:
        run_instructions(node);
        break;
      case Node::Kind::branch:
        run_branch(node);
        break;
      case Node::Kind::block:
        constructs_.push_back({.is_loop = false, .left = {}, .repeated = {}});
        run(node.body);
        end_construct();
        break;
      case Node::Kind::loop:
        run_loop(node);
        break;
      case Node::Kind::leave:
        wait_in(constructs_.back().left);
        break;
      case Node::Kind::repeat:
        wait_in(innermost_loop().repeated);
        break;
    }
  }

  void end_construct() {
    const Place left = std::move(constructs_.back().left);
    constructs_.pop_back();
    resume(left);
  }

  Construct& innermost_loop() {
    std::size_t k = constructs_.size() - 1;
    while (!constructs_[k].is_loop) --k;
    return constructs_[k];
  }

  void run_branch(const Node& branch) {
    const IntegerInterval condition = cells_[branch.condition].i;
    if (condition.is_point()) return run(condition.lo != 0 ? branch.body : branch.other);
    const State before = state();
    run(branch.body);
    Place after_body;
    wait_in(after_body);
    restore(before);
    alive_ = true;
    run(branch.other);
    resume(after_body);
  }

  void run_loop(const Node& loop) {
    constructs_.push_back({.is_loop = true, .left = {}, .repeated = {}});
    for (int undecided = 0; alive_ && !gave_up_; spend(1)) {
      run(loop.body);
      resume(std::exchange(constructs_.back().repeated, {}));
      run(loop.other);
      if (alive_ && constructs_.back().left.is_taken && ++undecided > max_undecided_rounds) gave_up_ = true;
    }
    end_construct();
  }

  // ---- instructions ----

  void run_instructions(const Node& node) {
    spend(node.count);
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const Instruction& instruction = program_.instructions[k];
      watch_(instruction, k, cells_.data());
      if (is_load(instruction.op)) {
        load(instruction);
      } else if (is_store(instruction.op)) {
        store(instruction);
      } else if (instruction.op == Op::f_mul && instruction.operands[0] == instruction.operands[1]) {
        cells_[instruction.result].f = Domain::square(cells_[instruction.operands[0]].f);
      } else if (instruction.op == Op::f_fma && instruction.operands[0] == instruction.operands[1]) {
        cells_[instruction.result].f =
            Domain::f_add(Domain::square(cells_[instruction.operands[0]].f), cells_[instruction.operands[2]].f);
      } else {
        execute<Domain>(instruction, cells_.data());
      }
    }
  }

  /// The elements an index may mean: cells [first, last] of memory_.
  std::pair<std::size_t, std::size_t> elements(const Instruction& instruction) {
    const Register array = instruction.operands[0];
    const IntegerInterval index = cells_[instruction.operands[1]].i;
    const std::int64_t last = std::int64_t{program_.arrays[array].size} - 1;
    const auto clamped = [&](std::int64_t i) { return static_cast<std::size_t>(std::clamp<std::int64_t>(i, 0, last)); };
    spend(clamped(index.hi) - clamped(index.lo));
    return {starts_[array] + clamped(index.lo), starts_[array] + clamped(index.hi)};
  }

  void load(const Instruction& instruction) {
    const auto [first, last] = elements(instruction);
    Cell<Domain> value = memory_[first];
    for (std::size_t k = first + 1; k <= last; ++k) join(value, memory_[k]);
    cells_[instruction.result] = value;
  }

  void store(const Instruction& instruction) {
    const auto [first, last] = elements(instruction);
    const Cell<Domain>& value = cells_[instruction.operands[2]];
    if (first == last) memory_[first] = value;
    for (std::size_t k = first; first != last && k <= last; ++k) join(memory_[k], value);
  }

  const Program& program_;
  Cells cells_;
  std::vector<std::size_t> starts_;
  Cells memory_;
  std::vector<Construct> constructs_;
  bool alive_ = true;
  bool gave_up_ = false;
  std::uint64_t steps_ = 0;
  [[no_unique_address]] Watch watch_;
};

}  // namespace

Interval evaluate_box(const Program& program, const std::array<Interval, Program::input_count>& inputs,
                      Rounding rounding, std::span<const BoxValue> hoisted) {
  const auto run = [&]<Rounding chosen>() {
    using Domain = IntervalDomain<chosen>;
    std::array<Interval, Program::input_count> rounded;
    for (std::size_t i = 0; i < inputs.size(); ++i) rounded[i] = Domain::input(inputs[i]);
    return BoxMachine<Domain>(program, rounded, hoisted).run();
  };
  return rounding == Rounding::real ? run.template operator()<Rounding::real>()
                                    : run.template operator()<Rounding::float32>();
}

BoxAndJump evaluate_box_and_jump(const Program& program, const std::array<Interval, Program::input_count>& inputs,
                                 std::span<const BoxValue> hoisted) {
  using Domain = IntervalDomain<Rounding::float32>;
  std::array<Interval, Program::input_count> rounded;
  for (std::size_t i = 0; i < inputs.size(); ++i) rounded[i] = Domain::input(inputs[i]);
  BoxMachine<Domain, JumpWatch> machine(program, rounded, hoisted);
  const Interval value = machine.run();
  return {value, machine.watch().first};
}

Steepness steepness_over(const Program& program, const std::array<Interval, Program::input_count>& inputs,
                         std::span<const BoxValue> hoisted) {
  std::array<Steep, Program::input_count> coordinates;
  for (std::size_t i = 0; i < inputs.size(); ++i) coordinates[i] = SteepDomain::coordinate(inputs[i], i);
  const Steep f = BoxMachine<SteepDomain>(program, coordinates, hoisted).run();
  return {f.slope, f.error};
}

}  // namespace dmvv::compiler::snippet
