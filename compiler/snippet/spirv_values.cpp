// A value of SPIR-V is known by its id, as the registers of its scalars; what an instruction makes is added to these.
#include "compiler/snippet/spirv_values.h"

#include <fmt/format.h>
#include <glslang/SPIRV/GLSL.std.450.h>

#include <algorithm>
#include <glslang/SPIRV/spirv.hpp>

namespace dmvv::compiler::snippet {

namespace {

constexpr std::uint32_t undefined_component = 0xffffffffu;

Register or_all(ProgramBuilder& b, Op op, const Scalars& x) {
  Register r = x[0];
  for (std::size_t i = 1; i < x.size(); ++i) r = b.emit(op, {r, x[i]});
  return r;
}

}  // namespace

SpirvValues::SpirvValues(const SpirvModule& module, ProgramBuilder& builder) : module_(module), builder_(builder) {
  for (const auto& [id, definition] : module_.definitions) {
    if (definition.opcode == spv::OpVariable) declare(definition);
  }
  for (const SpirvInstruction& local : module_.locals) declare(local);
  if (!has_output_) refuse("the SPIR-V has no output of type float at location 0");
}

void SpirvValues::refuse(std::string reason) {
  if (error_.empty()) error_ = std::move(reason);
}

const SpirvType& SpirvValues::type_of(SpirvId type) const {
  static const SpirvType none;
  const auto place = module_.types.find(type);
  return place == module_.types.end() ? none : place->second;
}

void SpirvValues::add_scalar_types(SpirvId id, std::vector<Type>& out) const {
  const SpirvType& type = type_of(id);
  if (type.kind == SpirvType::Kind::scalar) {
    out.push_back(type.scalar);
  } else if (type.kind == SpirvType::Kind::structure) {
    for (const SpirvId member : type.members) add_scalar_types(member, out);
  } else if (!type.members.empty()) {
    for (std::uint32_t i = 0; i < type.count; ++i) add_scalar_types(type.members[0], out);
  }
}

Scalars SpirvValues::zeros(SpirvId type) {
  std::vector<Type> types;
  add_scalar_types(type, types);
  Scalars out;
  for (const Type t : types) out.push_back(builder_.constant(t, 0));
  return out;
}

Scalars SpirvValues::constant_value(const SpirvInstruction& definition) {
  const Type type = type_of(definition.type).scalar;
  switch (definition.opcode) {
    case spv::OpConstantTrue:
    case spv::OpSpecConstantTrue:
      return {builder_.constant(Type::boolean, 1)};
    case spv::OpConstantFalse:
    case spv::OpSpecConstantFalse:
      return {builder_.constant(Type::boolean, 0)};
    case spv::OpConstant:
    case spv::OpSpecConstant:
      return {builder_.constant(type, definition.operands[0])};
    case spv::OpConstantNull:
    case spv::OpUndef:
      return zeros(definition.type);
    case spv::OpConstantComposite:
    case spv::OpSpecConstantComposite: {
      Scalars out;
      for (const SpirvId member : definition.operands) {
        const Scalars scalars = value(member);
        out.insert(out.end(), scalars.begin(), scalars.end());
      }
      return out;
    }
    default:
      refuse(opcode_name(definition.opcode) + " is not known here");
      return zeros(definition.type);
  }
}

Scalars SpirvValues::value(SpirvId id) {
  if (const auto known = values_.find(id); known != values_.end()) return known->second;
  const auto definition = module_.definitions.find(id);
  if (definition != module_.definitions.end()) {
    const Scalars scalars = constant_value(definition->second);
    value_types_[id] = definition->second.type;
    return values_[id] = scalars;
  }
  refuse(fmt::format("value %{} is used before it is computed", id));
  return Scalars(1, builder_.real(0.0f));
}

const SpirvType& SpirvValues::value_type(SpirvId id) const {
  const auto known = value_types_.find(id);
  return type_of(known == value_types_.end() ? 0 : known->second);
}

Scalars SpirvValues::as(Type type, Scalars values) {
  for (Register& r : values) r = as_type(builder_, type, r);
  return values;
}

const Scalars& SpirvValues::phi(const SpirvInstruction& instruction) {
  const auto [place, is_new] = values_.try_emplace(instruction.result);
  if (is_new && instruction.operands.size() == 2) {  // one way in: another name for the value
    place->second = value(instruction.operands[0]);
    value_types_[instruction.result] = instruction.type;
  } else if (is_new) {
    std::vector<Type> types;
    add_scalar_types(instruction.type, types);
    for (const Type type : types) place->second.push_back(builder_.variable(type));
    value_types_[instruction.result] = instruction.type;
  }
  return place->second;
}

// ---- composites ----

std::uint32_t SpirvValues::member_offset(SpirvId& id, std::span<const std::uint32_t> path) const {
  std::uint32_t offset = 0;
  for (const std::uint32_t i : path) {
    const SpirvType& type = type_of(id);
    const bool is_struct = type.kind == SpirvType::Kind::structure;
    for (std::uint32_t k = 0; k < i; ++k) offset += type_of(type.members[is_struct ? k : 0]).size;
    id = type.members[is_struct ? i : 0];
  }
  return offset;
}

bool SpirvValues::execute_composite(const SpirvInstruction& instruction) {
  const auto& operands = instruction.operands;
  Scalars out;
  switch (instruction.opcode) {
    case spv::OpCompositeConstruct:
      for (const SpirvId member : operands) {
        const Scalars scalars = value(member);
        out.insert(out.end(), scalars.begin(), scalars.end());
      }
      break;
    case spv::OpCompositeExtract: {
      const Scalars whole = value(operands[0]);
      SpirvId type = value_types_[operands[0]];
      const std::uint32_t first = member_offset(type, operands.subspan(1));
      out = slice(whole, first, type_of(type).size);
      break;
    }
    case spv::OpCompositeInsert: {
      const Scalars part = value(operands[0]);
      out = value(operands[1]);
      SpirvId type = value_types_[operands[1]];
      const std::uint32_t first = member_offset(type, operands.subspan(2));
      std::copy(part.begin(), part.end(), out.begin() + first);
      break;
    }
    case spv::OpVectorShuffle: {
      Scalars both = value(operands[0]);
      const Scalars second = value(operands[1]);
      both.insert(both.end(), second.begin(), second.end());
      for (const std::uint32_t i : operands.subspan(2)) out.push_back(i == undefined_component ? both[0] : both[i]);
      break;
    }
    case spv::OpVectorExtractDynamic: {
      const Scalars vector = value(operands[0]);
      const Register index = as_type(builder_, Type::integer, scalar(operands[1]));
      Register chosen = vector.back();
      for (std::size_t k = vector.size() - 1; k-- > 0;) {
        const Register hit = builder_.emit(Op::i_eq, {index, builder_.integer(static_cast<std::int32_t>(k))});
        chosen = select(builder_, hit, vector[k], chosen);
      }
      out = {chosen};
      break;
    }
    case spv::OpVectorInsertDynamic: {
      out = value(operands[0]);
      const Register component = scalar(operands[1]);
      const Register index = as_type(builder_, Type::integer, scalar(operands[2]));
      for (std::size_t k = 0; k < out.size(); ++k) {
        const Register hit = builder_.emit(Op::i_eq, {index, builder_.integer(static_cast<std::int32_t>(k))});
        out[k] = select(builder_, hit, component, out[k]);
      }
      break;
    }
    case spv::OpCopyObject:
    case spv::OpCopyLogical:
      out = value(operands[0]);
      break;
    case spv::OpUndef:
      out = zeros(instruction.type);
      break;
    case spv::OpSelect: {
      Scalars condition = value(operands[0]);
      const Scalars x = value(operands[1]), y = value(operands[2]);
      condition.resize(x.size(), condition[0]);
      for (std::size_t i = 0; i < x.size(); ++i) out.push_back(select(builder_, condition[i], x[i], y[i]));
      break;
    }
    case spv::OpAny:
      out = {or_all(builder_, Op::b_or, value(operands[0]))};
      break;
    case spv::OpAll:
      out = {or_all(builder_, Op::b_and, value(operands[0]))};
      break;
    default:
      return false;
  }
  values_[instruction.result] = std::move(out);
  return true;
}

// ---- built-ins ----

void SpirvValues::execute_glsl(const SpirvInstruction& instruction) {
  const auto& operands = instruction.operands;
  if (operands[0] != module_.glsl_instructions) return refuse("an instruction set other than GLSL.std.450 is used");
  const std::uint32_t number = operands[1];
  const bool writes = number == GLSLstd450Modf || number == GLSLstd450Frexp;
  std::vector<Scalars> arguments;
  for (const SpirvId argument : operands.subspan(2, writes ? 1 : operands.size() - 2))
    arguments.push_back(value(argument));
  const auto result = glsl_function(builder_, number, arguments);
  if (!result) return refuse(fmt::format("built-in {} of GLSL.std.450 is not known here", number));
  Scalars out = *result;
  if (writes) {
    const std::size_t half = out.size() / 2;
    const Place to = place(operands[3]);
    if (error_.empty()) store(to, slice(out, half, half));
    out.resize(half);
  }
  const SpirvType& type = type_of(instruction.type);
  if (type.kind != SpirvType::Kind::structure) {
    std::vector<Type> wanted;
    add_scalar_types(instruction.type, wanted);
    out = as(wanted[0], std::move(out));
  }
  values_[instruction.result] = std::move(out);
}

void SpirvValues::execute(const SpirvInstruction& instruction) {
  if (!error_.empty() || instruction.opcode == spv::OpNop || instruction.opcode == spv::OpLifetimeStart ||
      instruction.opcode == spv::OpLifetimeStop) {
    return;
  }
  if (instruction.result != 0) value_types_[instruction.result] = instruction.type;
  if (instruction.opcode == spv::OpFunctionCall) return refuse("recursion: a function calls itself");
  if (execute_memory(instruction) || execute_composite(instruction)) return;
  if (instruction.opcode == spv::OpExtInst) return execute_glsl(instruction);
  if (instruction.opcode == spv::OpBitcast) {
    values_[instruction.result] = as(type_of(instruction.type).scalar, value(instruction.operands[0]));
    return;
  }
  if (execute_matrix(instruction) || execute_bits(instruction)) return;
  if (!execute_scalarwise(instruction)) {
    refuse(opcode_name(instruction.opcode) + " is not something a distance function can use");
  }
}

}  // namespace dmvv::compiler::snippet
