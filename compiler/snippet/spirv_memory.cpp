// A module's variables are registers and local arrays here, its pointers places among them.
#include <fmt/format.h>

#include <algorithm>
#include <glslang/SPIRV/spirv.hpp>

#include "compiler/snippet/spirv_values.h"

namespace dmvv::compiler::snippet {

namespace {

constexpr std::uint32_t max_array_scalars = 4096;

}  // namespace

void SpirvValues::declare_leaves(SpirvId id, std::uint32_t copies, Variable& variable) {
  const SpirvType& type = type_of(id);
  switch (type.kind) {
    case SpirvType::Kind::scalar: {
      const bool is_array = copies > 1;
      array_scalars_ += is_array ? copies : 0;
      if (array_scalars_ > max_array_scalars) {
        return refuse(fmt::format("local arrays with computed indices hold more than {} scalars", max_array_scalars));
      }
      const Register place = is_array ? builder_.array(type.scalar, copies) : builder_.variable(type.scalar);
      variable.leaves.push_back({type.scalar, copies, place, is_array});
      break;
    }
    case SpirvType::Kind::vector:
    case SpirvType::Kind::matrix:
      for (std::uint32_t i = 0; i < type.count; ++i) declare_leaves(type.members[0], copies, variable);
      break;
    case SpirvType::Kind::array:
      declare_leaves(type.members[0], copies * type.count, variable);
      break;
    case SpirvType::Kind::structure:
      for (const SpirvId member : type.members) declare_leaves(member, copies, variable);
      break;
    default:
      refuse("a variable is neither number nor composite of numbers");
  }
}

void SpirvValues::declare(const SpirvInstruction& instruction) {
  const auto storage = static_cast<spv::StorageClass>(instruction.operands[0]);
  const SpirvId type = type_of(instruction.type).members.empty() ? 0 : type_of(instruction.type).members[0];
  const auto location = module_.locations.find(instruction.result);
  Variable variable;
  if (storage == spv::StorageClassInput) {
    const bool is_point = location != module_.locations.end() && location->second == 0 && type_of(type).size == 3;
    const bool is_time = location != module_.locations.end() && location->second == 1 && type_of(type).size == 1;
    if (!is_point && !is_time) return;  // a use of it is refused
    for (Register i = 0; i < type_of(type).size; ++i) {
      variable.leaves.push_back({Type::real, 1, is_point ? i : Program::t, false});
    }
    variable.read_only = true;
  } else if (storage == spv::StorageClassFunction || storage == spv::StorageClassPrivate ||
             (storage == spv::StorageClassOutput && location != module_.locations.end())) {
    declare_leaves(type, 1, variable);
  } else {
    return;
  }
  if (storage == spv::StorageClassOutput && location->second == 0 && variable.leaves.size() == 1 &&
      variable.leaves[0].type == Type::real) {
    output_ = variable.leaves[0].place;
    has_output_ = true;
  }
  variables_[instruction.result] = std::move(variable);
  places_[instruction.result] = {.variable = instruction.result, .type = type, .dynamic = {}, .choices = {}};
  if (instruction.operands.size() > 1 && error_.empty())
    store(places_[instruction.result], value(instruction.operands[1]));
}

const SpirvValues::Place& SpirvValues::place(SpirvId pointer) {
  const auto known = places_.find(pointer);
  if (known != places_.end()) return known->second;
  refuse("it reads something that is neither its point, nor time, nor a variable of its own");
  static const Place nowhere{.variable = 0, .type = 0, .dynamic = {}, .choices = {}};
  return nowhere;
}

void SpirvValues::step(Place& at, SpirvId index_id) {
  const SpirvType& type = type_of(at.type);
  const Register index = as_type(builder_, Type::integer, scalar(index_id));
  const bool known = builder_.is_constant(index);
  const std::uint32_t i = known ? std::min(builder_.constant_bits(index), type.count - 1) : 0;
  if (type.kind == SpirvType::Kind::structure) {
    for (std::uint32_t k = 0; k < i; ++k) at.leaf += type_of(type.members[k]).leaves;
    at.type = type.members[i];
    return;
  }
  if (type.members.empty()) return refuse("an index into something that has no members");
  const std::uint32_t stride = type_of(type.members[0]).leaves;
  at.type = type.members[0];
  if (type.kind != SpirvType::Kind::array) {
    if (known) at.leaf += i * stride;
    if (!known) at.choices.push_back({index, type.count, stride});
    return;
  }
  at.offset = at.offset * type.count + i;
  if (at.dynamic) {
    at.dynamic = builder_.emit(Op::i_mul, {*at.dynamic, builder_.integer(static_cast<std::int32_t>(type.count))});
  }
  if (!known) at.dynamic = at.dynamic ? builder_.emit(Op::i_add, {*at.dynamic, index}) : index;
}

Register SpirvValues::index_register(const Place& at) {
  const Register offset = builder_.integer(static_cast<std::int32_t>(at.offset));
  if (!at.dynamic) return offset;
  return at.offset == 0 ? *at.dynamic : builder_.emit(Op::i_add, {*at.dynamic, offset});
}

void SpirvValues::load_scalars(Place at, Scalars& out) {
  const SpirvType& type = type_of(at.type);
  if (type.kind == SpirvType::Kind::scalar) {
    constexpr Op loads[] = {Op::f_load, Op::i_load, Op::u_load, Op::b_load};
    const Variable& variable = variables_[at.variable];
    const Leaf& leaf = variable.leaves[at.leaf];
    if (leaf.is_array) {
      out.push_back(builder_.emit(loads[static_cast<std::size_t>(leaf.type)], {leaf.place, index_register(at)}));
    } else {
      out.push_back(variable.read_only ? leaf.place : builder_.copy(leaf.place));
    }
    return;
  }
  for (std::uint32_t i = 0; i < type.count; ++i) load_scalars(part(at, i), out);
}

/// The place of member, component or element i.
SpirvValues::Place SpirvValues::part(const Place& whole, std::uint32_t i) {
  const SpirvType& type = type_of(whole.type);
  Place at = whole;
  at.type = type.members[type.kind == SpirvType::Kind::structure ? i : 0];
  if (type.kind == SpirvType::Kind::structure) {
    for (std::uint32_t k = 0; k < i; ++k) at.leaf += type_of(type.members[k]).leaves;
  } else if (type.kind == SpirvType::Kind::array) {
    at.offset = at.offset * type.count + i;
    if (at.dynamic) {
      at.dynamic = builder_.emit(Op::i_mul, {*at.dynamic, builder_.integer(static_cast<std::int32_t>(type.count))});
    }
  } else {
    at.leaf += i * type_of(at.type).leaves;
  }
  return at;
}

Scalars SpirvValues::load(Place at) {
  if (at.choices.empty()) {
    Scalars out;
    load_scalars(at, out);
    return out;
  }
  const Choice choice = at.choices.back();
  at.choices.pop_back();
  Scalars chosen;
  for (std::uint32_t k = choice.count; k-- > 0;) {
    Place alternative = at;
    alternative.leaf += k * choice.stride;
    const Scalars values = load(alternative);
    if (chosen.empty()) {
      chosen = values;
      continue;
    }
    const Register hit = builder_.emit(Op::i_eq, {choice.index, builder_.integer(static_cast<std::int32_t>(k))});
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = select(builder_, hit, values[i], chosen[i]);
  }
  return chosen;
}

void SpirvValues::store_scalars(Place at, const Scalars& values, std::size_t& next) {
  const SpirvType& type = type_of(at.type);
  if (type.kind == SpirvType::Kind::scalar) {
    constexpr Op stores[] = {Op::f_store, Op::i_store, Op::u_store, Op::b_store};
    const Leaf& leaf = variables_[at.variable].leaves[at.leaf];
    if (leaf.is_array) {
      builder_.store(stores[static_cast<std::size_t>(leaf.type)], leaf.place, index_register(at), values[next++]);
    } else {
      builder_.assign(leaf.place, values[next++]);
    }
    return;
  }
  for (std::uint32_t i = 0; i < type.count; ++i) store_scalars(part(at, i), values, next);
}

void SpirvValues::store(Place at, const Scalars& values) {
  if (at.choices.empty()) {
    std::size_t next = 0;
    store_scalars(at, values, next);
    return;
  }
  const Choice choice = at.choices.back();
  at.choices.pop_back();
  for (std::uint32_t k = 0; k < choice.count; ++k) {
    Place alternative = at;
    alternative.leaf += k * choice.stride;
    const Register hit = builder_.emit(Op::i_eq, {choice.index, builder_.integer(static_cast<std::int32_t>(k))});
    Scalars kept = load(alternative);
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = select(builder_, hit, values[i], kept[i]);
    store(alternative, kept);
  }
}

bool SpirvValues::execute_memory(const SpirvInstruction& instruction) {
  const auto& operands = instruction.operands;
  switch (instruction.opcode) {
    case spv::OpLoad: {
      const Place from = place(operands[0]);
      if (error_.empty()) values_[instruction.result] = load(from);
      return true;
    }
    case spv::OpStore: {
      const Place to = place(operands[0]);
      if (error_.empty()) store(to, value(operands[1]));
      return true;
    }
    case spv::OpCopyMemory: {
      const Place to = place(operands[0]), from = place(operands[1]);
      if (error_.empty()) store(to, load(from));
      return true;
    }
    case spv::OpAccessChain:
    case spv::OpInBoundsAccessChain: {
      Place at = place(operands[0]);
      for (const SpirvId index : operands.subspan(1)) {
        if (error_.empty()) step(at, index);
      }
      places_[instruction.result] = at;
      return true;
    }
    default:
      return false;
  }
}

}  // namespace dmvv::compiler::snippet
