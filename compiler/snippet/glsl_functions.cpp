#include "compiler/snippet/glsl_functions.h"

#include <glslang/SPIRV/GLSL.std.450.h>

#include <numbers>

namespace dmvv::compiler::snippet {

Scalars slice(const Scalars& all, std::size_t first, std::size_t count) {
  return {all.begin() + static_cast<std::ptrdiff_t>(first), all.begin() + static_cast<std::ptrdiff_t>(first + count)};
}

Scalars each(ProgramBuilder& b, Op op, const Scalars& x) {
  Scalars out;
  for (const Register r : x) out.push_back(b.emit(op, {r}));
  return out;
}

Scalars each(ProgramBuilder& b, Op op, const Scalars& x, const Scalars& y) {
  Scalars out;
  for (std::size_t i = 0; i < x.size(); ++i) out.push_back(b.emit(op, {x[i], y[i]}));
  return out;
}

Scalars each(ProgramBuilder& b, Op op, const Scalars& x, const Scalars& y, const Scalars& z) {
  Scalars out;
  for (std::size_t i = 0; i < x.size(); ++i) out.push_back(b.emit(op, {x[i], y[i], z[i]}));
  return out;
}

Scalars scaled(ProgramBuilder& b, const Scalars& x, Register factor) {
  return each(b, Op::f_mul, x, Scalars(x.size(), factor));
}

Register dot(ProgramBuilder& b, const Scalars& x, const Scalars& y) {
  Register sum = b.emit(Op::f_mul, {x[0], y[0]});
  for (std::size_t i = 1; i < x.size(); ++i) sum = b.emit(Op::f_add, {sum, b.emit(Op::f_mul, {x[i], y[i]})});
  return sum;
}

Register select(ProgramBuilder& b, Register condition, Register x, Register y) {
  constexpr Op ops[] = {Op::f_select, Op::i_select, Op::u_select, Op::b_select};
  return x == y ? x : b.emit(ops[static_cast<std::size_t>(b.type(x))], {condition, x, y});
}

Register as_type(ProgramBuilder& b, Type type, Register x) {
  if (b.type(x) == type) return x;
  if (b.is_constant(x) && b.type(x) != Type::real) return b.constant(type, b.constant_bits(x));
  if (type == Type::real) return b.emit(Op::f_from_bits, {as_type(b, Type::unsigned_integer, x)});
  if (b.type(x) == Type::real) return as_type(b, type, b.emit(Op::u_from_float_bits, {x}));
  return b.emit(type == Type::integer ? Op::i_from_u : Op::u_from_i, {x});
}

namespace {

/// Matrices are n x n, column by column.
struct Minor {
  Scalars values;
  std::size_t n;
};

Minor minor_of(const Minor& m, std::size_t skipped_column, std::size_t skipped_row) {
  Minor out{{}, m.n - 1};
  for (std::size_t column = 0; column < m.n; ++column) {
    for (std::size_t row = 0; row < m.n; ++row) {
      if (column != skipped_column && row != skipped_row) out.values.push_back(m.values[column * m.n + row]);
    }
  }
  return out;
}

/// Laplace's expansion by the first column; equal minors are computed once by the builder.
Register determinant(ProgramBuilder& b, const Minor& m) {
  if (m.n == 1) return m.values[0];
  Register sum = b.emit(Op::f_mul, {m.values[0], determinant(b, minor_of(m, 0, 0))});
  for (std::size_t row = 1; row < m.n; ++row) {
    const Register term = b.emit(Op::f_mul, {m.values[row], determinant(b, minor_of(m, 0, row))});
    sum = b.emit(row % 2 == 1 ? Op::f_sub : Op::f_add, {sum, term});
  }
  return sum;
}

std::size_t square_root(std::size_t n) { return n == 4 ? 2 : n == 9 ? 3 : 4; }

Scalars inverse(ProgramBuilder& b, const Minor& m) {
  const Register factor = b.emit(Op::f_div, {b.real(1.0f), determinant(b, m)});
  Scalars out;
  for (std::size_t column = 0; column < m.n; ++column) {
    for (std::size_t row = 0; row < m.n; ++row) {  // the adjugate is the transpose of the cofactors
      Register cofactor = determinant(b, minor_of(m, row, column));
      if ((row + column) % 2 == 1) cofactor = b.emit(Op::f_neg, {cofactor});
      out.push_back(b.emit(Op::f_mul, {cofactor, factor}));
    }
  }
  return out;
}

Register length(ProgramBuilder& b, const Scalars& x) {
  return x.size() == 1 ? b.emit(Op::f_abs, {x[0]}) : b.emit(Op::f_sqrt, {dot(b, x, x)});
}

Scalars normalize(ProgramBuilder& b, const Scalars& x) {
  return x.size() == 1 ? each(b, Op::f_sign, x) : scaled(b, x, b.emit(Op::f_inversesqrt, {dot(b, x, x)}));
}

Scalars cross(ProgramBuilder& b, const Scalars& x, const Scalars& y) {
  Scalars out;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    out.push_back(b.emit(Op::f_sub, {b.emit(Op::f_mul, {x[j], y[k]}), b.emit(Op::f_mul, {x[k], y[j]})}));
  }
  return out;
}

Scalars reflect(ProgramBuilder& b, const Scalars& incident, const Scalars& normal) {
  const Register twice = b.emit(Op::f_mul, {b.real(2.0f), dot(b, normal, incident)});
  return each(b, Op::f_sub, incident, scaled(b, normal, twice));
}

Scalars refract(ProgramBuilder& b, const Scalars& incident, const Scalars& normal, Register eta) {
  const Register one = b.real(1.0f), zero = b.real(0.0f);
  const Register d = dot(b, normal, incident);
  const Register sine2 =
      b.emit(Op::f_mul, {b.emit(Op::f_mul, {eta, eta}), b.emit(Op::f_sub, {one, b.emit(Op::f_mul, {d, d})})});
  const Register k = b.emit(Op::f_sub, {one, sine2});
  const Register total = b.emit(Op::f_lt, {k, zero});
  const Register root = b.emit(Op::f_sqrt, {b.emit(Op::f_max, {k, zero})});
  const Register along = b.emit(Op::f_add, {b.emit(Op::f_mul, {eta, d}), root});
  Scalars out = each(b, Op::f_sub, scaled(b, incident, eta), scaled(b, normal, along));
  for (Register& r : out) r = select(b, total, zero, r);
  return out;
}

Scalars face_forward(ProgramBuilder& b, const Scalars& n, const Scalars& incident, const Scalars& reference) {
  const Register keeps = b.emit(Op::f_lt, {dot(b, reference, incident), b.real(0.0f)});
  Scalars out;
  for (const Register r : n) out.push_back(select(b, keeps, r, b.emit(Op::f_neg, {r})));
  return out;
}

Scalars step(ProgramBuilder& b, const Scalars& edge, const Scalars& x) {
  Scalars out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    out.push_back(select(b, b.emit(Op::f_lt, {x[i], edge[i]}), b.real(0.0f), b.real(1.0f)));
  }
  return out;
}

