// A period is known of a value where nothing but its remainder matters, as of the argument of a sine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compiler/snippet/program.h"
#include "compiler/snippet/time_slot.h"

namespace dmvv::compiler::snippet {

/// For each temporary, the period modulo which alone its value matters.
/// In:   the program must outlive it.
/// Cost: linear in the program.
class Periods {
 public:
  explicit Periods(const Program& program);

  /// The period modulo which alone operand k matters to the instruction.
  Period of_use(const Instruction& instruction, std::size_t k) const;

 private:
  static constexpr Period unused = static_cast<Period>(255);

  void list(const Sequence& sequence, std::vector<std::uint32_t>& order) const;

  const Program& program_;
  std::vector<Period> periods_;
};

}  // namespace dmvv::compiler::snippet
