#include "cli/driver_cache.h"

#include <cstdlib>
#include <deque>

#include "base/files.h"

namespace dmvv::cli {

void empty_driver_cache() {
  static std::deque<TemporaryFolder> folders;  // they go with the process: a driver may write to the end
  const TemporaryFolder& folder = folders.emplace_back();
  if (folder.path().empty()) {
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    setenv("__GL_SHADER_DISK_CACHE", "0", 1);
  } else {
    setenv("MESA_SHADER_CACHE_DIR", folder.path().c_str(), 1);
    setenv("__GL_SHADER_DISK_CACHE_PATH", folder.path().c_str(), 1);
  }
}

}  // namespace dmvv::cli
