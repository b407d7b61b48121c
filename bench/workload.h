// Scenes made to grow in one way: more objects, deeper trees, deeper embedding, larger atlases. Deterministic.
#pragma once

#include <cstdint>

#include "bench/source.h"

namespace dmvv::bench {

/// One cube with `count` analytic balls of two regions, embedded by seeds at even density: some 30 % of the cube is ball.
SceneSource many_objects(std::uint32_t count);

enum class Source { analytic, grid };
enum class TreeForm { chain, full };

/// One object whose tree is a chain of `depth` decisions (concentric shells; the innermost is reached through all), or a
/// full tree of `depth` levels (planes of alternating axes; 2^depth leaves).
SceneSource decision_tree(TreeForm form, Source source, std::uint32_t depth);

/// `depth` objects, each a ball in the one before it.
SceneSource nested_objects(std::uint32_t depth);

/// `count` different grids of n^3 samples, each in an object of its own, all embedded in one cube.
SceneSource many_grids(std::uint32_t count, std::uint32_t n);

/// One boundary of at least `operations` operations (up to some 20,000, the limit of a snippet's text): lines of text, each
/// stroke of a letter a capsule, joined by smooth unions. To be looked at as a slice, which is set.
SceneSource large_snippet(std::uint32_t operations);

/// Nothing but one region: what evaluating costs before there is anything to decide.
SceneSource empty_cube();

}  // namespace dmvv::bench
