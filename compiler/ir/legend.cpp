#include "compiler/ir/legend.h"

#include <fmt/format.h>

namespace dmvv::compiler {

namespace {

const char* kind_name(voml::RegionKind kind) {
  switch (kind) {
    case voml::RegionKind::color:
      return "color";
    case voml::RegionKind::bitmap:
      return "bitmap";
    case voml::RegionKind::empty:
      return "empty";
  }
  return "";
}

}  // namespace

std::vector<RegionInfo> legend(const Module& module) {
  std::vector<RegionInfo> infos;
  infos.reserve(module.regions.size());
  for (const Region& region : module.regions) {
    infos.push_back({region.number, at(module.objects, region.object).name, region.name, kind_name(region.kind),
                     region.rgb, region.opacity});
  }
  return infos;
}

std::string format_path(const std::vector<RegionInfo>& regions, const std::vector<PathStep>& path) {
  std::string text;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const RegionInfo& info = regions[path[i].region];
    const bool last = i + 1 == path.size();
    text += fmt::format("{}:{}", info.object, info.region);
    if (!last) text += fmt::format("[{}]/", path[i].candidate);
  }
  return text;
}

}  // namespace dmvv::compiler
