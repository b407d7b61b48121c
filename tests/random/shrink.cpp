#include "tests/random/shrink.h"

#include <algorithm>
#include <cmath>

#include "compiler/ir/affine.h"

namespace dmvv::tests::random_scenes {

namespace {

/// Changes a scene; false if there was nothing to change.
using Edit = std::function<bool(Scene&)>;
using Edits = std::vector<Edit>;

template <class T>
bool set(T& target, const T& value) {
  if (target == value) return false;
  target = value;
  return true;
}

bool set(Transform& target, const Transform& value) {
  const bool translated = set(target.translate, value.translate), rotated = set(target.rotate_deg, value.rotate_deg);
  return set(target.scale, value.scale) || translated || rotated;
}

template <class T>
void erase_at(std::vector<T>& from, std::size_t i) {
  from.erase(from.begin() + static_cast<std::ptrdiff_t>(i));
}

// ---- references ----

void for_each_node(Tree& tree, const std::function<void(Tree&)>& visit) {
  visit(tree);
  for (Tree& side : tree.sides) for_each_node(side, visit);
}

/// Takes nodes out whose SDF `gone` names, keeping their negative side, and gives leaves whose region it names region 0
/// of their own object.
void drop_references(Tree& tree, std::uint32_t own, const std::function<bool(const Reference&, bool is_sdf)>& gone) {
  while (!tree.sides.empty() && gone(tree.what, true)) {
    Tree side = std::move(tree.sides[1]);
    tree = std::move(side);
  }
  if (tree.sides.empty() && gone(tree.what, false)) tree.what = {own, 0};
  for (Tree& side : tree.sides) drop_references(side, own, gone);
}

/// Without the objects that `keep` rejects; the first one kept becomes the root.
void keep_objects(Scene& scene, const std::function<bool(std::uint32_t)>& keep) {
  std::vector<std::uint32_t> new_index(scene.objects.size());
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) new_index[i] = keep(i) ? count++ : 0xffffffffu;
  const auto lost = [&](std::uint32_t i) { return new_index[i] == 0xffffffffu; };
  std::vector<Object> kept;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    if (lost(i)) continue;
    Object object = std::move(scene.objects[i]);
    drop_references(object.tree, i, [&](const Reference& r, bool) { return lost(r.object); });
    for_each_node(object.tree, [&](Tree& node) { node.what.object = new_index[node.what.object]; });
    for (Region& region : object.regions) {
      for (Group& group : region.groups) {
        std::erase_if(group.embedded, [&](const Embedded& e) { return lost(e.object); });
        for (Embedded& e : group.embedded) e.object = new_index[e.object];
      }
      std::erase_if(region.groups, [](const Group& group) { return group.embedded.empty(); });
    }
    kept.push_back(std::move(object));
  }
  scene.objects = std::move(kept);
  scene.objects.front().imported = false;
}

/// Removes SDF or region `index` of an object, if no tree needs it.
bool remove_unused(Scene& scene, std::uint32_t object, std::uint32_t index, bool is_sdf) {
  Object& owner = scene.objects[object];
  if (owner.shorthand || (!is_sdf && owner.regions.size() == 1)) return false;
  bool used = false;
  const auto names = [&](const Tree& node) { return node.what.object == object && node.sides.empty() != is_sdf; };
  const auto each_tree = [&](const std::function<void(Tree&)>& visit) {
    for (Object& o : scene.objects) {
      if (!o.shorthand) for_each_node(o.tree, visit);
    }
  };
  each_tree([&](Tree& node) { used = used || (names(node) && node.what.index == index); });
  if (used) return false;
  each_tree([&](Tree& node) {
    if (names(node) && node.what.index > index) --node.what.index;
  });
  if (is_sdf)
    erase_at(owner.sdfs, index);
  else
    erase_at(owner.regions, index);
  return true;
}

// ---- the edits of each part ----

