#include "compiler/snippet/spirv_values.h"

#include <fmt/format.h>
#include <glslang/SPIRV/GLSL.std.450.h>

#include <algorithm>
#include <glslang/SPIRV/spirv.hpp>

namespace dmvv::compiler::snippet {

namespace {

constexpr std::uint32_t max_array_scalars = 4096;
constexpr std::uint32_t undefined_component = 0xffffffffu;

Register or_all(ProgramBuilder& b, Op op, const Scalars& x) {
  Register r = x[0];
  for (std::size_t i = 1; i < x.size(); ++i) r = b.emit(op, {r, x[i]});
  return r;
}

Scalars slice(const Scalars& all, std::size_t first, std::size_t count) {
  return {all.begin() + static_cast<std::ptrdiff_t>(first), all.begin() + static_cast<std::ptrdiff_t>(first + count)};
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

// ---- memory ----

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

// ---- vectors and matrices ----

bool SpirvValues::execute_matrix(const SpirvInstruction& instruction) {
  ProgramBuilder& b = builder_;
  const auto& operands = instruction.operands;
  const auto column = [](const Scalars& m, std::size_t rows, std::size_t c) { return slice(m, c * rows, rows); };
  const auto row = [](const Scalars& m, std::size_t rows, std::size_t r) {
    Scalars out;
    for (std::size_t i = r; i < m.size(); i += rows) out.push_back(m[i]);
    return out;
  };
  Scalars out;
  switch (instruction.opcode) {
    case spv::OpVectorTimesScalar:
    case spv::OpMatrixTimesScalar:
      out = scaled(b, value(operands[0]), scalar(operands[1]));
      break;
    case spv::OpDot:
      out = {dot(b, value(operands[0]), value(operands[1]))};
      break;
    case spv::OpMatrixTimesVector: {
      const Scalars m = value(operands[0]), v = value(operands[1]);
      const std::size_t rows = m.size() / v.size();
      for (std::size_t r = 0; r < rows; ++r) out.push_back(dot(b, row(m, rows, r), v));
      break;
    }
    case spv::OpVectorTimesMatrix: {
      const Scalars v = value(operands[0]), m = value(operands[1]);
      for (std::size_t c = 0; c < m.size() / v.size(); ++c) out.push_back(dot(b, v, column(m, v.size(), c)));
      break;
    }
    case spv::OpMatrixTimesMatrix: {
      const Scalars left = value(operands[0]), right = value(operands[1]);
      const std::size_t inner = value_type(operands[0]).count;
      const std::size_t rows = left.size() / inner;
      for (std::size_t c = 0; c < right.size() / inner; ++c) {
        for (std::size_t r = 0; r < rows; ++r) out.push_back(dot(b, row(left, rows, r), column(right, inner, c)));
      }
      break;
    }
    case spv::OpOuterProduct: {
      const Scalars x = value(operands[0]), y = value(operands[1]);
      for (const Register factor : y) {
        const Scalars one = scaled(b, x, factor);
        out.insert(out.end(), one.begin(), one.end());
      }
      break;
    }
    case spv::OpTranspose: {
      const Scalars m = value(operands[0]);
      const std::size_t rows = m.size() / value_type(operands[0]).count;
      for (std::size_t r = 0; r < rows; ++r) {
        const Scalars one = row(m, rows, r);
        out.insert(out.end(), one.begin(), one.end());
      }
      break;
    }
    default:
      return false;
  }
  values_[instruction.result] = std::move(out);
  return true;
}

// ---- bits ----

bool SpirvValues::execute_bits(const SpirvInstruction& instruction) {
  ProgramBuilder& b = builder_;
  const auto& operands = instruction.operands;
  const auto u = [&](std::uint32_t v) { return b.constant(Type::unsigned_integer, v); };
  const auto unsigned_value = [&](std::size_t i) { return as(Type::unsigned_integer, value(operands[i])); };
  const auto mask = [&](Register bits) {  // the lowest `bits` bits
    const Register some = b.emit(Op::u_sub, {b.emit(Op::u_shl, {u(1), bits}), u(1)});
    return select(b, b.emit(Op::u_lt, {bits, u(32)}), some, u(~0u));
  };
  const auto guarded = [&](Register bits, Register x, Register y) {  // shifts by 32 are avoided: no bits gives y
    return select(b, b.emit(Op::u_eq, {bits, u(0)}), y, x);
  };
  Scalars out;
  switch (instruction.opcode) {
    case spv::OpShiftLeftLogical:
      out = each(b, Op::u_shl, unsigned_value(0), unsigned_value(1));
      break;
    case spv::OpShiftRightLogical:
      out = each(b, Op::u_shr, unsigned_value(0), unsigned_value(1));
      break;
    case spv::OpShiftRightArithmetic:
      out = each(b, Op::i_shr, as(Type::integer, value(operands[0])), unsigned_value(1));
      break;
    case spv::OpBitwiseAnd:
      out = each(b, Op::u_and, unsigned_value(0), unsigned_value(1));
      break;
    case spv::OpBitwiseOr:
      out = each(b, Op::u_or, unsigned_value(0), unsigned_value(1));
      break;
    case spv::OpBitwiseXor:
      out = each(b, Op::u_xor, unsigned_value(0), unsigned_value(1));
      break;
    case spv::OpNot:
      out = each(b, Op::u_not, unsigned_value(0));
      break;
    case spv::OpBitReverse:
      out = each(b, Op::u_reverse, unsigned_value(0));
      break;
    case spv::OpBitCount:
      out = each(b, Op::u_bit_count, unsigned_value(0));
      break;
    case spv::OpBitFieldUExtract:
    case spv::OpBitFieldSExtract: {
      const Register offset = unsigned_value(1)[0], bits = unsigned_value(2)[0];
      const Register rest = b.emit(Op::u_sub, {u(32), bits});
      for (const Register x : unsigned_value(0)) {
        const Register top = b.emit(Op::u_shl, {x, b.emit(Op::u_sub, {rest, offset})});
        const Register field = instruction.opcode == spv::OpBitFieldUExtract
                                   ? b.emit(Op::u_shr, {top, rest})
                                   : b.emit(Op::u_from_i, {b.emit(Op::i_shr, {b.emit(Op::i_from_u, {top}), rest})});
        out.push_back(guarded(bits, field, u(0)));
      }
      break;
    }
    case spv::OpBitFieldInsert: {
      const Scalars base = unsigned_value(0), insert = unsigned_value(1);
      const Register offset = unsigned_value(2)[0], bits = unsigned_value(3)[0];
      const Register field = b.emit(Op::u_shl, {mask(bits), offset});
      for (std::size_t i = 0; i < base.size(); ++i) {
        const Register kept = b.emit(Op::u_and, {base[i], b.emit(Op::u_not, {field})});
        const Register put = b.emit(Op::u_and, {b.emit(Op::u_shl, {insert[i], offset}), field});
        out.push_back(guarded(bits, b.emit(Op::u_or, {kept, put}), base[i]));
      }
      break;
    }
    case spv::OpIAddCarry:
    case spv::OpISubBorrow: {
      const bool adds = instruction.opcode == spv::OpIAddCarry;
      const Scalars x = unsigned_value(0), y = unsigned_value(1);
      out = each(b, adds ? Op::u_add : Op::u_sub, x, y);
      for (std::size_t i = 0; i < x.size(); ++i) {
        const Register over = adds ? b.emit(Op::u_lt, {out[i], x[i]}) : b.emit(Op::u_lt, {x[i], y[i]});
        out.push_back(select(b, over, u(1), u(0)));
      }
      break;
    }
    case spv::OpUMulExtended: {
      const Scalars x = unsigned_value(0), y = unsigned_value(1), high = each(b, Op::u_mul_high, x, y);
      out = each(b, Op::u_mul, x, y);
      out.insert(out.end(), high.begin(), high.end());
      break;
    }
    case spv::OpSMulExtended: {
      const Scalars x = as(Type::integer, value(operands[0])), y = as(Type::integer, value(operands[1]));
      const Scalars high = each(b, Op::i_mul_high, x, y);
      out = each(b, Op::i_mul, x, y);
      out.insert(out.end(), high.begin(), high.end());
      break;
    }
    default:
      return false;
  }
  std::vector<Type> wanted;  // all the same, also in the structures of the extended forms
  add_scalar_types(instruction.type, wanted);
  values_[instruction.result] = as(wanted[0], std::move(out));
  return true;
}

// ---- one operation a component ----

namespace {

enum class Shape : std::uint8_t { plain, swapped, negated, swapped_negated };

/// How an instruction of SPIR-V becomes one operation; for integers the operand type is the operation's.
struct Scalarwise {
  std::uint16_t opcode;
  Op op;
  Shape shape = Shape::plain;
};

constexpr Scalarwise scalarwise[] = {
    {spv::OpFNegate, Op::f_neg},
    {spv::OpFAdd, Op::f_add},
    {spv::OpFSub, Op::f_sub},
    {spv::OpFMul, Op::f_mul},
    {spv::OpFDiv, Op::f_div},
    {spv::OpFRem, Op::f_rem},
    {spv::OpFMod, Op::f_mod},
    {spv::OpUDiv, Op::u_div},
    {spv::OpSDiv, Op::i_div},
    {spv::OpUMod, Op::u_mod},
    {spv::OpSRem, Op::i_rem},
    {spv::OpSMod, Op::i_mod},
    {spv::OpConvertFToS, Op::i_from_f},
    {spv::OpConvertFToU, Op::u_from_f},
    {spv::OpConvertSToF, Op::f_from_i},
    {spv::OpConvertUToF, Op::f_from_u},
    {spv::OpIsNan, Op::f_isnan},
    {spv::OpIsInf, Op::f_isinf},
    {spv::OpFOrdEqual, Op::f_eq},
    {spv::OpFUnordNotEqual, Op::f_ne},
    {spv::OpFUnordEqual, Op::f_eq},  // of a NaN, true in SPIR-V: no GLSL operator makes it
    {spv::OpFOrdNotEqual, Op::f_ne},
    {spv::OpFOrdLessThan, Op::f_lt},
    {spv::OpFOrdGreaterThan, Op::f_lt, Shape::swapped},
    {spv::OpFOrdLessThanEqual, Op::f_le},
    {spv::OpFOrdGreaterThanEqual, Op::f_le, Shape::swapped},
    {spv::OpFUnordLessThan, Op::f_le, Shape::swapped_negated},
    {spv::OpFUnordGreaterThan, Op::f_le, Shape::negated},
    {spv::OpFUnordLessThanEqual, Op::f_lt, Shape::swapped_negated},
    {spv::OpFUnordGreaterThanEqual, Op::f_lt, Shape::negated},
    {spv::OpULessThan, Op::u_lt},
    {spv::OpUGreaterThan, Op::u_lt, Shape::swapped},
    {spv::OpULessThanEqual, Op::u_le},
    {spv::OpUGreaterThanEqual, Op::u_le, Shape::swapped},
    {spv::OpSLessThan, Op::i_lt},
    {spv::OpSGreaterThan, Op::i_lt, Shape::swapped},
    {spv::OpSLessThanEqual, Op::i_le},
    {spv::OpSGreaterThanEqual, Op::i_le, Shape::swapped},
    {spv::OpLogicalEqual, Op::b_xor, Shape::negated},
    {spv::OpLogicalNotEqual, Op::b_xor},
    {spv::OpLogicalOr, Op::b_or},
    {spv::OpLogicalAnd, Op::b_and},
    {spv::OpLogicalNot, Op::b_not},
};

/// Instructions whose operation depends on whether the integers are signed.
std::optional<Op> integer_op(std::uint16_t opcode, Type type) {
  const bool is_signed = type == Type::integer;
  switch (opcode) {
    case spv::OpSNegate:
      return Op::i_neg;
    case spv::OpIAdd:
      return is_signed ? Op::i_add : Op::u_add;
    case spv::OpISub:
      return is_signed ? Op::i_sub : Op::u_sub;
    case spv::OpIMul:
      return is_signed ? Op::i_mul : Op::u_mul;
    case spv::OpIEqual:
      return is_signed ? Op::i_eq : Op::u_eq;
    case spv::OpINotEqual:
      return is_signed ? Op::i_ne : Op::u_ne;
    default:
      return std::nullopt;
  }
}

}  // namespace

bool SpirvValues::execute_scalarwise(const SpirvInstruction& instruction) {
  const auto& operands = instruction.operands;
  Scalarwise rule{instruction.opcode, Op::f_copy};
  if (integer_op(instruction.opcode, Type::integer)) {
    rule.op = *integer_op(instruction.opcode, builder_.type(scalar(operands[0])));
  } else {
    const auto known = std::find_if(std::begin(scalarwise), std::end(scalarwise),
                                    [&](const Scalarwise& s) { return s.opcode == instruction.opcode; });
    if (known == std::end(scalarwise)) return false;
    rule = *known;
  }
  const std::string_view letters = info(rule.op).operands;
  Scalars x = as(type_of_letter(letters[0]), value(operands[0])), out;
  if (letters.size() == 1) {
    out = each(builder_, rule.op, x);
  } else {
    Scalars y = as(type_of_letter(letters[1]), value(operands[1]));
    if (rule.shape == Shape::swapped || rule.shape == Shape::swapped_negated) std::swap(x, y);
    out = each(builder_, rule.op, x, y);
  }
  if (rule.shape == Shape::negated || rule.shape == Shape::swapped_negated) out = each(builder_, Op::b_not, out);
  std::vector<Type> wanted;
  add_scalar_types(instruction.type, wanted);
  values_[instruction.result] = as(wanted[0], std::move(out));
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
