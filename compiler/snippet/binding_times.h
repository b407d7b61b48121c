// Binding times tell of every register and array what its value depends on: nothing, time alone, or space.
#pragma once

#include <cstdint>
#include <vector>

#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

enum class Level : std::uint8_t { constant, time, space };

/// The level of every register and array: the least fixed point of
///   a temporary    the highest of its operands
///   a variable, an array    the highest of what is assigned to it, anywhere, and of what decides whether it is.
/// In:   the program must outlive it. `only_t`: what is computed from t counts as space, t alone as time.
/// Cost: linear in the program times the depth of its control flow, for each of at most 32 rounds; where they do not
///       suffice, all variables and arrays count as space.
class Levels {
 public:
  Levels(const Program& program, bool only_t);

  Level of(Register r) const { return registers_[r]; }

  /// Of what an instruction assigns.
  Level of(const Instruction& instruction) const;

  /// The level of what decides whether and how often the inside of a node runs.
  Level control(const Node& node, Level outside) const;

 private:
  Level exits(const Sequence& sequence, Level decided) const;
  void visit(const Sequence& sequence, Level decided);
  void assign(const Instruction& instruction, Level decided);
  void raise(Level& level, Level to);
  void give_up();

  const Program& program_;
  bool only_t_;
  std::vector<Level> registers_, arrays_;
  bool changed_ = true;
};

}  // namespace dmvv::compiler::snippet
