// A state is a value for each variable and each element of an array, and the condition under which control comes that
// way. States that have left a loop or block wait with theirs; where ways meet, each value is chosen by a condition.
#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "compiler/snippet/machine.h"
#include "compiler/snippet/point_domain.h"
#include "compiler/snippet/straight_line.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr std::size_t most_steps = 1u << 18;
constexpr std::size_t most_work = 1u << 24;  // values looked at where ways meet
constexpr int most_rounds = 4096;            // of one loop
constexpr std::uint32_t cheap_steps = 4;     // that are rather made anew than kept
constexpr std::size_t long_ago_steps = 64;

Op choice_of(Type type) {
  constexpr Op ops[] = {Op::f_select, Op::i_select, Op::u_select, Op::b_select};
  return ops[static_cast<std::size_t>(type)];
}

class Straightener {
 public:
  explicit Straightener(const TimeSplit& split)
      : split_(split),
        program_(split.residual),
        starts_(array_starts(program_)),
        registers_(program_.register_count()) {}

  Result<StraightLine> run() {
    false_ = constant(Type::boolean, 0);
    true_ = constant(Type::boolean, 1);
    for (std::size_t k = 0; k < program_.constants.size(); ++k) {
      registers_[program_.first_constant() + k] = constant(program_.constants[k].type, program_.constants[k].bits);
    }
    for (Register r = 0; r < Program::t; ++r)
      registers_[r] = add({Step::Kind::point, Type::real, Op::f_copy, {r, 0, 0}});
    for (const Type type : program_.variables) state_.values.push_back(constant(type, 0));
    for (const Array& array : program_.arrays)
      state_.values.insert(state_.values.end(), array.size, constant(array.type, 0));
    state_.condition = true_;
    run(program_.body);
    if (!error_.empty()) return fail(Fault::input, error_);
    return ordered(value(program_.result));
  }

 private:
  struct State {
    std::vector<std::uint32_t> values;  ///< of the variables, then of the arrays' elements
    std::uint32_t condition = 0;        ///< false_: nothing comes this way
  };
  /// Where states wait that have left a loop or block, or begin its next round.
  struct Construct {
    bool is_loop;
    std::vector<State> left;
    std::vector<State> repeated;
  };

  bool alive() const { return state_.condition != false_ && error_.empty(); }

  void refuse(const char* why) {
    if (error_.empty()) error_ = why;
  }

  // ---- steps; equal ones are made once ----

  std::uint32_t add(const Step& step) {
    const auto key = std::make_tuple(step.kind, step.type, step.op, step.operands);
    const auto [known, is_new] = known_.try_emplace(key, static_cast<std::uint32_t>(steps_.size()));
    if (is_new) steps_.push_back(step);
    if (steps_.size() > most_steps) refuse("it has more than 262,144 steps once its loops are unrolled");
    return known->second;
  }

  std::uint32_t constant(Type type, std::uint32_t bits) {
    return add({Step::Kind::constant, type, Op::f_copy, {bits, 0, 0}});
  }

  bool is_constant(std::uint32_t step) const { return steps_[step].kind == Step::Kind::constant; }
  std::uint32_t bits(std::uint32_t constant) const { return steps_[constant].operands[0]; }

  std::uint32_t operation(Op op, const std::array<std::uint32_t, 3>& operands) {
    if (is_copy(op)) return operands[0];
    if (is_choice(op)) {
      if (operands[1] == operands[2]) return operands[1];
      if (is_constant(operands[0])) return operands[bits(operands[0]) != 0 ? 1 : 2];
    }
    const OpInfo& table = info(op);
    const Step step{Step::Kind::operation, type_of_letter(table.result), op, operands};
    return is_exact(step) ? folded(step) : add(step);
  }

  /// Whole numbers and conditions on constants: counters of loops, and what they decide.
  bool is_exact(const Step& step) const {
    const std::string_view letters = info(step.op).operands;
    if (step.type == Type::real || letters.find('f') != std::string_view::npos) return false;
    for (std::size_t i = 0; i < letters.size(); ++i) {
      if (!is_constant(step.operands[i])) return false;
    }
    return true;
  }

  std::uint32_t folded(const Step& step) {
    std::array<Cell<PointDomain<double>>, 4> cells;
    for (std::size_t i = 0; i < info(step.op).operands.size(); ++i) cells[i].i = bits(step.operands[i]);
    execute<PointDomain<double>>({step.op, 3, {0, 1, 2}}, cells.data());
    return constant(step.type, cells[3].i);
  }

