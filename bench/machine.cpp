#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "bench/report.h"

namespace dmvv::bench {
namespace {

/// "model name\t: Intel ..." of /proc/cpuinfo; the machine's architecture where the kernel has no such line.
std::string cpu_name(const std::string& architecture) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return architecture;
}

std::string compiler_name() {
#if defined(__clang__)
  return fmt::format("clang++ {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

}  // namespace

Machine this_machine(const runtime::DeviceInfo& device) {
  Machine machine;
  machine.dmvv = DMVV_VERSION;
  machine.compiler = compiler_name();
  machine.glslang = DMVV_GLSLANG_VERSION;
  machine.device = device.name;
  machine.device_kind = device.kind;
  machine.driver = device.driver;
  machine.vulkan = device.api_version;
  utsname system{};
  uname(&system);
  machine.system = fmt::format("{} {} {}", system.sysname, system.release, system.machine);
  machine.cpu = cpu_name(system.machine);
  machine.cores = std::thread::hardware_concurrency();
  machine.memory_bytes =
      static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  double load = 0.0;
  if (getloadavg(&load, 1) == 1) machine.load = load;
  return machine;
}

}  // namespace dmvv::bench