template <class Placed>
void placement_edits(Edits& edits, const Placed& now, const std::function<Placed&(Scene&)>& part) {
  const std::size_t count = now.placement == Placement::seeded ? now.seeds.lines.size() : 0;
  if (count <= 1) {
    edits.push_back([part](Scene& scene) {
      Placed& p = part(scene);
      if (p.placement == Placement::seeded && p.seeds.lines.size() == 1) {
        voml::Seed seed = p.seeds.lines[0];
        if (!p.seeds.rotates) seed.rotate_deg = glm::dvec3(0.0);
        if (!p.seeds.scales) seed.scale = glm::dvec3(1.0);
        p.transform = compiler::combine(p.transform, seed);
      } else if (p.placement == Placement::single) {
        return false;
      }
      p.placement = Placement::single;
      p.seeds = {};
      return true;
    });
  }
  for (std::size_t chunk = (count + 1) / 2; chunk > 0 && count > 1; chunk /= 2) {
    for (std::size_t first = 0; first < count; first += chunk) {
      edits.push_back([part, first, chunk](Scene& scene) {
        auto& lines = part(scene).seeds.lines;
        if (first >= lines.size()) return false;
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(first),
                    lines.begin() + static_cast<std::ptrdiff_t>(std::min(first + chunk, lines.size())));
        return true;
      });
    }
  }
  edits.push_back([part](Scene& scene) { return set(part(scene).seeds.rotates, false); });
  edits.push_back([part](Scene& scene) { return set(part(scene).seeds.scales, false); });
  edits.push_back([part](Scene& scene) { return set(part(scene).transform, Transform{}); });
  edits.push_back([part](Scene& scene) { return set(part(scene).transform.rotate_deg, glm::dvec3(0.0)); });
  edits.push_back([part](Scene& scene) { return set(part(scene).transform.translate, glm::dvec3(0.0)); });
  edits.push_back([part](Scene& scene) { return set(part(scene).transform.scale, glm::dvec3(1.0)); });
}

void grid_edits(Edits& edits, const std::function<Sdf&(Scene&)>& part) {
  const auto add = [&](const std::function<bool(Grid&)>& change) {
    edits.push_back([part, change](Scene& scene) {
      auto* grid = std::get_if<Grid>(&part(scene).source);
      return grid && change(*grid);
    });
  };
  add([](Grid& g) { return set(g, Grid{.shape = Grid::Shape::plane, .size = {2, 1, 1}}); });
  add([](Grid& g) { return set(g.noise, 0.0); });
  add([](Grid& g) { return set(g.gain, 1.0); });
  add([](Grid& g) {
    const bool lo = set(g.box_lo, glm::dvec3(0.0));
    return set(g.box_hi, glm::dvec3(1.0)) || lo;
  });
  add([](Grid& g) { return set(g.size, {2, 2, 2}); });
  add([](Grid& g) { return set(g.size, glm::min(g.size, glm::uvec3(4))); });
  add([](Grid& g) { return set(g.center, glm::dvec3(0.0)); });
  add([](Grid& g) { return set(g.shape, Grid::Shape::ball); });
}

void sdf_edits(Edits& edits, const Scene& scene, std::uint32_t o, std::uint32_t i) {
  const Sdf& now = scene.objects[o].sdfs[i];
  const std::function<Sdf&(Scene&)> part = [o, i](Scene& s) -> Sdf& { return s.objects[o].sdfs[i]; };
  edits.push_back([o, i](Scene& s) { return remove_unused(s, o, i, true); });
  for (const char* simple : {"return 1.0;", "return p.x;", "return length(p) - 0.6;"}) {
    edits.push_back([part, simple](Scene& s) {
      auto* function = std::get_if<Function>(&part(s).source);
      if (function && function->body.size() <= std::string_view(simple).size()) return false;
      part(s).source = Function{simple};
      return true;
    });
  }
  placement_edits<Sdf>(edits, now, part);
  edits.push_back([part](Scene& s) { return set(part(s).index, std::optional<glm::uvec3>{}); });
  edits.push_back([part](Scene& s) { return set(part(s).offset, 0.0); });
  grid_edits(edits, part);
}

