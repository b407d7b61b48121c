// The table has a row for each opcode whose operation does not depend on the type of its operands.
#include "compiler/snippet/spirv_operations.h"

#include <algorithm>
#include <glslang/SPIRV/spirv.hpp>
#include <iterator>

namespace dmvv::compiler::snippet {

namespace {

using Shape = Scalarwise::Shape;

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

}  // namespace

const Scalarwise* scalarwise_rule(std::uint16_t opcode) {
  const auto known = std::find_if(std::begin(scalarwise), std::end(scalarwise),
                                  [&](const Scalarwise& s) { return s.opcode == opcode; });
  return known == std::end(scalarwise) ? nullptr : known;
}

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

}  // namespace dmvv::compiler::snippet
