// Resident memory of this process, as Linux tells it.
#pragma once

#include <cstdint>
#include <optional>

namespace dmvv::bench {

/// Measures the highest resident memory since it was made, beyond what was resident then.
class PeakMemory {
 public:
  /// Gives freed memory back to the system and resets the kernel's high-water mark (/proc/self/clear_refs).
  PeakMemory();
  /// Bytes; empty where /proc does not tell or the mark could not be reset.
  std::optional<std::uint64_t> bytes() const;

 private:
  std::optional<std::uint64_t> before_;
};

}  // namespace dmvv::bench