void region_edits(Edits& edits, const Scene& scene, std::uint32_t o, std::uint32_t i) {
  const Region& now = scene.objects[o].regions[i];
  const std::function<Region&(Scene&)> part = [o, i](Scene& s) -> Region& { return s.objects[o].regions[i]; };
  edits.push_back([o, i](Scene& s) { return remove_unused(s, o, i, false); });
  edits.push_back([part](Scene& s) {
    const bool had = !part(s).groups.empty();
    part(s).groups.clear();
    return had;
  });
  for (std::size_t g = 0; g < now.groups.size(); ++g) {
    edits.push_back([part, g](Scene& s) {
      if (g >= part(s).groups.size()) return false;
      erase_at(part(s).groups, g);
      return true;
    });
    edits.push_back([part, g](Scene& s) {
      const bool had = part(s).groups[g].index.has_value();
      part(s).groups[g].index.reset();
      return had;
    });
    edits.push_back([part, g](Scene& s) {
      auto& index = part(s).groups[g].index;
      return index && set(index->transform, Transform{});
    });
    edits.push_back([part, g](Scene& s) {
      auto& index = part(s).groups[g].index;
      return index && set(index->size, glm::uvec3(1));
    });
    for (std::size_t e = 0; e < now.groups[g].embedded.size(); ++e) {
      edits.push_back([part, g, e](Scene& s) {
        auto& group = part(s).groups[g].embedded;
        if (group.size() == 1) return false;
        erase_at(group, e);
        return true;
      });
      placement_edits<Embedded>(edits, now.groups[g].embedded[e],
                                [part, g, e](Scene& s) -> Embedded& { return part(s).groups[g].embedded[e]; });
    }
  }
  edits.push_back([part](Scene& s) { return set(part(s).kind, RegionKind::color); });
  edits.push_back([part](Scene& s) { return set(part(s).rgb, glm::dvec3(0.5)); });
  edits.push_back([part](Scene& s) { return set(part(s).opacity, 1.0); });
  edits.push_back([part](Scene& s) { return set(part(s).bitmap.n, 1u); });
  edits.push_back([part](Scene& s) { return set(part(s).bitmap.alpha, false); });
  edits.push_back([part](Scene& s) { return set(part(s).transform, Transform{}); });
}

/// Each node of a tree, in a fixed order, replaced by one of its sides or by a leaf.
void tree_edits(Edits& edits, const Scene& scene, std::uint32_t o) {
  if (scene.objects[o].shorthand) return;
  std::size_t count = 0;
  Tree tree = scene.objects[o].tree;
  for_each_node(tree, [&](Tree&) { ++count; });
  for (std::size_t node = 0; node < count; ++node) {
    for (const int way : {0, 1, 2}) {
      edits.push_back([o, node, way](Scene& s) {
        std::size_t i = 0;
        Tree* found = nullptr;
        for_each_node(s.objects[o].tree, [&](Tree& t) {
          if (i++ == node) found = &t;
        });
        if (!found) return false;
        if (way == 2) {
          const bool foreign = found->what.object != o;
          if (!foreign || !found->sides.empty()) return false;
          found->what = {o, 0};
          return true;
        }
        if (found->sides.empty()) return false;
        Tree side = std::move(found->sides[static_cast<std::size_t>(way)]);
        *found = std::move(side);
        return true;
      });
    }
  }
}

// ---- numbers ----

void numbers_of(Transform& t, std::vector<double*>& all) {
  for (glm::dvec3* v : {&t.translate, &t.rotate_deg, &t.scale}) {
    for (int axis = 0; axis < 3; ++axis) all.push_back(&(*v)[axis]);
  }
}

template <class Placed>
void numbers_of_placed(Placed& p, std::vector<double*>& all) {
  numbers_of(p.transform, all);
  for (voml::Seed& seed : p.seeds.lines) {
    for (int axis = 0; axis < 3; ++axis)
      all.insert(all.end(), {&seed.position[axis], &seed.rotate_deg[axis], &seed.scale[axis]});
  }
}