Register pack(ProgramBuilder& b, const Scalars& x, float lo, float scale, std::uint32_t bits) {
  const Register mask = b.constant(Type::unsigned_integer, bits == 32 ? ~0u : (1u << bits) - 1);
  Register packed = b.constant(Type::unsigned_integer, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Register clamped = b.emit(Op::f_min, {b.emit(Op::f_max, {x[i], b.real(lo)}), b.real(1.0f)});
    const Register steps = b.emit(Op::f_round, {b.emit(Op::f_mul, {clamped, b.real(scale)})});
    const Register field = b.emit(Op::u_and, {b.emit(Op::u_from_i, {b.emit(Op::i_from_f, {steps})}), mask});
    const Register shift = b.constant(Type::unsigned_integer, static_cast<std::uint32_t>(i) * bits);
    packed = b.emit(Op::u_or, {packed, b.emit(Op::u_shl, {field, shift})});
  }
  return packed;
}

Scalars unpack(ProgramBuilder& b, Register packed, bool is_signed, float scale, std::uint32_t bits) {
  const auto u = [&](std::uint32_t value) { return b.constant(Type::unsigned_integer, value); };
  Scalars out;
  for (std::uint32_t i = 0; i < 32 / bits; ++i) {
    const Register top = b.emit(Op::u_shl, {packed, u(32 - bits * (i + 1))});  // the field in the highest bits
    const Register steps = is_signed
                               ? b.emit(Op::f_from_i, {b.emit(Op::i_shr, {b.emit(Op::i_from_u, {top}), u(32 - bits)})})
                               : b.emit(Op::f_from_u, {b.emit(Op::u_shr, {top, u(32 - bits)})});
    const Register value = b.emit(Op::f_div, {steps, b.real(scale)});
    out.push_back(is_signed ? b.emit(Op::f_max, {value, b.real(-1.0f)}) : value);
  }
  return out;
}

