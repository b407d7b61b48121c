// A Scene as text, without the places of its parts: two scenes that mean the same give the same text.
#pragma once

#include <fmt/format.h>

#include <string>

#include "voml/scene.h"

namespace dmvv::tests {

inline std::string to_text(const glm::dvec3& v) { return fmt::format("({} {} {})", v.x, v.y, v.z); }
inline std::string to_text(const voml::Transform& t) {
  return to_text(t.translate) + to_text(t.rotate_deg) + to_text(t.scale);
}

inline std::string to_text(const voml::Scene& scene) {
  std::string out = fmt::format("root {}\n", scene.root.index);
  for (const voml::Object& o : scene.objects) out += fmt::format("object {} {}\n", o.name, o.root.index);
  for (const voml::Sdf& s : scene.sdfs) {
    const auto* grid = std::get_if<Id<voml::Grid>>(&s.source);
    const std::size_t source = grid ? grid->index : std::get<Id<voml::Function>>(s.source).index;
    out += fmt::format("sdf {} {}{} {} {} {} {} {}\n", s.name, grid ? 'g' : 'f', source, static_cast<int>(s.placement),
                       to_text(s.transform), s.seeds.index, s.index_size ? to_text(glm::dvec3(*s.index_size)) : "",
                       s.offset);
  }
  for (const voml::Region& r : scene.regions) {
    out += fmt::format("region {} {} {} {} {} {} {}\n", r.name, r.object.index, static_cast<int>(r.kind),
                       to_text(r.rgb), r.bitmap.index, to_text(r.transform), r.opacity);
    for (const voml::EmbeddingGroup& group : r.groups) {
      out += group.index ? "  index " + to_text(glm::dvec3(group.index->size)) + to_text(group.index->transform) + '\n'
                         : "  group\n";
      for (const voml::Embedded& e : group.embedded) {
        out += fmt::format("    {} {} {} {}\n", e.object.index, static_cast<int>(e.placement), to_text(e.transform),
                           e.seeds.index);
      }
    }
  }
  for (const voml::Node& n : scene.nodes) {
    const auto* d = std::get_if<voml::Decision>(&n.content);
    out += d ? fmt::format("node {} {} {}\n", d->sdf.index, d->positive.index, d->negative.index)
             : fmt::format("leaf {}\n", std::get<Id<voml::Region>>(n.content).index);
  }
  for (const voml::Grid& g : scene.grids) out += fmt::format("grid {} {}\n", g.path, g.values.size());
  for (const voml::Bitmap& b : scene.bitmaps) out += fmt::format("bitmap {} {}\n", b.path, b.texels.size());
  for (const voml::SeedList& l : scene.seed_lists) {
    out += "seeds " + l.path + '\n';
    for (const voml::Seed& s : l.seeds) {
      out += "  " + to_text(s.position) + to_text(s.rotate_deg) + to_text(s.scale) + '\n';
    }
  }
  for (const voml::Function& f : scene.functions) {
    out += "function [" + f.body.text + "]\n";
    for (const voml::GlslText& helper : f.helpers) out += "  [" + helper.text + "]\n";
  }
  return out;
}

}  // namespace dmvv::tests
