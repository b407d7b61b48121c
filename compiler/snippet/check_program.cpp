#include "compiler/snippet/check_program.h"

#include <algorithm>
#include <cstdint>

#include "compiler/snippet/operands.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr std::uint64_t most_cells = 1u << 20;  // of all arrays: a file cannot ask for more memory than that
constexpr std::uint32_t most_nested = 200;      // sequences within sequences, each a call of an evaluator

class Check {
 public:
  explicit Check(const Program& program) : program_(program) {}

  std::string run() {
    if (!has_valid_types()) return "a type or an array that there is not";
    if (program_.result >= program_.register_count() || program_.type(program_.result) != Type::real)
      return "a result that is no float";
    if (!std::ranges::all_of(program_.instructions, [&](const Instruction& i) { return is_valid(i); }))
      return "an instruction whose operands it cannot have";
    if (!is_valid(program_.body, {}, 0)) return "control flow that leads nowhere";
    return {};
  }

 private:
  /// What a sequence may do, by what it stands in.
  struct Within {
    bool leave = false, repeat = false;
  };

  static bool is_type(Type type) { return type <= Type::boolean; }

  bool has_valid_types() const {
    std::uint64_t cells = 0;
    for (const Array& array : program_.arrays) {
      if (!is_type(array.type) || array.size == 0) return false;
      cells += array.size;
    }
    return cells <= most_cells && std::ranges::all_of(program_.constants, is_type, &Constant::type) &&
           std::ranges::all_of(program_.variables, is_type) && std::ranges::all_of(program_.temporaries, is_type);
  }

  bool is_register(Register r, char letter) const {
    return r < program_.register_count() && program_.type(r) == type_of_letter(letter);
  }

  bool is_valid(const Instruction& instruction) const {
    if (static_cast<std::size_t>(instruction.op) >= op_count) return false;
    const OpInfo& op = info(instruction.op);
    const Type array = op.operands[0] == 'a' && instruction.operands[0] < program_.arrays.size()
                           ? program_.arrays[instruction.operands[0]].type
                           : Type::real;
    for (std::size_t i = 0; i < op.operands.size(); ++i) {
      const Register operand = instruction.operands[i];
      if (op.operands[i] == 'a' ? operand >= program_.arrays.size() : !is_register(operand, op.operands[i]))
        return false;
    }
    if (op.operands[0] == 'a' && array != type_of_letter(is_store(instruction) ? op.operands[2] : op.result))
      return false;
    return is_store(instruction) ||
           (instruction.result >= program_.first_variable() && is_register(instruction.result, op.result));
  }

  bool is_valid(const Sequence& sequence, Within within, std::uint32_t depth) const {
    return depth < most_nested &&
           std::ranges::all_of(sequence, [&](const Node& node) { return is_valid(node, within, depth + 1); });
  }

  bool is_valid(const Node& node, Within within, std::uint32_t depth) const {
    switch (node.kind) {
      case Node::Kind::run:
        return node.first <= program_.instructions.size() && node.count <= program_.instructions.size() - node.first;
      case Node::Kind::branch:
        return is_register(node.condition, 'b') && is_valid(node.body, within, depth) &&
               is_valid(node.other, within, depth);
      case Node::Kind::loop:
        return is_valid(node.body, {.leave = true, .repeat = true}, depth) &&
               is_valid(node.other, {.leave = true}, depth);
      case Node::Kind::block:
        return is_valid(node.body, {.leave = true, .repeat = within.repeat}, depth);
      case Node::Kind::leave:
        return within.leave;
      case Node::Kind::repeat:
        return within.repeat;
    }
    return false;
  }

  const Program& program_;
};

}  // namespace

std::string fault_of(const Program& program) { return Check(program).run(); }

}  // namespace dmvv::compiler::snippet
