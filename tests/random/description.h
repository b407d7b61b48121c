// A scene as plain values: what the generator makes, the shrinker makes smaller and the printer turns into VOML.
//
//   seed --generate--> Scene --print--> VOML and the files it names
//                        |  ^
//                        shrink, while the fault remains
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "voml/scene.h"

namespace dmvv::tests::random_scenes {

using voml::Placement;
using voml::RegionKind;
using voml::Transform;

/// A distance grid: samples of a shape, scaled by `gain`, with `noise` times random numbers on top.
struct Grid {
  enum class Shape : std::uint8_t { plane, ball, box, torus, waves, constant };
  Shape shape = Shape::ball;
  glm::uvec3 size{4};
  glm::dvec3 box_lo{0.0}, box_hi{1.0};  ///< of the unit cube, as in the file
  glm::dvec3 center{0.0};
  double radius = 0.6;
  double gain = 1.0;
  double noise = 0.0;
  std::uint64_t noise_seed = 0;
  friend bool operator==(const Grid&, const Grid&) = default;
};

/// GLSL; may call what the object's `helpers` or, by names that begin with `shared_`, those of the document define.
struct Function {
  std::string body;
  friend bool operator==(const Function&, const Function&) = default;
};

struct Seeds {
  std::vector<voml::Seed> lines;
  bool rotates = false, scales = false;  ///< whether there are files for them
};

struct Sdf {
  std::variant<Grid, Function> source;
  Placement placement = Placement::single;
  Transform transform;
  Seeds seeds;  ///< if seeded
  std::optional<glm::uvec3> index;
  double offset = 0.0;
};

struct Embedded {
  std::uint32_t object;  ///< index, larger than that of the object it stands in
  Placement placement = Placement::single;
  Transform transform;
  Seeds seeds;
};

struct Group {
  std::optional<voml::IndexBox> index;
  std::vector<Embedded> embedded;
};

/// n^3 texels made from a seed.
struct Bitmap {
  std::uint32_t n = 1;
  bool alpha = false;
  std::uint64_t seed = 0;
};

struct Region {
  RegionKind kind = RegionKind::color;
  glm::dvec3 rgb{0.0};
  double opacity = 1.0;
  Bitmap bitmap;
  Transform transform;  ///< of the bitmap
  std::vector<Group> groups;
};

/// An SDF or region of an object, its own or another's.
struct Reference {
  std::uint32_t object = 0;
  std::uint32_t index = 0;
};

/// A region if there are no sides; else an SDF with its positive and negative side.
struct Tree {
  Reference what;
  std::vector<Tree> sides;
};

struct Object {
  std::string helpers;  ///< text of its FUNCTIONS
  std::vector<Sdf> sdfs;
  std::vector<Region> regions;
  Tree tree;
  bool shorthand = false;  ///< written without MAPPINGS: one region, at most one SDF; the tree is implied
  bool imported = false;   ///< stands in a file of its own folder that the scene imports
};

/// How the same scene may be written in different ways.
struct Style {
  bool upper_case = true;           ///< of element and attribute names
  bool commas = false;              ///< between the numbers of a vector
  bool inline_definitions = false;  ///< SDFs and regions are defined where MAPPINGS first uses them
  bool short_sides = false;         ///< <POSITIVE region="..."/>
  bool cdata = true;                ///< around GLSL; else &lt; and &amp;
};

/// Objects embed only those behind them; the first is the root.
struct Scene {
  std::vector<Object> objects;
  Style style;
};

/// A scene drawn from a seed; the same on every machine. `snippets`: bodies and helpers to choose analytic SDFs from.
struct NamedSnippet {
  std::string name;
  Function function;
  std::string helpers;
};
Scene generate(std::uint64_t seed, const std::vector<NamedSnippet>& snippets);

/// The files of a scene by path; the document is "scene.voml".
std::map<std::string, std::string> print(const Scene& scene);

// The files' contents.
std::string lxn_bytes(const Grid& grid);
std::string bitmap_bytes(const Bitmap& bitmap);
/// What any analytic SDF may call; part of a document only if one does.
std::string shared_helpers();

/// The corpus of tests/snippets.
std::vector<NamedSnippet> read_snippets(const std::string& folder);

}  // namespace dmvv::tests::random_scenes
