// Straight lines as instructions over few registers, and the GLSL that carries one instruction out.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compiler/snippet/straight_line.h"

namespace dmvv::compiler::snippet {

/// A straight line as shaders/tape.glsl walks it. An instruction is two words:
///   x: code, destination, operands a and b, a byte each, lowest first
///   y: a constant, which register DMVV_TAPE_CONSTANT then holds, or the register of operand c, or the slot of a time
///   value
/// The last instruction's value is the result.
struct Tape {
  std::vector<glm::uvec2> instructions;
  std::uint32_t registers = 0;  ///< numbers in use, those of the point and the constant among them
};

/// Why a line has no tape: an operation that GLSL does not write as one expression, or more than 256 values that wait
/// at a time. Empty if it has one, and so has whatever it is shortened to.
std::string cannot_be_tape(const StraightLine& line, std::span<const Hoisted> hoisted);

/// The numbers that instructions have: of the operations that some tapes use, and of reading constants and time values.
class TapeCodes {
 public:
  /// Adds what a line uses, and a copy.
  void add(const StraightLine& line);

  /// Encodes a line of operations that are known. Registers are given by the first that is free.
  /// Errors: empty if more than 256 registers would be needed.
  std::optional<Tape> encode(const StraightLine& line, std::span<const Hoisted> hoisted) const;

  /// Does some operation have three operands?
  bool has_third_operand() const;

  /// The functions of our own that operations call, and
  /// `uint tape_operation(uint code, uint a, uint b, uint c, uint constant, uint first_time_value)`: the bits of the
  /// value. All operations are computed and one is chosen: straight-line code that lavapipe cannot skip anyway.
  std::string glsl() const;

 private:
  std::uint32_t code(const Step& step) const;

  std::vector<Op> operations_;         ///< ascending
  std::array<bool, 4> time_values_{};  ///< by Type
};

}  // namespace dmvv::compiler::snippet
