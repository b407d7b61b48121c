// Each operation has a form, a pattern of GLSL with places for its operands.
#include "compiler/snippet/glsl_forms.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "compiler/snippet/glsl_literal.h"

namespace dmvv::compiler::snippet {

using namespace ranks;

Form form_of(Op op) {
  switch (op) {
    case Op::f_copy:
    case Op::i_copy:
    case Op::u_copy:
    case Op::b_copy:
      return {"$0", primary};
    case Op::f_select:
    case Op::i_select:
    case Op::u_select:
    case Op::b_select:
      return {"mix($2, $1, $0)", primary};  // unlike ?: never a branch
    case Op::f_load:
    case Op::i_load:
    case Op::u_load:
    case Op::b_load:
    case Op::f_store:
    case Op::i_store:
    case Op::u_store:
    case Op::b_store:
      return {"", primary};  // written by Emitter::element

    case Op::f_add:
    case Op::i_add:
    case Op::u_add:
      return {"$0 + $1", sum};
    case Op::f_sub:
    case Op::i_sub:
    case Op::u_sub:
      return {"$0 - $1", sum};
    case Op::f_mul:
    case Op::i_mul:
    case Op::u_mul:
      return {"$0 * $1", product};
    case Op::f_div:
    case Op::i_div:
    case Op::u_div:
      return {"$0 / $1", product};
    case Op::f_neg:
    case Op::i_neg:
      return {"-$0", unary};
    case Op::f_fma:
      return {"fma($0, $1, $2)", primary};
    case Op::f_mod:
      return {"mod($0, $1)", primary};
    case Op::f_rem:
      return {"$0 - $1 * trunc($0 / $1)", sum};
    case Op::f_min:
    case Op::i_min:
    case Op::u_min:
      return {"min($0, $1)", primary};
    case Op::f_max:
    case Op::i_max:
    case Op::u_max:
      return {"max($0, $1)", primary};
    case Op::f_abs:
    case Op::i_abs:
      return {"abs($0)", primary};
    case Op::f_sign:
    case Op::i_sign:
      return {"sign($0)", primary};
    case Op::f_floor:
      return {"floor($0)", primary};
    case Op::f_ceil:
      return {"ceil($0)", primary};
    case Op::f_trunc:
      return {"trunc($0)", primary};
    case Op::f_round:
      return {"roundEven($0)", primary};
    case Op::f_fract:
      return {"fract($0)", primary};
    case Op::f_sqrt:
      return {"sqrt($0)", primary};
    case Op::f_inversesqrt:
      return {"inversesqrt($0)", primary};
    case Op::f_exp:
      return {"exp($0)", primary};
    case Op::f_exp2:
      return {"exp2($0)", primary};
    case Op::f_log:
      return {"log($0)", primary};
    case Op::f_log2:
      return {"log2($0)", primary};
    case Op::f_pow:
      return {"pow($0, $1)", primary};
    case Op::f_sin:
      return {"sin($0)", primary};
    case Op::f_cos:
      return {"cos($0)", primary};
    case Op::f_tan:
      return {"tan($0)", primary};
    case Op::f_asin:
      return {"@asin($0)", primary};
    case Op::f_acos:
      return {"@acos($0)", primary};
    case Op::f_atan:
      return {"@atan($0)", primary};
    case Op::f_atan2:
      return {"@atan2($0, $1)", primary};
    case Op::f_sinh:
      return {"sinh($0)", primary};
    case Op::f_cosh:
      return {"cosh($0)", primary};
    case Op::f_tanh:
      return {"@tanh($0)", primary};
    case Op::f_asinh:
      return {"@asinh($0)", primary};
    case Op::f_acosh:
      return {"@acosh($0)", primary};
    case Op::f_atanh:
      return {"atanh($0)", primary};
    case Op::f_mix:
      return {"mix($0, $1, $2)", primary};
    case Op::f_smoothstep:
      return {"smoothstep($0, $1, $2)", primary};
    case Op::f_ldexp:
      return {"ldexp($0, $1)", primary};
    case Op::f_frexp_mantissa:
      return {"frexp($0, $x)", primary};
    case Op::i_frexp_exponent:
      return {"frexp($0, $r)", primary};

    case Op::f_eq:
    case Op::i_eq:
    case Op::u_eq:
      return {"$0 == $1", equality};
    case Op::f_ne:
    case Op::i_ne:
    case Op::u_ne:
      return {"$0 != $1", equality};
    case Op::f_lt:
    case Op::i_lt:
    case Op::u_lt:
      return {"$0 < $1", relation};
    case Op::f_le:
    case Op::i_le:
    case Op::u_le:
      return {"$0 <= $1", relation};
    case Op::f_isnan:
      return {"isnan($0)", primary};
    case Op::f_isinf:
      return {"isinf($0)", primary};

    case Op::f_from_i:
    case Op::f_from_u:
      return {"float($0)", primary};
    case Op::i_from_f:
    case Op::i_from_u:
      return {"int($0)", primary};
    case Op::u_from_f:
    case Op::u_from_i:
      return {"uint($0)", primary};
    case Op::f_from_bits:
      return {"uintBitsToFloat($0)", primary};
    case Op::u_from_float_bits:
      return {"floatBitsToUint($0)", primary};
    case Op::u_pack_half:
      return {"packHalf2x16(vec2($0, 0.0))", primary};
    case Op::f_unpack_half:
      return {"unpackHalf2x16($0).x", primary};

    case Op::i_rem:
      return {"$0 - $0 / $1 * $1", sum};  // % of negative operands is open in GLSL
    case Op::i_mod:                       // likewise; the quotient rounded down
      return {"$0 - ($0 / $1 - int(($0 ^ $1) < 0 && $0 / $1 * $1 != $0)) * $1", sum};
    case Op::u_mod:
      return {"$0 % $1", product};
    case Op::i_shr:
    case Op::u_shr:
      return {"$0 >> $1", shift};
    case Op::u_shl:
      return {"$0 << $1", shift};
    case Op::i_mul_high:
      return {"imulExtended($0, $1, $r, $x)", primary};
    case Op::u_mul_high:
      return {"umulExtended($0, $1, $r, $x)", primary};
    case Op::u_and:
      return {"$0 & $1", bit_and};
    case Op::u_or:
      return {"$0 | $1", bit_or};
    case Op::u_xor:
      return {"$0 ^ $1", bit_xor};
    case Op::u_not:
      return {"~$0", unary};
    case Op::u_bit_count:
      return {"bitCount($0)", primary};
    case Op::u_reverse:
      return {"bitfieldReverse($0)", primary};
    case Op::u_find_lsb:
      return {"findLSB($0)", primary};
    case Op::u_find_msb:
    case Op::i_find_msb:
      return {"findMSB($0)", primary};

    case Op::b_and:
      return {"$0 && $1", logic_and};
    case Op::b_or:
      return {"$0 || $1", loosest};
    case Op::b_xor:
      return {"$0 ^^ $1", logic_xor};
    case Op::b_not:
      return {"!$0", unary};
  }
  return {"", primary};
}

std::string literal(const Constant& constant) {
  switch (constant.type) {
    case Type::real: {
      const auto value = std::bit_cast<float>(constant.bits);
      return std::isfinite(value) ? glsl_float(value) : fmt::format("uintBitsToFloat({}u)", constant.bits);
    }
    case Type::integer:
      if (constant.bits == 0x80000000u) return "int(2147483648u)";  // a literal has no sign
      return fmt::format("{}", static_cast<std::int32_t>(constant.bits));
    case Type::unsigned_integer:
      return fmt::format("{}u", constant.bits);
    case Type::boolean:
      return constant.bits != 0 ? "true" : "false";
  }
  return "";
}

std::string filled(std::string_view pattern, const std::array<std::string, 3>& operands,
                   std::string_view function_prefix, std::string_view result) {
  std::string text;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (pattern[i] == '@') {
      text += function_prefix;
      continue;
    }
    if (pattern[i] != '$') {
      text += pattern[i];
      continue;
    }
    const char which = pattern[++i];
    if (which == 'r' || which == 'x') {
      text += result;
      if (which == 'x') text += "_x";
    } else {
      text += operands[static_cast<std::size_t>(which - '0')];
    }
  }
  return text;
}

std::string operation_text(Op op, const std::array<std::string, 3>& operands, std::string_view function_prefix) {
  const std::string_view pattern = form_of(op).pattern;
  const bool takes_statements =
      pattern.empty() || pattern.find("$r") != std::string_view::npos || pattern.find("$x") != std::string_view::npos;
  return takes_statements ? std::string() : filled(pattern, operands, function_prefix, "");
}

std::string time_value_text(Type type, std::string_view slot, std::string_view next_slot) {
  switch (type) {
    case Type::real:
      return fmt::format("time_values[{}]", slot);
    case Type::boolean:
      return fmt::format("time_values[{}] != 0.0", slot);
    case Type::integer:
      return fmt::format("int(time_values[{}]) * 65536 + int(time_values[{}])", slot, next_slot);
    case Type::unsigned_integer:
      return fmt::format("uint(time_values[{}]) * 65536u + uint(time_values[{}])", slot, next_slot);
  }
  return "";
}

std::string_view type_name(Type type) {
  switch (type) {
    case Type::real:
      return "float";
    case Type::integer:
      return "int";
    case Type::unsigned_integer:
      return "uint";
    case Type::boolean:
      return "bool";
  }
  return "";
}

}  // namespace dmvv::compiler::snippet
