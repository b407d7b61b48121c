#include "compiler/snippet/program.h"

#include <fmt/format.h>

#include <algorithm>

#include <bit>

namespace dmvv::compiler::snippet {

namespace {

constexpr OpInfo op_table[] = {
#define DMVV_OP(name, result, operands) {#name, *#result, operands},
#include "compiler/snippet/ops.def"
#undef DMVV_OP
};

constexpr char letter(Type type) { return "fiub"[static_cast<int>(type)]; }

std::string text_of(const Constant& constant) {
  switch (constant.type) {
    case Type::real:
      return fmt::format("{}", std::bit_cast<float>(constant.bits));
    case Type::integer:
      return fmt::format("{}", static_cast<std::int32_t>(constant.bits));
    case Type::unsigned_integer:
      return fmt::format("{}u", constant.bits);
    case Type::boolean:
      return constant.bits != 0 ? "true" : "false";
  }
  return {};
}

std::string text_of(const Program& program, Register r) {
  static constexpr const char* inputs[] = {"p.x", "p.y", "p.z", "t"};
  if (r < Program::input_count) return inputs[r];
  if (program.is_constant(r)) return text_of(program.constant(r));
  if (program.is_variable(r)) return fmt::format("v{}", r - program.first_variable());
  return fmt::format("r{}", r - program.first_temporary());
}

std::string text_of(const Program& program, const Instruction& instruction) {
  const OpInfo& op = info(instruction.op);
  std::string text = op.result == '-'
                         ? std::string(op.name)
                         : fmt::format("{}:{} = {}", text_of(program, instruction.result), op.result, op.name);
  for (std::size_t i = 0; i < op.operands.size(); ++i) {
    const Register r = instruction.operands[i];
    text += op.operands[i] == 'a' ? fmt::format(" a{}", r) : ' ' + text_of(program, r);
  }
  return text;
}

void append(std::string& out, const Program& program, const Sequence& sequence, std::size_t indent) {
  const std::string margin(indent, ' ');
  const auto nested = [&](const char* title, const Sequence& inner) {
    out += margin + title + '\n';
    append(out, program, inner, indent + 2);
  };
  for (const Node& node : sequence) {
    switch (node.kind) {
      case Node::Kind::run:
        for (std::uint32_t i = 0; i < node.count; ++i) {
          out += margin + text_of(program, program.instructions[node.first + i]) + '\n';
        }
        break;
      case Node::Kind::branch:
        nested(("if " + text_of(program, node.condition)).c_str(), node.body);
        if (!node.other.empty()) nested("else", node.other);
        break;
      case Node::Kind::loop:
        nested("loop", node.body);
        if (!node.other.empty()) nested("continuing", node.other);
        break;
      case Node::Kind::block:
        nested("block", node.body);
        break;
      case Node::Kind::leave:
        out += margin + "leave\n";
        break;
      case Node::Kind::repeat:
        out += margin + "repeat\n";
        break;
    }
  }
}

/// May control leave or repeat what is around the sequence?
bool exits(const Sequence& sequence) {
  return std::any_of(sequence.begin(), sequence.end(), [](const Node& node) {
    if (node.kind == Node::Kind::leave || node.kind == Node::Kind::repeat) return true;
    return node.kind == Node::Kind::branch && (exits(node.body) || exits(node.other));
  });
}

}  // namespace

const OpInfo& info(Op op) { return op_table[static_cast<std::size_t>(op)]; }

Type type_of_letter(char letter) {
  switch (letter) {
    case 'f':
      return Type::real;
    case 'i':
      return Type::integer;
    case 'u':
      return Type::unsigned_integer;
    default:
      return Type::boolean;
  }
}

Type Program::type(Register r) const {
  if (r < input_count) return Type::real;
  if (is_constant(r)) return constant(r).type;
  if (is_variable(r)) return variables[r - first_variable()];
  return temporaries[r - first_temporary()];
}

std::uint32_t nesting(const Sequence& sequence) {
  std::uint32_t deepest = 0, passed = 0;
  for (const Node& node : sequence) {
    const std::uint32_t own = node.kind == Node::Kind::branch || node.kind == Node::Kind::loop ? 1 : 0;
    deepest = std::max(deepest, passed + own + std::max(nesting(node.body), nesting(node.other)));
    if (node.kind == Node::Kind::branch && (exits(node.body) || exits(node.other))) ++passed;
  }
  return deepest;
}

bool repeats(const Sequence& body) {
  return std::ranges::any_of(body, [](const Node& node) {
    if (node.kind == Node::Kind::loop) return false;
    return node.kind == Node::Kind::repeat || repeats(node.body) || repeats(node.other);
  });
}

std::string to_text(const Program& program) {
  std::string out;
  for (std::size_t i = 0; i < program.arrays.size(); ++i) {
    out += fmt::format("a{}:{}[{}]\n", i, letter(program.arrays[i].type), program.arrays[i].size);
  }
  append(out, program, program.body, 0);
  return out + "return " + text_of(program, program.result) + '\n';
}

}  // namespace dmvv::compiler::snippet
