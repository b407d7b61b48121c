// What a SPIR-V module's straight-line instructions mean, scalar by scalar: appended to a ProgramBuilder.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compiler/snippet/glsl_functions.h"
#include "compiler/snippet/program_builder.h"
#include "compiler/snippet/spirv_module.h"

namespace dmvv::compiler::snippet {

class SpirvValues {
 public:
  SpirvValues(const SpirvModule& module, ProgramBuilder& builder);

  /// Appends what an instruction does. After a failure error() says why, and values are meaningless.
  void execute(const SpirvInstruction& instruction);
  Scalars value(SpirvId id);
  Register scalar(SpirvId id) { return value(id).front(); }
  /// The registers that hold a phi.
  const Scalars& phi(const SpirvInstruction& instruction);
  Register output() const { return output_; }

  const std::string& error() const { return error_; }
  void refuse(std::string reason);

 private:
  /// One scalar of a variable: a register, or an array where its path leads through arrays.
  struct Leaf {
    Type type;
    std::uint32_t size;  ///< product of the array lengths on its path
    Register place;      ///< register if size is 1, else number of the array
    bool is_array;
  };
  struct Variable {
    std::vector<Leaf> leaves;
    bool read_only = false;
  };
  struct Choice {  ///< a computed index into a vector or matrix
    Register index;
    std::uint32_t count;
    std::uint32_t stride;  ///< leaves
  };
  /// A pointer: leaf, and index into its array: dynamic + offset.
  struct Place {
    SpirvId variable;
    SpirvId type;
    std::uint32_t leaf = 0;
    std::optional<Register> dynamic;
    std::uint32_t offset = 0;
    std::vector<Choice> choices;
  };

  const SpirvType& type_of(SpirvId type) const;
  Scalars zeros(SpirvId type);
  void add_scalar_types(SpirvId type, std::vector<Type>& out) const;
  Scalars constant_value(const SpirvInstruction& definition);
  const SpirvType& value_type(SpirvId value) const;
  Scalars as(Type type, Scalars values);

  // Memory: spirv_memory.cpp.
  void declare(const SpirvInstruction& variable);
  void declare_leaves(SpirvId type, std::uint32_t copies, Variable& variable);
  const Place& place(SpirvId pointer);
  void step(Place& place, SpirvId index);
  Place part(const Place& whole, std::uint32_t i);
  Register index_register(const Place& place);
  Scalars load(Place place);
  void load_scalars(Place place, Scalars& out);
  void store(Place place, const Scalars& values);
  void store_scalars(Place place, const Scalars& values, std::size_t& next);

  bool execute_memory(const SpirvInstruction& instruction);

  bool execute_composite(const SpirvInstruction& instruction);
  void execute_glsl(const SpirvInstruction& instruction);
  std::uint32_t member_offset(SpirvId& type, std::span<const std::uint32_t> path) const;

  // Arithmetic: spirv_arithmetic.cpp.
  bool execute_matrix(const SpirvInstruction& instruction);
  bool execute_bits(const SpirvInstruction& instruction);
  bool execute_scalarwise(const SpirvInstruction& instruction);

  const SpirvModule& module_;
  ProgramBuilder& builder_;
  std::map<SpirvId, Scalars> values_;
  std::map<SpirvId, SpirvId> value_types_;
  std::map<SpirvId, Variable> variables_;
  std::map<SpirvId, Place> places_;
  std::uint64_t array_scalars_ = 0;
  Register output_ = 0;
  bool has_output_ = false;
  std::string error_;
};

}  // namespace dmvv::compiler::snippet
