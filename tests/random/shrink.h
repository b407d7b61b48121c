// Makes a scene smaller while something stays true of it.
#pragma once

#include <cstddef>
#include <functional>

#include "tests/random/description.h"

namespace dmvv::tests::random_scenes {

/// The smallest scene found that `fails`, by trying one simplification after the other until none helps or `most` were
/// tried. In: fails(scene) is true.
Scene shrink(Scene scene, const std::function<bool(const Scene&)>& fails, std::size_t most);

/// Objects, SDFs, regions, tree nodes, embedded elements and seeds.
std::size_t size(const Scene& scene);

}  // namespace dmvv::tests::random_scenes