std::vector<double*> numbers_of(Scene& scene) {
  std::vector<double*> all;
  for (Object& object : scene.objects) {
    for (Sdf& sdf : object.sdfs) {
      numbers_of_placed(sdf, all);
      all.push_back(&sdf.offset);
      if (auto* grid = std::get_if<Grid>(&sdf.source))
        all.insert(all.end(), {&grid->center.x, &grid->center.y, &grid->center.z, &grid->radius});
    }
    for (Region& region : object.regions) {
      numbers_of(region.transform, all);
      all.push_back(&region.opacity);
      for (Group& group : region.groups) {
        if (group.index) numbers_of(group.index->transform, all);
        for (Embedded& e : group.embedded) numbers_of_placed(e, all);
      }
    }
  }
  return all;
}

void number_edits(Edits& edits, Scene scene) {
  const std::size_t count = numbers_of(scene).size();
  if (count > 200) return;  // structure first
  for (std::size_t i = 0; i < count; ++i) {
    for (const double steps : {1.0, 10.0, 100.0}) {
      edits.push_back([i, steps](Scene& s) {
        const auto numbers = numbers_of(s);
        return i < numbers.size() && set(*numbers[i], std::round(*numbers[i] * steps) / steps);
      });
    }
  }
}

/// What could make the scene simpler, the largest simplifications first.
Edits edits_of(const Scene& scene) {
  Edits edits;
  const auto count = static_cast<std::uint32_t>(scene.objects.size());
  for (std::uint32_t k = 1; k < count; ++k) {
    edits.push_back([k](Scene& s) {
      keep_objects(s, [k](std::uint32_t i) { return i >= k; });
      return true;
    });
  }
  for (std::uint32_t k = count; k-- > 1;) {
    edits.push_back([k](Scene& s) {
      keep_objects(s, [k](std::uint32_t i) { return i != k; });
      return true;
    });
  }
  for (std::uint32_t o = 0; o < count; ++o) {
    tree_edits(edits, scene, o);
    for (std::uint32_t i = static_cast<std::uint32_t>(scene.objects[o].regions.size()); i-- > 0;)
      region_edits(edits, scene, o, i);
    for (std::uint32_t i = static_cast<std::uint32_t>(scene.objects[o].sdfs.size()); i-- > 0;)
      sdf_edits(edits, scene, o, i);
    edits.push_back([o](Scene& s) { return set(s.objects[o].helpers, std::string()); });
    edits.push_back([o](Scene& s) { return set(s.objects[o].imported, false); });
  }
  edits.push_back([](Scene& s) { return set(s.style.upper_case, true); });
  edits.push_back([](Scene& s) { return set(s.style.commas, false); });
  edits.push_back([](Scene& s) { return set(s.style.inline_definitions, false); });
  edits.push_back([](Scene& s) { return set(s.style.short_sides, true); });
  edits.push_back([](Scene& s) { return set(s.style.cdata, true); });
  number_edits(edits, scene);
  return edits;
}

}  // namespace

Scene shrink(Scene scene, const std::function<bool(const Scene&)>& fails, std::size_t most) {
  std::size_t tried = 0;
  for (bool smaller = true; smaller;) {
    smaller = false;
    Edits edits = edits_of(scene);
    for (std::size_t i = 0; i < edits.size() && tried < most; ++i) {
      Scene candidate = scene;
      if (!edits[i](candidate)) continue;
      ++tried;
      if (!fails(candidate)) continue;
      scene = std::move(candidate);
      edits = edits_of(scene);  // what stood behind the edit is now about here
      smaller = true;
      if (i > 0) --i;
    }
  }
  return scene;
}

std::size_t size(const Scene& scene) {
  std::size_t n = scene.objects.size();
  for (const Object& object : scene.objects) {
    n += object.sdfs.size() + object.regions.size();
    Tree tree = object.tree;
    if (!object.shorthand) for_each_node(tree, [&](Tree&) { ++n; });
    for (const Sdf& sdf : object.sdfs) n += sdf.seeds.lines.size();
    for (const Region& region : object.regions) {
      for (const Group& group : region.groups) {
        for (const Embedded& e : group.embedded) n += 1 + e.seeds.lines.size();
      }
    }
  }
  return n;
}

}  // namespace dmvv::tests::random_scenes
