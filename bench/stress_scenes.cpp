#include "bench/stress_scenes.h"

#include <fmt/format.h>

#include "voml/assets/grid.h"
#include "voml/scene.h"

namespace dmvv::stress {

double Random::uniform() {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

glm::dvec3 Random::point(double lo, double hi) {
  const double x = in(lo, hi), y = in(lo, hi);
  return {x, y, in(lo, hi)};
}

std::string lxn_of(std::uint32_t n, const std::function<double(glm::dvec3)>& f) {
  voml::Grid grid;
  grid.size = glm::uvec3(n);
  for (std::uint32_t z = 0; z < n; ++z) {
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        grid.values.push_back(static_cast<float>(f((glm::dvec3(x, y, z) + 0.5) / double(n) * 2.0 - 1.0)));
      }
    }
  }
  return voml::write_lxn(grid);
}

StressScene deep_chain(int levels, double scale) {
  std::string text = "<MVV>\n";
  for (int i = levels - 1; i >= 0; --i) {
    const std::string inner =
        i + 1 < levels
            ? fmt::format("<EMBEDDED name='L{0}' translate='0.1 0.05 -0.1' rotate='10 20 30' scale='{1} {1} {1}'/>",
                          i + 1, scale)
            : std::string();
    text += fmt::format(
        "<OBJECT name='L{}'><SDF name='S' function='true'>return length(p) - 0.9;</SDF>"
        "<REGION name='IN' type='color' rgb='{} 0.5 0.2'>{}</REGION><REGION name='OUT' type='empty'/>"
        "<MAPPINGS><SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT>\n",
        i, static_cast<double>(i) / levels, inner);
  }
  return {text + "</MVV>\n", {}};
}

StressScene one_sdf(const std::string& sdf, std::map<std::string, std::string> files) {
  return {"<MVV><OBJECT name='A'><SDF name='S' " + sdf +
              "<REGION name='IN' type='color' rgb='1 0 0'/><REGION name='OUT' type='color' rgb='0 0 1'/><MAPPINGS>"
              "<SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT></MVV>",
          std::move(files)};
}

StressScene deep_tree(int levels) {
  std::string sdfs, regions, open, close;
  for (int i = 0; i < levels; ++i) {
    // Slabs x < -1 + 2 (i + 1) / (levels + 1), each inside the next one's positive side.
    sdfs += fmt::format("<SDF name='S{}' function='true'>return p.x - ({:.9f});</SDF>", i,
                        -1.0 + 2.0 * (i + 1) / (levels + 1));
    regions += fmt::format("<REGION name='R{}' type='color' rgb='{} 0 0'/>", i, static_cast<double>(i) / levels);
    open += fmt::format("<SDF name='S{0}'><NEGATIVE region='R{0}'/><POSITIVE>", i);
    close += "</POSITIVE></SDF>";
  }
  return {"<MVV><OBJECT name='A'>" + sdfs + regions + "<REGION name='REST' type='color' rgb='0 1 0'/><MAPPINGS>" +
              open + "<REGION name='REST'/>" + close + "</MAPPINGS></OBJECT></MVV>",
          {}};
}

std::string seed_lines(int count, std::uint64_t seed, double half_extent) {
  Random random(seed);
  std::string text;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 p = random.point(-half_extent, half_extent);
    text += fmt::format("{:.7f} {:.7f} {:.7f}\n", p.x, p.y, p.z);
  }
  return text;
}

}  // namespace dmvv::stress
