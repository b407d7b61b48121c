// Builds a Program instruction by instruction; numbers its registers and drops what is dead at the end.
#pragma once

#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

class ProgramBuilder {
 public:
  ProgramBuilder();

  /// Registers are provisional until finish().
  Register constant(Type type, std::uint32_t bits);
  Register real(float value);
  Register integer(std::int32_t value);
  Register variable(Type type);
  Register array(Type type, std::uint32_t size);  ///< the number of a new array
  Type type(Register r) const { return registers_[r].type; }
  bool is_constant(Register r) const { return registers_[r].kind == Kind::constant; }
  std::uint32_t constant_bits(Register r) const { return registers_[r].bits; }

  /// Appends an operation; the result is a temporary. The same operation on the same registers in an enclosing scope is
  /// not repeated (copies and loads are).
  Register emit(Op op, std::initializer_list<Register> operands);
  void store(Op op, Register array, Register index, Register value);
  void assign(Register variable, Register value);
  Register copy(Register value);  ///< a new temporary that keeps the value now

  /// Sequences are built from the inside: begin, emit, end; the result goes into a node that is appended.
  void begin();
  Sequence end();
  void append(Node node);
  void append(Sequence sequence);

  std::size_t instruction_count() const { return instructions_.size(); }

  Program finish(Register result);

 private:
  enum class Kind : std::uint8_t { input, constant, variable, temporary };
  struct RegisterInfo {
    Type type;
    Kind kind;
    std::uint32_t bits = 0;  ///< of a constant
  };
  using Key = std::tuple<Op, std::array<Register, 3>>;
  struct Scope {
    Sequence sequence;
    std::vector<Key> known;
  };

  Register add(Type type, Kind kind, std::uint32_t bits = 0);
  void push(const Instruction& instruction);
  void promote(const Sequence& sequence, std::vector<bool>& visible);
  void remove_dead(Sequence& body, Register result);
  Program number(const Sequence& body, Register result);

  std::vector<RegisterInfo> registers_;
  std::map<std::pair<Type, std::uint32_t>, Register> constants_;
  std::vector<Array> arrays_;
  std::vector<Instruction> instructions_;
  std::vector<Scope> scopes_;
  std::map<Key, Register> known_;
};

}  // namespace dmvv::compiler::snippet
