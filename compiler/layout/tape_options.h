// When a snippet becomes a tape, and what making tapes may cost.
#pragma once

#include <cstdint>

namespace dmvv::compiler {

/// Budgets are those of all snippets together, which share them evenly.
struct TapeOptions {
  bool shorten = true;                  ///< off: one tape for the whole cube
  std::uint32_t least_size = 1500;      ///< instructions of a snippet that may be a tape; smaller ones are written out
  std::uint32_t most_written = 20'000;  ///< instructions of the largest snippet that a driver can be asked to compile
  std::uint32_t most_code = 65'536;     ///< beyond that a snippet that cannot be a tape is refused (E0430)
  /// How much more an instruction of a tape costs than a written one, for a picture a third of which lies in cells
  /// whose side is not known: a snippet that intervals do not shorten as much is written out. Measured on lavapipe: 20
  /// to 30 times.
  double walking_cost = 10.0;
  /// Steps evaluated over boxes, some 40 ns each on one core: what bounds the time. Counted, not timed, so that the
  /// same scene gives the same tapes.
  std::uint64_t most_work = 20'000'000;
  std::uint64_t most_steps = 3'000'000;  ///< of all tapes, 8 bytes each on the device: 24 MB
  std::uint32_t most_cells = 1u << 21;   ///< 4 bytes each: 8 MiB
};

}  // namespace dmvv::compiler
