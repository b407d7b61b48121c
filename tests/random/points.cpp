#include "tests/random/points.h"

#include <algorithm>
#include <cmath>

#include "tests/support/random.h"

namespace dmvv::tests::random_scenes {

namespace {

glm::dvec3 rounded(const glm::dvec3& p) { return glm::dvec3(glm::vec3(p)); }

glm::dvec3 on_plane(Random& random) {
  glm::dvec3 p = random.point();
  const double special[] = {-1.0, 1.0, 0.0};
  p[static_cast<int>(random.below(3))] = special[random.below(3)];
  if (random.chance(0.3)) p[static_cast<int>(random.below(3))] = special[random.below(3)];
  return p;
}

/// The SDFs of an object's tree.
std::vector<Id<compiler::Sdf>> sdfs_of(const compiler::Module& module, Id<compiler::Object> object) {
  std::vector<Id<compiler::Sdf>> found;
  std::vector<Id<compiler::Node>> pending{at(module.objects, object).root};
  while (!pending.empty()) {
    const auto& content = at(module.nodes, pending.back()).content;
    pending.pop_back();
    if (const auto* decision = std::get_if<compiler::Decision>(&content)) {
      found.push_back(decision->sdf);
      pending.push_back(decision->positive);
      pending.push_back(decision->negative);
    }
  }
  return found;
}

/// A point in or on the cube of something embedded: goes down a few levels by chance, and back to the root.
glm::dvec3 aimed(const compiler::Module& module, Random& random) {
  compiler::Affine local_from_root;
  Id<compiler::Object> object = module.root;
  for (int level = 0; level < 8; ++level) {
    std::vector<const compiler::Candidate*> candidates;
    for (const auto& region : module.regions) {
      if (region.object != object) continue;
      for (const auto& group : region.groups) {
        for (const auto& candidate : group.candidates) candidates.push_back(&candidate);
      }
    }
    if (candidates.empty() || random.chance(0.2)) break;
    const auto* chosen = candidates[random.below(static_cast<std::uint32_t>(candidates.size()))];
    local_from_root = chosen->local_from_parent * local_from_root;
    object = chosen->object;
  }
  const auto sdfs = sdfs_of(module, object);
  if (!sdfs.empty() && random.chance(0.4)) {
    const auto& placed = at(module.sdfs, sdfs[random.below(static_cast<std::uint32_t>(sdfs.size()))]).local_from_object;
    if (!placed.empty())
      local_from_root = placed[random.below(static_cast<std::uint32_t>(placed.size()))] * local_from_root;
  }
  const glm::dvec3 local = random.chance(0.2) ? on_plane(random) : random.point(-1.05, 1.05);
  return inverse(local_from_root)(local);
}

bool same(const compiler::PointAnswer& a, const compiler::PointAnswer& b) { return a.path == b.path; }

}  // namespace

Points draw_points(const compiler::Module& module, const compiler::Reference& reference, double time_ms,
                   std::uint64_t seed, std::size_t count) {
  Random random(seed);
  Points points;
  while (points.all.size() < (count + 3) / 4) points.all.push_back(rounded(random.point(-1.02, 1.02)));
  points.uniform = points.all.size();
  while (points.all.size() < count * 3 / 8) points.all.push_back(rounded(on_plane(random)));
  while (points.all.size() < count * 6 / 8) points.all.push_back(rounded(aimed(module, random)));
  // Both sides of boundaries: the segment between two points that differ, halved down to a random length.
  const std::size_t known = points.all.size();
  for (std::size_t tries = 0; tries < 8 * count && points.all.size() + 1 < count; ++tries) {
    glm::dvec3 a = points.all[random.below(static_cast<std::uint32_t>(known))];
    glm::dvec3 b = points.all[random.below(static_cast<std::uint32_t>(known))];
    const auto at_a = reference.evaluate(a, time_ms);
    if (same(at_a, reference.evaluate(b, time_ms))) continue;
    const double length = std::pow(10.0, random.in(-7.0, -2.0));
    while (std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}) > length) {
      const glm::dvec3 middle = 0.5 * (a + b);
      if (middle == a || middle == b) break;
      (same(at_a, reference.evaluate(middle, time_ms)) ? a : b) = middle;
    }
    points.all.push_back(rounded(a));
    points.all.push_back(rounded(b));
  }
  return points;
}

}  // namespace dmvv::tests::random_scenes