  std::uint32_t negation(std::uint32_t a) {
    if (steps_[a].kind == Step::Kind::operation && steps_[a].op == Op::b_not) return steps_[a].operands[0];
    return operation(Op::b_not, {a, 0, 0});
  }
  std::uint32_t both(std::uint32_t a, std::uint32_t b) {
    if (a == true_ || b == false_ || a == b) return b;
    if (b == true_ || a == false_) return a;
    return operation(Op::b_and, {a, b, 0});
  }
  std::uint32_t either(std::uint32_t a, std::uint32_t b) {
    if (a == false_ || b == true_ || a == b) return b;
    if (b == false_ || a == true_) return a;
    return a == negation(b) ? true_ : operation(Op::b_or, {a, b, 0});
  }

  // ---- registers ----

  std::uint32_t value(Register r) {
    if (r >= program_.register_count()) {
      const std::uint32_t k = r - program_.register_count();
      return add({Step::Kind::hoisted, split_.hoisted[k].type, Op::f_copy, {k, 0, 0}});
    }
    return program_.is_variable(r) ? state_.values[r - program_.first_variable()] : registers_[r];
  }

  void set(Register r, std::uint32_t step) {
    (program_.is_variable(r) ? state_.values[r - program_.first_variable()] : registers_[r]) = step;
  }

  // ---- states ----

  /// Of two ways to the same place; where both come, `condition` tells which of them it was: a, or else b.
  State joined(const State& a, const State& b, std::uint32_t condition) {
    if (a.condition == false_) return b;
    if (b.condition == false_) return a;
    work_ += a.values.size();
    if (work_ > most_work) refuse("its branches are too many for its variables");
    State out = b;
    for (std::size_t k = 0; k < out.values.size() && error_.empty(); ++k) {
      const std::uint32_t one = a.values[k], other = b.values[k];
      if (one != other) out.values[k] = operation(choice_of(steps_[one].type), {condition, one, other});
    }
    out.condition = either(a.condition, b.condition);
    return out;
  }

  void resume(std::vector<State> waiting) {
    for (State& state : waiting) state_ = joined(state, state_, state.condition);
  }

  void wait_in(std::vector<State>& place) {
    place.push_back(state_);
    work_ += state_.values.size();
    state_.condition = false_;
  }

  Construct& innermost_loop() {
    return *std::find_if(constructs_.rbegin(), constructs_.rend(), [](const Construct& one) { return one.is_loop; });
  }

  // ---- control flow ----

  void run(const Sequence& sequence) {
    for (const Node& node : sequence) {
      if (!alive()) return;
      run(node);
    }
  }

