// What a snippet is once it is understood: scalar instructions over typed registers, in structured control flow.
// Plain data; read_spirv makes it, the evaluators and the GLSL emitter read it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dmvv::compiler::snippet {

enum class Type : std::uint8_t { real, integer, unsigned_integer, boolean };  ///< float32, int32, uint32, bool

enum class Op : std::uint8_t {
#define DMVV_OP(name, result, operands) name,
#include "compiler/snippet/ops.def"
#undef DMVV_OP
};

inline constexpr std::size_t op_count = 0
#define DMVV_OP(name, result, operands) +1
#include "compiler/snippet/ops.def"
#undef DMVV_OP
    ;

/// What the table says of an operation.
struct OpInfo {
  std::string_view name;      ///< "f_add"
  char result;                ///< f i u b, or '-'
  std::string_view operands;  ///< a letter each: f i u b, or a for the number of an array
};
const OpInfo& info(Op op);

/// The type that a letter of the table stands for: f, i, u or b.
Type type_of_letter(char letter);

/// A register, or the number of an array where the operation says so.
using Register = std::uint32_t;

/// `result = op(operands)`; operands have exactly the types the table gives. Stores have no result.
struct Instruction {
  Op op;
  Register result = 0;
  std::array<Register, 3> operands{};
  friend bool operator==(const Instruction&, const Instruction&) = default;
};

struct Node;
using Sequence = std::vector<Node>;

/// Structured control flow, as GLSL has it.
struct Node {
  enum class Kind : std::uint8_t {
    run,     ///< instructions [first, first + count)
    branch,  ///< if (condition) body else other
    loop,    ///< for (;;) { body; other }: `other` runs after body and at each repeat; empty without repeats
    block,   ///< body once; a break inside leaves it: switch (0) { default: body }
    leave,   ///< break: out of the innermost loop or block
    repeat,  ///< continue: of the innermost loop, through any blocks in between; never inside a loop's `other`
  };
  Kind kind = Kind::run;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
  Register condition = 0;
  Sequence body;
  Sequence other;
  friend bool operator==(const Node&, const Node&) = default;
};

/// A float constant is the float32 the author's literal became.
struct Constant {
  Type type;
  std::uint32_t bits;  ///< of the float32, int32 or uint32; 0 or 1 for bool
  friend bool operator==(const Constant&, const Constant&) = default;
};

/// A local array that is indexed by computed values. Zero at the start.
struct Array {
  Type type;
  std::uint32_t size;
  friend bool operator==(const Array&, const Array&) = default;
};

/// The function `float f(vec3 p, float t)` as a program.
///
/// Registers are numbered in four groups, in this order:
///   inputs     p.x, p.y, p.z, t: never assigned;
///   constants  never assigned;
///   variables  assigned any number of times, anywhere; zero at the start. They are what was a phi, a value used
///   outside
///              the sequence that computes it, or a variable: declare them first. A join of branches or of rounds of a
///              loop need only look at variables and arrays;
///   temporaries  assigned by exactly one instruction, and used only after it, in its sequence or in sequences inside
///              that: declare them where they are assigned.
/// The result may be any register of type real.
///
/// Vectors, matrices, structs, arrays with known indices and functions are dissolved into scalars. Equal computations
/// in one scope are done once; what does not reach the result is gone.
struct Program {
  static constexpr Register p_x = 0, p_y = 1, p_z = 2, t = 3, input_count = 4;

  std::vector<Constant> constants;
  std::vector<Type> variables;
  std::vector<Type> temporaries;
  std::vector<Array> arrays;
  std::vector<Instruction> instructions;
  Sequence body;
  Register result = 0;

  Register first_constant() const { return input_count; }
  Register first_variable() const { return first_constant() + static_cast<Register>(constants.size()); }
  Register first_temporary() const { return first_variable() + static_cast<Register>(variables.size()); }
  Register register_count() const { return first_temporary() + static_cast<Register>(temporaries.size()); }

  bool is_constant(Register r) const { return r >= first_constant() && r < first_variable(); }
  bool is_variable(Register r) const { return r >= first_variable() && r < first_temporary(); }
  bool is_temporary(Register r) const { return r >= first_temporary(); }
  const Constant& constant(Register r) const { return constants[r - first_constant()]; }
  Type type(Register r) const;

  friend bool operator==(const Program&, const Program&) = default;
};

/// Conditions that stand inside each other once a driver has made branches of early exits: what follows a branch that
/// may leave its block or loop counts as inside its other side.
std::uint32_t nesting(const Sequence& sequence);

/// Does something in the body of a loop repeat that loop? Loops within have repeats of their own.
bool repeats(const Sequence& body);

/// The program as text, stable: for tests and for reading.
///   v0:f = f_copy c1(0.5)
std::string to_text(const Program& program);

}  // namespace dmvv::compiler::snippet