Register pack_half(ProgramBuilder& b, const Scalars& x) {
  const Register high = b.emit(Op::u_shl, {b.emit(Op::u_pack_half, {x[1]}), b.constant(Type::unsigned_integer, 16)});
  return b.emit(Op::u_or, {b.emit(Op::u_pack_half, {x[0]}), high});
}

Scalars unpack_half(ProgramBuilder& b, Register packed) {
  const Register low = b.emit(Op::u_and, {packed, b.constant(Type::unsigned_integer, 0xffff)});
  const Register high = b.emit(Op::u_shr, {packed, b.constant(Type::unsigned_integer, 16)});
  return {b.emit(Op::f_unpack_half, {low}), b.emit(Op::f_unpack_half, {high})};
}

Scalars modf(ProgramBuilder& b, const Scalars& x) {
  const Scalars whole = each(b, Op::f_trunc, x);
  Scalars out = each(b, Op::f_sub, x, whole);
  out.insert(out.end(), whole.begin(), whole.end());
  return out;
}

Scalars frexp(ProgramBuilder& b, const Scalars& x) {
  Scalars out = each(b, Op::f_frexp_mantissa, x);
  const Scalars exponents = each(b, Op::i_frexp_exponent, x);
  out.insert(out.end(), exponents.begin(), exponents.end());
  return out;
}

Scalars clamp(ProgramBuilder& b, Op min, Op max, std::span<const Scalars> a) {
  return each(b, min, each(b, max, a[0], a[1]), a[2]);
}

Scalars as_ints(ProgramBuilder& b, Type type, Scalars x) {
  for (Register& r : x) r = as_type(b, type, r);
  return x;
}

/// Built-ins that are one operation a component.
std::optional<Op> componentwise(std::uint32_t number) {
  switch (number) {
    case GLSLstd450Round:
    case GLSLstd450RoundEven:
      return Op::f_round;
    case GLSLstd450Trunc:
      return Op::f_trunc;
    case GLSLstd450FAbs:
      return Op::f_abs;
    case GLSLstd450SAbs:
      return Op::i_abs;
    case GLSLstd450FSign:
      return Op::f_sign;
    case GLSLstd450SSign:
      return Op::i_sign;
    case GLSLstd450Floor:
      return Op::f_floor;
    case GLSLstd450Ceil:
      return Op::f_ceil;
    case GLSLstd450Fract:
      return Op::f_fract;
    case GLSLstd450Sin:
      return Op::f_sin;
    case GLSLstd450Cos:
      return Op::f_cos;
    case GLSLstd450Tan:
      return Op::f_tan;
    case GLSLstd450Asin:
      return Op::f_asin;
    case GLSLstd450Acos:
      return Op::f_acos;
    case GLSLstd450Atan:
      return Op::f_atan;
    case GLSLstd450Sinh:
      return Op::f_sinh;
    case GLSLstd450Cosh:
      return Op::f_cosh;
    case GLSLstd450Tanh:
      return Op::f_tanh;
    case GLSLstd450Asinh:
      return Op::f_asinh;
    case GLSLstd450Acosh:
      return Op::f_acosh;
    case GLSLstd450Atanh:
      return Op::f_atanh;
    case GLSLstd450Atan2:
      return Op::f_atan2;
    case GLSLstd450Pow:
      return Op::f_pow;
    case GLSLstd450Exp:
      return Op::f_exp;
    case GLSLstd450Log:
      return Op::f_log;
    case GLSLstd450Exp2:
      return Op::f_exp2;
    case GLSLstd450Log2:
      return Op::f_log2;
    case GLSLstd450Sqrt:
      return Op::f_sqrt;
    case GLSLstd450InverseSqrt:
      return Op::f_inversesqrt;
    case GLSLstd450FMin:
    case GLSLstd450NMin:
      return Op::f_min;
    case GLSLstd450UMin:
      return Op::u_min;
    case GLSLstd450SMin:
      return Op::i_min;
    case GLSLstd450FMax:
    case GLSLstd450NMax:
      return Op::f_max;
    case GLSLstd450UMax:
      return Op::u_max;
    case GLSLstd450SMax:
      return Op::i_max;
    case GLSLstd450FMix:
      return Op::f_mix;
    case GLSLstd450SmoothStep:
      return Op::f_smoothstep;
    case GLSLstd450Fma:
      return Op::f_fma;
    case GLSLstd450Ldexp:
      return Op::f_ldexp;
    case GLSLstd450FindILsb:
      return Op::u_find_lsb;
    case GLSLstd450FindSMsb:
      return Op::i_find_msb;
    case GLSLstd450FindUMsb:
      return Op::u_find_msb;
    default:
      return std::nullopt;
  }
}

