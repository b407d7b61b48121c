#include <fmt/format.h>

#include "compiler/ir/module.h"

namespace dmvv::compiler {

namespace {

std::string text(const glm::dvec3& v) { return fmt::format("({} {} {})", v.x, v.y, v.z); }

std::string text(const Affine& a) {
  if (a == Affine{}) return "identity";
  return fmt::format("[{} {} {} + {}]", text(a.linear[0]), text(a.linear[1]), text(a.linear[2]), text(a.translation));
}

const char* text(voml::Placement placement) {
  switch (placement) {
    case voml::Placement::single:
      return "single";
    case voml::Placement::seeded:
      return "seeded";
    case voml::Placement::tiled:
      return "tiled";
  }
  return "";
}

std::string source_text(const Sdf& sdf) {
  if (const auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source)) return fmt::format("grid {}", grid->index);
  return fmt::format("function {}", std::get<Id<Function>>(sdf.source).index);
}

std::string node_text(const Node& node) {
  if (const auto* region = std::get_if<Id<Region>>(&node.content)) return fmt::format("region {}", region->index);
  const auto& decision = std::get<Decision>(node.content);
  return fmt::format("sdf {} + node {} - node {}", decision.sdf.index, decision.positive.index,
                     decision.negative.index);
}

std::string region_text(const Region& region) {
  std::string line = fmt::format("'{}' of object {} number {}", region.name, region.object.index, region.number);
  switch (region.kind) {
    case voml::RegionKind::color:
      line += fmt::format(" color {} opacity {}", text(region.rgb), region.opacity);
      break;
    case voml::RegionKind::bitmap:
      line += fmt::format(" bitmap {} at {} opacity {}", region.bitmap.index, text(region.texture_from_object),
                          region.opacity);
      break;
    case voml::RegionKind::empty:
      line += " empty";
      break;
  }
  return line;
}

}  // namespace

std::string to_text(const Module& module) {
  std::string out = fmt::format("root object {}, depth {}\n", module.root.index, module.depth);
  for (std::size_t i = 0; i < module.objects.size(); ++i) {
    out += fmt::format("object {} '{}' node {}\n", i, module.objects[i].name, module.objects[i].root.index);
  }
  for (std::size_t i = 0; i < module.nodes.size(); ++i)
    out += fmt::format("node {} {}\n", i, node_text(module.nodes[i]));
  for (std::size_t i = 0; i < module.sdfs.size(); ++i) {
    const Sdf& sdf = module.sdfs[i];
    out += fmt::format("sdf {} '{}' {} {} iso {}\n", i, sdf.name, source_text(sdf), text(sdf.placement), sdf.iso);
    for (const Affine& affine : sdf.local_from_object) out += fmt::format("  at {}\n", text(affine));
  }
  for (std::size_t i = 0; i < module.regions.size(); ++i) {
    out += fmt::format("region {} {}\n", i, region_text(module.regions[i]));
    for (const CandidateGroup& group : module.regions[i].groups) {
      out += fmt::format("  group from {}{}\n", group.first_number,
                         group.box_from_object ? " box " + text(*group.box_from_object) : std::string());
      for (const Candidate& candidate : group.candidates) {
        out += fmt::format("    object {}{} at {}\n", candidate.object.index, candidate.tiled ? " tiled" : "",
                           text(candidate.local_from_parent));
      }
    }
  }
  for (std::size_t i = 0; i < module.grids.size(); ++i) {
    const voml::Grid& grid = module.grids[i];
    out += fmt::format("grid {} '{}' {}x{}x{} box {} {}\n", i, grid.path, grid.size.x, grid.size.y, grid.size.z,
                       text(grid.box_lo), text(grid.box_hi));
  }
  for (std::size_t i = 0; i < module.bitmaps.size(); ++i) {
    out += fmt::format("bitmap {} '{}' n {}\n", i, module.bitmaps[i].path, module.bitmaps[i].n);
  }
  for (std::size_t i = 0; i < module.functions.size(); ++i) {
    const Function& function = module.functions[i];
    out += fmt::format("function {} '{}' {} instructions, {}\n", i, function.name, function.snippet.instruction_count(),
                       function.snippet.uses_time() ? "animated" : "static");
  }
  return out;
}

}  // namespace dmvv::compiler
