#include "bench/memory.h"

#include <fstream>
#include <sstream>
#include <string>

/// jemalloc's, where the program has that (cli/main.cpp).
extern "C" __attribute__((weak)) int mallctl(const char* name, void* old_value, std::size_t* old_bytes, void* new_value,
                                             std::size_t new_bytes);

namespace dmvv::bench {
namespace {

/// What is freed goes back to the system.
void trim_heap() {
  if (mallctl != nullptr) mallctl("arena.4096.purge", nullptr, nullptr, nullptr, 0);  // 4096: all arenas
}

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
  trim_heap();
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
