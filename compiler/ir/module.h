// The IR: what a scene means. Matrices composed in double, names kept for messages only, nothing that the root cannot
// reach. compiler::reference and the generated shaders read it and must agree; nothing else defines semantics.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/id.h"
#include "compiler/ir/affine.h"
#include "compiler/snippet/snippet.h"
#include "voml/assets/grid.h"
#include "voml/scene.h"

namespace dmvv::compiler {

/// An analytic distance function, understood.
struct Function {
  std::string name;  ///< of the first SDF that uses it
  snippet::Snippet snippet;
};

/// A box in a local frame; by default the standard cube.
struct LocalBox {
  glm::dvec3 lo{-1.0};
  glm::dvec3 hi{1.0};
  friend bool operator==(const LocalBox&, const LocalBox&) = default;
};

/// A signed distance source with its placements.
///
/// value(p) = min over placements of f(local_from_object * p), +infinity where a placement's box does not hold the
/// local point. The side is positive where value > iso or value is NaN.
struct Sdf {
  std::string name;
  Span span;
  std::variant<Id<voml::Grid>, Id<Function>> source;
  voml::Placement placement = voml::Placement::single;
  std::vector<Affine> local_from_object;  ///< one, or one a seed in file order
  glm::uvec3 index_size{0};               ///< the author's wish; 0: the compiler chooses
  double iso = 0.0;
  LocalBox content;  ///< of the local frame: beyond it no device finds the source at or below iso (content.h)
};

struct Object;
struct Region;
struct Node;

/// One embedded object: asked where its standard cube holds the local point (everywhere if tiled).
struct Candidate {
  Id<Object> object;
  Affine local_from_parent;
  bool tiled = false;
};

/// A run of candidates, asked in order. With a box, a point outside it asks none of them.
struct CandidateGroup {
  std::optional<Affine> box_from_object;  ///< of an INDEX: the box is the standard cube of that frame
  glm::uvec3 index_size{0};               ///< the author's wish; 0: the compiler chooses
  std::uint32_t first_number = 0;         ///< number of candidates[0] within the region, as paths print it
  std::vector<Candidate> candidates;
};

struct Region {
  std::string name;
  Id<Object> object;
  std::uint32_t number = 0;  ///< what pictures store: 1, 2, ... in document order; 0 for a region that is empty
  voml::RegionKind kind = voml::RegionKind::empty;
  glm::dvec3 rgb{0.0};
  double opacity = 1.0;
  Id<voml::Bitmap> bitmap;
  Affine texture_from_object;  ///< the wrapped cube [-1,1)^3 of this frame is the bitmap once
  std::vector<CandidateGroup> groups;
};

struct Decision {
  Id<Sdf> sdf;
  Id<Node> positive;
  Id<Node> negative;
};

struct Node {
  std::variant<Decision, Id<Region>> content;
};

struct Object {
  std::string name;
  Id<Node> root;
  LocalBox content;  ///< beyond it every device finds the object empty (content.h)
};

struct Module {
  Id<Object> root;
  std::vector<Object> objects;  ///< every object stands before the ones it embeds
  std::vector<Sdf> sdfs;
  std::vector<Region> regions;
  std::vector<Node> nodes;
  std::vector<voml::Grid> grids;
  std::vector<voml::Bitmap> bitmaps;
  std::vector<Function> functions;
  std::uint32_t depth = 1;  ///< objects on the longest chain of embeddings, the root counted
};

struct LowerOptions {
  bool check_everything = false;  ///< also compiles the snippets that the root does not reach, for their mistakes
  CodeCache cache = {};           ///< asked before a snippet is compiled
  /// Told after each snippet how many of how many are compiled. May be empty.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Scene -> Module: composes matrices, drops what the root does not reach, orders objects, refuses cycles.
/// Errors: E0110 embedding cycle (prints it); E04xx of the snippets that the root reaches.
/// Cost: linear; the assets are moved, not copied; each snippet is compiled once.
std::optional<Module> lower(voml::Scene scene, Diagnostics& diagnostics, const LowerOptions& options = {});

/// The module as text, one line a thing, stable across runs: for `--dump module` and goldens.
std::string to_text(const Module& module);

}  // namespace dmvv::compiler
