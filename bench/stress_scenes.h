// Scenes of the stress cases, as VOML text with their files.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <map>
#include <string>

namespace dmvv::stress {

struct StressScene {
  std::string text;
  std::map<std::string, std::string> files;
};

/// Small deterministic generator (splitmix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform();  ///< [0, 1)
  double in(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  glm::dvec3 point(double lo = -1.0, double hi = 1.0);

 private:
  std::uint64_t state_;
};

/// An LXN file of n^3 values of f, cell-centred.
std::string lxn_of(std::uint32_t n, const std::function<double(glm::dvec3)>& f);

/// Each object embeds the next at `scale`, off centre and turned; balls of radius 0.9, analytic.
StressScene deep_chain(int levels, double scale);
/// One object with one SDF; `sdf` are attributes and content of the element.
StressScene one_sdf(const std::string& sdf, std::map<std::string, std::string> files = {});
/// Halves of a cube, `levels` decisions nested.
StressScene deep_tree(int levels);
/// Points as a seed file: fractions of the cube's edge.
std::string seed_lines(int count, std::uint64_t seed, double half_extent);

}  // namespace dmvv::stress