Scalars apply(ProgramBuilder& b, Op op, std::span<const Scalars> a) {
  const std::string_view letters = info(op).operands;
  std::vector<Scalars> typed;
  for (std::size_t i = 0; i < letters.size(); ++i) typed.push_back(as_ints(b, type_of_letter(letters[i]), a[i]));
  if (letters.size() == 1) return each(b, op, typed[0]);
  if (letters.size() == 2) return each(b, op, typed[0], typed[1]);
  return each(b, op, typed[0], typed[1], typed[2]);
}

}  // namespace

std::optional<Scalars> glsl_function(ProgramBuilder& b, std::uint32_t number, std::span<const Scalars> a) {
  if (const auto op = componentwise(number)) return apply(b, *op, a);
  constexpr float radian = static_cast<float>(std::numbers::pi / 180.0);
  constexpr float degree = static_cast<float>(180.0 / std::numbers::pi);
  switch (number) {
    case GLSLstd450Radians:
      return scaled(b, a[0], b.real(radian));
    case GLSLstd450Degrees:
      return scaled(b, a[0], b.real(degree));
    case GLSLstd450Determinant:
      return Scalars{determinant(b, {a[0], square_root(a[0].size())})};
    case GLSLstd450MatrixInverse:
      return inverse(b, {a[0], square_root(a[0].size())});
    case GLSLstd450Modf:
    case GLSLstd450ModfStruct:
      return modf(b, a[0]);
    case GLSLstd450Frexp:
    case GLSLstd450FrexpStruct:
      return frexp(b, a[0]);
    case GLSLstd450FClamp:
    case GLSLstd450NClamp:
      return clamp(b, Op::f_min, Op::f_max, a);
    case GLSLstd450UClamp:
      return clamp(b, Op::u_min, Op::u_max, a);
    case GLSLstd450SClamp:
      return clamp(b, Op::i_min, Op::i_max, a);
    case GLSLstd450Step:
      return step(b, a[0], a[1]);
    case GLSLstd450PackSnorm4x8:
      return Scalars{pack(b, a[0], -1.0f, 127.0f, 8)};
    case GLSLstd450PackUnorm4x8:
      return Scalars{pack(b, a[0], 0.0f, 255.0f, 8)};
    case GLSLstd450PackSnorm2x16:
      return Scalars{pack(b, a[0], -1.0f, 32767.0f, 16)};
    case GLSLstd450PackUnorm2x16:
      return Scalars{pack(b, a[0], 0.0f, 65535.0f, 16)};
    case GLSLstd450PackHalf2x16:
      return Scalars{pack_half(b, a[0])};
    case GLSLstd450UnpackSnorm2x16:
      return unpack(b, a[0][0], true, 32767.0f, 16);
    case GLSLstd450UnpackUnorm2x16:
      return unpack(b, a[0][0], false, 65535.0f, 16);
    case GLSLstd450UnpackHalf2x16:
      return unpack_half(b, a[0][0]);
    case GLSLstd450UnpackSnorm4x8:
      return unpack(b, a[0][0], true, 127.0f, 8);
    case GLSLstd450UnpackUnorm4x8:
      return unpack(b, a[0][0], false, 255.0f, 8);
    case GLSLstd450Length:
      return Scalars{length(b, a[0])};
    case GLSLstd450Distance:
      return Scalars{length(b, each(b, Op::f_sub, a[0], a[1]))};
    case GLSLstd450Cross:
      return cross(b, a[0], a[1]);
    case GLSLstd450Normalize:
      return normalize(b, a[0]);
    case GLSLstd450FaceForward:
      return face_forward(b, a[0], a[1], a[2]);
    case GLSLstd450Reflect:
      return reflect(b, a[0], a[1]);
    case GLSLstd450Refract:
      return refract(b, a[0], a[1], a[2][0]);
    default:
      return std::nullopt;
  }
}

}  // namespace dmvv::compiler::snippet
