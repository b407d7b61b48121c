// The arithmetic of SPIR-V's core is done scalar by scalar: vectors and matrices, bits, one operation a component.
#include <glslang/SPIRV/spirv.hpp>
#include <utility>

#include "compiler/snippet/spirv_operations.h"
#include "compiler/snippet/spirv_values.h"

namespace dmvv::compiler::snippet {

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

bool SpirvValues::execute_scalarwise(const SpirvInstruction& instruction) {
  const auto& operands = instruction.operands;
  using Shape = Scalarwise::Shape;
  Scalarwise rule{instruction.opcode, Op::f_copy};
  if (integer_op(instruction.opcode, Type::integer)) {
    rule.op = *integer_op(instruction.opcode, builder_.type(scalar(operands[0])));
  } else {
    const Scalarwise* const known = scalarwise_rule(instruction.opcode);
    if (known == nullptr) return false;
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

}  // namespace dmvv::compiler::snippet
