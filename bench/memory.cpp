#include "bench/memory.h"

#include <malloc.h>

#include <fstream>
#include <sstream>
#include <string>

namespace dmvv::bench {
namespace {

/// "VmHWM:     12345 kB" of /proc/self/status.
std::optional<std::uint64_t> status_bytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with(field + ":")) continue;
    std::istringstream words(line.substr(field.size() + 1));
    std::uint64_t kilobytes = 0;
    if (words >> kilobytes) return 1024 * kilobytes;
  }
  return std::nullopt;
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);
  std::ofstream reset("/proc/self/clear_refs");
  reset << 5;
  if (reset.flush()) before_ = status_bytes("VmRSS");
}

std::optional<std::uint64_t> PeakMemory::bytes() const {
  const auto peak = status_bytes("VmHWM");
  if (!before_ || !peak) return std::nullopt;
  return *peak > *before_ ? *peak - *before_ : 0;
}

}  // namespace dmvv::bench
