// The words of a SPIR-V module, looked up by id: types, constants, variables, blocks of the entry point.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "compiler/snippet/program.h"

namespace dmvv::compiler::snippet {

using SpirvId = std::uint32_t;

struct SpirvInstruction {
  std::uint16_t opcode = 0;
  SpirvId type = 0;                         ///< 0 if it has none
  SpirvId result = 0;                       ///< 0 if it has none
  std::span<const std::uint32_t> operands;  ///< after type and result
};

struct SpirvType {
  enum class Kind : std::uint8_t { other, scalar, vector, matrix, array, structure, pointer };
  Kind kind = Kind::other;
  Type scalar = Type::real;
  std::vector<SpirvId> members;  ///< of a structure; one for vector (component), matrix (column), array, pointer
  std::uint32_t count = 1;       ///< components, columns, elements, members
  std::uint32_t size = 1;        ///< scalars in all
  std::uint32_t leaves = 1;      ///< scalars when each array counts as one element
};

struct SpirvBlock {
  std::vector<SpirvInstruction> phis;
  std::vector<SpirvInstruction> body;
  SpirvInstruction merge;  ///< OpSelectionMerge, OpLoopMerge, or none
  SpirvInstruction terminator;
};

/// Spans point into the words given to parse(), which must outlive this.
struct SpirvModule {
  std::map<SpirvId, SpirvType> types;
  std::map<SpirvId, SpirvInstruction> definitions;  ///< of constants and of variables outside functions
  std::map<SpirvId, std::uint32_t> locations;
  std::map<SpirvId, SpirvBlock> blocks;  ///< of the entry point, by label
  std::vector<SpirvInstruction> locals;  ///< the entry point's variables
  SpirvId first_block = 0;
  SpirvId glsl_instructions = 0;  ///< the imported set GLSL.std.450
};

/// Errors (input): truncated words, a type that a distance function cannot use (names it).
Result<SpirvModule> parse_spirv(std::span<const std::uint32_t> words);

/// Refuses recursion, and functions that grow beyond `limit` instructions when their calls are inlined.
/// Errors (input): names the function.
Result<void> check_calls(std::span<const std::uint32_t> words, std::uint64_t limit);

/// "OpDPdx", for messages.
std::string opcode_name(std::uint16_t opcode);

}  // namespace dmvv::compiler::snippet
