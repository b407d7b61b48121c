// Scenes made to grow in one way: more objects, deeper trees, deeper embedding, larger atlases. Deterministic.
#pragma once

#include <cstdint>
#include <string>

#include "bench/source.h"

namespace dmvv::bench {

/// One cube with `count` analytic balls of two regions, embedded by seeds at even density: some 30 % of the cube is
/// ball.
SceneSource many_objects(std::uint32_t count);

enum class Source { analytic, grid };
enum class TreeForm { chain, full };

/// One object whose tree is a chain of `depth` decisions (concentric shells; the innermost is reached through all), or
/// a full tree of `depth` levels (planes of alternating axes; 2^depth leaves).
SceneSource decision_tree(TreeForm form, Source source, std::uint32_t depth);

/// `depth` objects, each a ball in the one before it.
SceneSource nested_objects(std::uint32_t depth);

/// `count` different grids of n^3 samples, each in an object of its own, all embedded in one cube.
SceneSource many_grids(std::uint32_t count, std::uint32_t n);

/// One boundary of at least `operations` operations: lines of text, each stroke of a letter a capsule, joined by smooth
/// unions. To be looked at as a slice, which is set.
SceneSource large_snippet(std::uint32_t operations);

/// The body of a distance function of exactly `operations` operations (3 or more), each a statement on a line of its
/// own that gives a new name to what a sum, product, minimum or maximum of earlier ones is: lines of text, each stroke
/// of a letter the intersection of four half planes. So the field writes its benchmarks of implicit surfaces (Keeter
/// 2020: "prospero", 7,866 operations).
std::string expression_text(std::uint32_t operations);
/// One boundary with that body. To be looked at as a slice, which is set.
SceneSource expression(std::uint32_t operations);

/// Nothing but one region: what evaluating costs before there is anything to decide.
SceneSource empty_cube();

}  // namespace dmvv::bench
