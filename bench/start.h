// How long a user waits: `dmvv render` as a process of its own, from its start to its end.
#pragma once

#include <string>
#include <vector>

#include "bench/source.h"

namespace dmvv::bench {

struct StartOptions {
  std::string program;  ///< path of dmvv
  glm::uvec2 size_px{1280, 720};
  std::uint32_t cold = 3;  ///< starts with empty caches, ours and the driver's
  std::uint32_t warm = 7;  ///< starts with those that one of them left
};

struct Starts {
  std::string scene;
  std::string failure;  ///< why there is nothing else; empty: measured
  std::vector<double> cold_ms, warm_ms;
};

/// Draws a picture of a scene on disk, again and again.
Starts measure_starts(const SceneSource& source, const StartOptions& options);

}  // namespace dmvv::bench
