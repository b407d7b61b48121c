#include "compiler/ir/opacity.h"

#include <algorithm>

namespace dmvv::compiler {

bool is_opaque(const Module& module, const Region& region) {
  if (region.opacity < least_opaque) return false;
  if (region.kind != voml::RegionKind::bitmap) return true;
  return std::ranges::all_of(at(module.bitmaps, region.bitmap).texels, [](const auto& t) { return t.a == 255; });
}

bool is_medium(const Module& module, const Region& region) { return region.number != 0 && !is_opaque(module, region); }

bool has_media(const Module& module) {
  return std::ranges::any_of(module.regions, [&](const Region& region) { return is_medium(module, region); });
}

}  // namespace dmvv::compiler
