// Inside compiler/snippet: variables that are read before they are set; GLSL leaves open what they hold.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dmvv::compiler::snippet {

/// A variable, or an `out` parameter, of which some part may not be set where it is read.
struct UnsetVariable {
  std::uint32_t id = 0;    ///< in the module
  std::string name;        ///< as the shader spells it
  std::uint32_t line = 0;  ///< of the first such read, where the module tells lines (OpLine); 0 otherwise
  bool is_out = false;     ///< an `out` parameter that some way through its function leaves unset
};

/// The variables of a module, as glslang made it, that control flow lets be read before they are set, in the order of
/// their reads. Conditions are not looked at: what is set in one branch and read in a later one of the same condition
/// is among them, so only `with_values` tells whether it matters. Parts of vectors, structures and small arrays are
/// told apart; an index that is computed sets every element it may mean. Cost: linear in the module, and in blocks
/// times variables that pass from block to block.
std::vector<UnsetVariable> find_unset_variables(std::span<const std::uint32_t> spirv);

/// The module with `value` (0 and 1: false and true) in all parts of these variables, where their function begins.
std::vector<std::uint32_t> with_values(std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> variables,
                                       float value);

}  // namespace dmvv::compiler::snippet
