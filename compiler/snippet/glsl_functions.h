// The built-in functions of GLSL.std.450 in terms of scalar operations.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "compiler/snippet/program_builder.h"

namespace dmvv::compiler::snippet {

/// The scalars of a value: of a vector its components, of a matrix its columns one after another, of an array or
/// structure its members one after another.
using Scalars = std::vector<Register>;

/// `count` scalars from number `first` on, which must be there.
Scalars slice(const Scalars& all, std::size_t first, std::size_t count);

// Shared with the instructions of SPIR-V's core.
Scalars each(ProgramBuilder& b, Op op, const Scalars& x);
Scalars each(ProgramBuilder& b, Op op, const Scalars& x, const Scalars& y);
Scalars each(ProgramBuilder& b, Op op, const Scalars& x, const Scalars& y, const Scalars& z);
Scalars scaled(ProgramBuilder& b, const Scalars& x, Register factor);
Register dot(ProgramBuilder& b, const Scalars& x, const Scalars& y);
/// c ? x : y by the type of x.
Register select(ProgramBuilder& b, Register condition, Register x, Register y);
/// The same bits as another integer type.
Register as_type(ProgramBuilder& b, Type type, Register x);

/// The value of built-in `number` of GLSL.std.450; arguments are the scalars of its operands, matrices column by
/// column. The functions that write through a pointer (Modf, Frexp) give what their ...Struct forms give: both results,
/// one after the other. Empty for what is not known here.
std::optional<Scalars> glsl_function(ProgramBuilder& b, std::uint32_t number, std::span<const Scalars> arguments);

}  // namespace dmvv::compiler::snippet
