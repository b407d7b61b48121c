// Spans of time that stand for any time.
#pragma once

namespace dmvv::compiler {

/// Times beyond this, in milliseconds, are refused: what is said of any time holds up to it.
inline constexpr double any_time_ms = 1e300;

/// Proofs that hold for ever hold for so many milliseconds back and ahead. (Of infinity, sines would be NaN.)
inline constexpr double longest_ms = 1e15;

}  // namespace dmvv::compiler
