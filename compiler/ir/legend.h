// Which region answers at a point, and on which way: what all evaluators answer with.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// Legend of one region.
struct RegionInfo {
  std::uint32_t number;  ///< what pictures store; 0 for a region that is empty
  std::string object;
  std::string region;
  std::string kind;  ///< "color", "bitmap", "empty"
  glm::dvec3 rgb;    ///< color only
  double opacity;
};

/// One level of the way from the root object to the region that answered.
struct PathStep {
  std::uint32_t region;     ///< index into Program::regions (and Module::regions)
  std::uint32_t candidate;  ///< the region's candidate that was entered; 0 in the last step
  friend bool operator==(const PathStep&, const PathStep&) = default;
};

/// What a scene is at one point.
struct PointAnswer {
  std::uint32_t number = 0;    ///< region number; 0: empty
  std::vector<PathStep> path;  ///< root first; without any step where empty
  glm::dvec4 rgba{0.0};        ///< straight alpha, sRGB as shown; 0 where empty
  bool finished = true;        ///< false: the device ran out of loop rounds, nothing else is valid
};

/// "ORANGE:R.INNER[0]/ORANGE_SECTION:R.PULP"; empty for an empty path.
std::string format_path(const std::vector<RegionInfo>& regions, const std::vector<PathStep>& path);

/// The legend of a module's regions, in its order.
std::vector<RegionInfo> legend(const Module& module);

}  // namespace dmvv::compiler
