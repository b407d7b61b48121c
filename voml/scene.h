// VOML text -> Scene: everything the author wrote, checked and resolved, in the author's own terms.
//
// Names are resolved, files are read, transforms are still translate / rotate / scale. Each thing keeps the span of the
// element that defines it. compiler::lower turns a Scene into matrices and trees.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/diagnostics.h"
#include "base/files.h"
#include "base/id.h"
#include "voml/assets/grid.h"

namespace dmvv::voml {

/// M = T * Rz * Ry * Rx * S, object <- local. Finite; no scale component is zero.
struct Transform {
  glm::dvec3 translate{0.0};
  glm::dvec3 rotate_deg{0.0};
  glm::dvec3 scale{1.0};
};

/// How often and where a thing stands.
enum class Placement : std::uint8_t {
  single,  ///< once, at its transform
  seeded,  ///< once a seed; the transform is combined with each seed component by component (spec/voml.md)
  tiled,   ///< the local point is wrapped into [-1, 1)
};

/// A seed, rotate and scale file read together; files left out count as zeros (rotate) and ones (scale).
struct SeedList {
  std::string path;  ///< of the seed file
  std::vector<Seed> seeds;
};

/// A run of a text and where it stands in its file: text bytes [begin, ...) of the run come from `span`. A run that
/// came through an entity is one piece whose span is the entity.
struct TextPiece {
  std::uint32_t begin = 0;  ///< offset in the text
  Span span;
};

/// GLSL text of a scene, entities resolved, CDATA joined.
struct GlslText {
  std::string text;
  std::vector<TextPiece> pieces;  ///< ascending; the first begins at 0
};

/// The place in its file of bytes [begin, end) of a text.
Span locate(const GlslText& text, std::uint32_t begin, std::uint32_t end);

/// A file with FUNCTIONS: what they define belongs to it, and is seen by the files that import it.
struct FunctionFile {
  std::vector<std::uint32_t> imports;  ///< files that it imports, in order; each stands before it in the list of files
};

/// Where FUNCTIONS stand.
struct HelperPlace {
  std::uint32_t file = 0;     ///< the number of files: in the function's object
  std::uint32_t imports = 0;  ///< of a file: how many of its imports stand before
};

/// An analytic distance function: the body of `float f(vec3 p, float t)`, and what it may call.
struct Function {
  GlslText body;
  Span span;                        ///< of the SDF element's text
  std::vector<GlslText> helpers;    ///< FUNCTIONS in scope: of imports and MVV in document order, then of the OBJECT
  std::vector<HelperPlace> places;  ///< parallel to helpers; empty: all stand in the object
  std::shared_ptr<const std::vector<FunctionFile>>
      files;  ///< the last is the object's; shared by its functions, may be null
};

struct Sdf {
  std::string name;
  Span span;
  std::variant<Id<Grid>, Id<Function>> source;
  Placement placement = Placement::single;
  Transform transform;
  Id<SeedList> seeds;                    ///< valid if seeded
  std::optional<glm::uvec3> index_size;  ///< a wish; never changes a result
  double offset = 0.0;                   ///< the iso-value: inside is f <= offset
};

struct Object;

struct Embedded {
  Id<Object> object;
  Span span;
  Placement placement = Placement::single;
  Transform transform;
  Id<SeedList> seeds;  ///< valid if seeded
};

/// The placed lookup box of an INDEX element: a point outside it asks none of the candidates inside.
struct IndexBox {
  glm::uvec3 size{1};
  Transform transform;
};

/// A run of EMBEDDED elements: those of one INDEX, or those that stand directly in the region between two INDEXes.
struct EmbeddingGroup {
  std::optional<IndexBox> index;
  std::vector<Embedded> embedded;
};

enum class RegionKind : std::uint8_t { color, bitmap, empty };

struct Region {
  std::string name;
  Span span;
  Id<Object> object;  ///< that defines it
  RegionKind kind = RegionKind::empty;
  glm::dvec3 rgb{0.0};  ///< color: 0..1, sRGB as shown
  Id<Bitmap> bitmap;    ///< bitmap
  Transform transform;  ///< of the bitmap
  double opacity = 1.0;
  std::vector<EmbeddingGroup> groups;  ///< document order
};

struct Node;

/// f(p) > offset (or NaN) goes to positive, otherwise to negative.
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
  Span span;
  Id<Node> root;  ///< always valid in a scene without errors; the shorthand without MAPPINGS is expanded
};

/// A whole document with its imports. Objects, SDFs and regions in document order (imports at their place).
struct Scene {
  std::string path;
  Id<Object> root;
  std::vector<Object> objects;
  std::vector<Sdf> sdfs;
  std::vector<Region> regions;
  std::vector<Node> nodes;
  // Assets: each file read once. Those that nothing reachable from the root refers to are not opened: they stand here
  // with their path and no values.
  std::vector<Grid> grids;
  std::vector<Bitmap> bitmaps;
  std::vector<SeedList> seed_lists;
  std::vector<Function> functions;
};

struct ReadOptions {
  std::string root;              ///< name of the root object; empty: the last OBJECT of the document
  bool load_everything = false;  ///< also open files that nothing reachable from the root needs (`dmvv check`)
};

/// Reads and checks a scene with everything it needs.
///
/// Errors: all mistakes found are reported together; the result is empty if any is an error.
/// Limits: files of at most 4 GiB, trees at most 4096 deep, 2^20 elements, 2^24 seeds in all.
/// Cost: linear in the size of the files; each file is opened once.
/// Source: spec/voml.md.
std::optional<Scene> read_scene(const std::string& path, const ReadFile& files, const ReadOptions& options,
                                Diagnostics& diagnostics);

}  // namespace dmvv::voml