  void run(const Node& node) {
    switch (node.kind) {
      case Node::Kind::run:
        for (std::uint32_t k = node.first; k < node.first + node.count && error_.empty(); ++k) {
          run(program_.instructions[k]);
        }
        break;
      case Node::Kind::branch:
        run_branch(node);
        break;
      case Node::Kind::block:
        run_block(node);
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

  void run_branch(const Node& branch) {
    const std::uint32_t condition = value(branch.condition);
    if (is_constant(condition)) return run(bits(condition) != 0 ? branch.body : branch.other);
    const State before = state_;
    const std::uint32_t when_true = both(before.condition, condition);
    const std::uint32_t when_false = both(before.condition, negation(condition));
    state_.condition = when_true;
    run(branch.body);
    const State after_body = std::move(state_);
    state_ = before;
    state_.condition = when_false;
    run(branch.other);
    const bool all_come = after_body.condition == when_true && state_.condition == when_false;
    state_ = joined(after_body, state_, all_come ? condition : after_body.condition);
    if (all_come) state_.condition = before.condition;
  }

  /// What came in comes out, but for what goes on with the next round of a loop around.
  void run_block(const Node& block) {
    const std::uint32_t condition = state_.condition;
    const std::size_t repeated = waiting_for_rounds();
    constructs_.push_back({.is_loop = false, .left = {}, .repeated = {}});
    run(block.body);
    std::vector<State> left = std::move(constructs_.back().left);
    constructs_.pop_back();
    resume(std::move(left));
    if (alive() && waiting_for_rounds() == repeated) state_.condition = condition;
  }

  std::size_t waiting_for_rounds() const {
    const auto loop = std::ranges::find_if(constructs_.rbegin(), constructs_.rend(), &Construct::is_loop);
    return loop == constructs_.rend() ? 0 : loop->repeated.size();
  }

  void run_loop(const Node& loop) {
    const std::uint32_t condition = state_.condition;
    constructs_.push_back({.is_loop = true, .left = {}, .repeated = {}});
    for (int round = 0; alive(); ++round) {
      if (round == most_rounds) refuse("a loop of it runs as often as the point or the time decides");
      run(loop.body);
      resume(std::exchange(constructs_.back().repeated, {}));
      run(loop.other);
    }
    std::vector<State> left = std::move(constructs_.back().left);
    constructs_.pop_back();
    state_.condition = false_;
    resume(std::move(left));
    if (alive()) state_.condition = condition;
  }

  void run(const Instruction& instruction) {
    const auto& operands = instruction.operands;
    if (is_load(instruction.op)) {
      const std::size_t place = element(operands[0], operands[1]);
      if (error_.empty()) set(instruction.result, state_.values[place]);
    } else if (is_store(instruction.op)) {
      const std::size_t place = element(operands[0], operands[1]);
      if (error_.empty()) state_.values[place] = value(operands[2]);
    } else {
      std::array<std::uint32_t, 3> steps{};
      for (std::size_t i = 0; i < info(instruction.op).operands.size(); ++i) steps[i] = value(operands[i]);
      set(instruction.result, operation(instruction.op, steps));
    }
  }

  /// Where an element stands in a state's values; an index outside is clamped.
  std::size_t element(Register array, Register index) {
    const std::uint32_t step = value(index);
    if (!is_constant(step)) {
      refuse("an array of it is read or written where the point or the time decides");
      return 0;
    }
    const auto wished = static_cast<std::int32_t>(bits(step));
    const auto last = static_cast<std::int32_t>(program_.arrays[array].size) - 1;
    return program_.variables.size() + starts_[array] + static_cast<std::size_t>(std::clamp(wished, 0, last));
  }

  // ---- order ----

  /// What reaches the result, operands before what uses them, of these first the one that needs the most values at a
  /// time: then few values wait (Sethi, Ullman 1970, "The Generation of Optimal Code for Arithmetic Expressions", as if
  /// shared steps were not). What is cheap and was made long ago is made anew, for each value that waits takes a
  /// register.
  StraightLine ordered(std::uint32_t result) const {
    const std::vector<std::uint32_t> needs = values_needed(), sizes = tree_sizes();
    StraightLine line;
    std::vector<std::uint32_t> number(steps_.size(), unnumbered);
    const auto is_there = [&](std::uint32_t k) {
      return number[k] != unnumbered && (sizes[k] > cheap_steps || line.steps.size() - number[k] <= long_ago_steps);
    };
    std::vector<std::uint32_t> pending{result};
    while (!pending.empty()) {
      const std::uint32_t k = pending.back();
      if (is_there(k)) {
        pending.pop_back();
        continue;
      }
      Step step = steps_[k];
      std::vector<std::uint32_t> missing;
      for (std::uint32_t i = 0; i < operand_count(step); ++i) {
        if (!is_there(step.operands[i])) missing.push_back(step.operands[i]);
      }
      std::ranges::stable_sort(missing, {}, [&](std::uint32_t operand) { return needs[operand]; });
      pending.insert(pending.end(), missing.begin(), missing.end());
      if (!missing.empty()) continue;
      pending.pop_back();
      for (std::uint32_t i = 0; i < operand_count(step); ++i) step.operands[i] = number[step.operands[i]];
      number[k] = static_cast<std::uint32_t>(line.steps.size());
      line.steps.push_back(step);
    }
    return line;
  }

  /// Steps that making each value anew would take; points and constants need no register and are never made anew.
  std::vector<std::uint32_t> tree_sizes() const {
    std::vector<std::uint32_t> sizes(steps_.size(), cheap_steps + 1);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      const Step& step = steps_[k];
      if (step.kind == Step::Kind::hoisted) sizes[k] = 1;
      if (step.kind != Step::Kind::operation) continue;
      sizes[k] = 1;
      for (std::uint32_t i = 0; i < operand_count(step); ++i) {
        const Step& operand = steps_[step.operands[i]];
        const bool is_free = operand.kind == Step::Kind::point || operand.kind == Step::Kind::constant;
        sizes[k] = std::min(sizes[k] + (is_free ? 0 : sizes[step.operands[i]]), cheap_steps + 1);
      }
    }
    return sizes;
  }

  std::vector<std::uint32_t> values_needed() const {
    std::vector<std::uint32_t> needs(steps_.size(), 0);
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      const Step& step = steps_[k];
      std::array<std::uint32_t, 3> of{};
      for (std::uint32_t i = 0; i < operand_count(step); ++i) of[i] = needs[step.operands[i]];
      std::ranges::sort(of, std::ranges::greater());
      if (step.kind == Step::Kind::operation) needs[k] = std::max({of[0], of[1] + 1, of[2] + 2});
    }
    return needs;
  }

  static constexpr std::uint32_t unnumbered = ~0u;

  const TimeSplit& split_;
  const Program& program_;
  std::vector<std::size_t> starts_;
  std::vector<std::uint32_t> registers_;  ///< the step that is each constant, input and temporary now
  std::vector<Step> steps_;
  std::map<std::tuple<Step::Kind, Type, Op, std::array<std::uint32_t, 3>>, std::uint32_t> known_;
  State state_;
  std::vector<Construct> constructs_;
  std::uint32_t false_ = 0, true_ = 0;
  std::size_t work_ = 0;
  std::string error_;
};

}  // namespace

Result<StraightLine> straighten(const TimeSplit& split) { return Straightener(split).run(); }

}  // namespace dmvv::compiler::snippet
