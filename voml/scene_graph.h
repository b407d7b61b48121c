// Inside voml: what uses what. Tolerates references that could not be resolved.
#pragma once

#include <vector>

#include "voml/scene.h"

namespace dmvv::voml {

/// The SDFs and regions of an object's tree, each once, in the order of the tree.
struct TreeUses {
  std::vector<Id<Sdf>> sdfs;
  std::vector<Id<Region>> regions;
};
TreeUses uses_of_tree(const Scene& scene, Id<Object> object);

/// Flags, parallel to the scene's vectors.
struct Needed {
  std::vector<bool> sdfs;
  std::vector<bool> regions;
};
/// What a point of `root` may ask. With an invalid root: nothing.
Needed needed_by(const Scene& scene, Id<Object> root);

/// Reports every embedding that closes a cycle (E0110). Cost: linear; no recursion.
void report_embedding_cycles(const Scene& scene, Diagnostics& diagnostics);

}  // namespace dmvv::voml
