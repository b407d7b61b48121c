#include <bit>

#include "compiler/snippet/evaluate.h"
#include "compiler/snippet/machine.h"
#include "compiler/snippet/point_domain.h"

namespace dmvv::compiler::snippet {

namespace {

template <class Domain>
class PointMachine {
 public:
  using Real = typename Domain::Real;

  PointMachine(const Program& program, const std::array<Real, Program::input_count>& inputs)
      : program_(program), cells_(program.register_count()) {
    for (Register r = 0; r < Program::input_count; ++r) cells_[r].f = inputs[r];
    for (std::size_t k = 0; k < program.constants.size(); ++k) {
      const Constant& constant = program.constants[k];
      Cell<Domain>& cell = cells_[program.first_constant() + k];
      if (constant.type == Type::real) {
        cell.f = Real(static_cast<double>(std::bit_cast<float>(constant.bits)));
      } else {
        cell.i = constant.bits;
      }
    }
    if (program.arrays.empty()) return;
    starts_ = array_starts(program);
    memory_.resize(starts_.back());
  }

  Evaluated<Real> run() {
    if (run(program_.body) == Flow::gives_up) return {Domain::nan(), false};
    return {cells_[program_.result].f, true};
  }

 private:
  enum class Flow : std::uint8_t { goes_on, leaves, repeats, gives_up };

  Flow run(const Sequence& sequence) {
    for (const Node& node : sequence) {
      const Flow flow = run(node);
      if (flow != Flow::goes_on) return flow;
    }
    return Flow::goes_on;
  }

  Flow run(const Node& node) {
    steps_ += node.count + 1;
    if (steps_ > Snippet::step_budget) return Flow::gives_up;
    switch (node.kind) {
      case Node::Kind::run:
        run_instructions(node);
        return Flow::goes_on;
      case Node::Kind::branch:
        return run(cells_[node.condition].i != 0 ? node.body : node.other);
      case Node::Kind::block:
        return after_break(run(node.body));
      case Node::Kind::loop:
        return run_loop(node);
      case Node::Kind::leave:
        return Flow::leaves;
      case Node::Kind::repeat:
        return Flow::repeats;
    }
    return Flow::goes_on;
  }

  static Flow after_break(Flow flow) { return flow == Flow::leaves ? Flow::goes_on : flow; }

  Flow run_loop(const Node& loop) {
    for (;;) {
      Flow flow = run(loop.body);
      if (flow == Flow::leaves || flow == Flow::gives_up) return after_break(flow);
      flow = run(loop.other);
      if (flow == Flow::leaves || flow == Flow::gives_up) return after_break(flow);
      if (++steps_ > Snippet::step_budget) return Flow::gives_up;
    }
  }

  void run_instructions(const Node& node) {
    const Instruction* instruction = program_.instructions.data() + node.first;
    for (const Instruction* end = instruction + node.count; instruction != end; ++instruction) {
      if (is_load(instruction->op)) {
        cells_[instruction->result] = element(*instruction);
      } else if (is_store(instruction->op)) {
        element(*instruction) = cells_[instruction->operands[2]];
      } else {
        execute<Domain>(*instruction, cells_.data());
      }
    }
  }

  Cell<Domain>& element(const Instruction& instruction) {
    const Register array = instruction.operands[0];
    const auto index = static_cast<std::int32_t>(cells_[instruction.operands[1]].i);
    const auto last = static_cast<std::int32_t>(program_.arrays[array].size) - 1;
    return memory_[starts_[array] + static_cast<std::size_t>(std::clamp(index, 0, last))];
  }

  const Program& program_;
  std::vector<Cell<Domain>> cells_;
  std::vector<Cell<Domain>> memory_;
  std::vector<std::size_t> starts_;
  std::uint64_t steps_ = 0;
};

}  // namespace

template <class Real>
Evaluated<Real> evaluate_point(const Program& program, const std::array<Real, Program::input_count>& inputs) {
  return PointMachine<PointDomain<Real>>(program, inputs).run();
}

template Evaluated<double> evaluate_point(const Program&, const std::array<double, Program::input_count>&);
template Evaluated<float> evaluate_point(const Program&, const std::array<float, Program::input_count>&);
template Evaluated<DualNumber> evaluate_point(const Program&, const std::array<DualNumber, Program::input_count>&);

}  // namespace dmvv::compiler::snippet
