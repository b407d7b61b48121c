// cellPACK results: ingredients, each a bead model and a list of placements.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "authoring/placement_table.h"
#include "authoring/placements.h"
#include "base/diagnostics.h"

namespace dmvv::authoring {

struct Bead {
  glm::dvec3 position;  ///< angstrom
  double radius;
};

struct Ingredient {
  std::string name;
  std::string place;        ///< the keys above it: "compartments/HIV1_envelope/surface/ingredients"
  std::vector<Bead> beads;  ///< of the first level of detail
  std::vector<Placement> placements;
};

struct Packing {
  std::vector<Ingredient> ingredients;  ///< in the order of the file; without those that stand nowhere
  std::size_t repaired = 0;
  double worst = 0.0;
  std::size_t without_beads = 0;  ///< ingredients that are one ball, because the file has no beads of them
  std::size_t real_last = 0;      ///< placements whose quaternion was read as x y z w
  std::size_t fibres = 0;         ///< ingredients that are curves, which are left out
};

/// The radius of an ingredient's beads, or of the ball it is without beads, where the file tells none; 0: none.
using RadiusOf = std::function<double(const std::string& ingredient)>;

/// Reads a result of cellPACK (JSON) in any of its published layouts (spec/seeds.md): every object with `results`, a
/// list of [position, rotation], wherever it stands; its name is that of its key. world = R * local + position. Errors:
/// E0568 and E0567 at the value that is at fault. Then the result is empty. Cost: linear in the file; a fault is looked
/// up in the text. Source: Johnson et al. 2015, "cellPACK: a virtual mesoscope to model and visualize structural
/// systems biology".
std::optional<Packing> parse_cellpack(const std::string& path, std::string_view bytes, const RadiusOf& radius_of,
                                      Diagnostics& diagnostics);

/// The radius of a bead that has none, as a share of the median distance from a bead to the nearest of its kind: balls
/// on a cubic lattice then leave no gap (half the root of 3; in files that tell radii it is 0.6 to 1). For kinds of one
/// bead the median of all others' distances counts; without any, the radius is 1.
inline constexpr double bead_spacing_share = 0.866;

/// What a table of placements and a table of beads say together: each kind of the first has the beads of that kind in
/// the second, whose scales are radii. `radius`, if not 0, is that of all beads of a table without.
struct JoinedTables {
  Packing packing;
  std::size_t beads_unused = 0;  ///< kinds with beads that stand nowhere
  bool chose_radii = false;
};
/// Errors: E0566 kinds that are placed but have no bead (at `beads_path`). Then the result is empty.
/// Cost: n log n, and per kind some n distances.
std::optional<JoinedTables> join_tables(const PlacementTable& placements, const PlacementTable& beads,
                                        const std::string& beads_path, double radius, Diagnostics& diagnostics);

/// The median distance from a point to its nearest neighbour; at least two points, none of them twice unless all are.
/// Asks every so many-th point where there are more than 2,000. Cost: n log n.
double median_spacing(std::span<const glm::dvec3> points);

/// The frame in which all beads of an ingredient fill the cube up to 5 %; and one for all copies.
MoleculeFrame fit_beads(const Ingredient& ingredient);
MoleculeFrame fit_packing(const Packing& packing);

/// Seeds and scales of the beads in their frame, and the OBJECT that draws them from `stem`_bead.txt.
PlacementFiles bead_files(const Ingredient& ingredient, const MoleculeFrame& frame);
std::string bead_object(const std::string& name, const std::string& rgb, const std::string& stem);

/// Ingredients of more beads are not blended: each evaluation asks all beads of a blob.
inline constexpr std::size_t max_blended_beads = 128;

/// The frame of a blob: its beads fill the cube but for what the blend adds, and for `reach` (angstrom) of motion.
MoleculeFrame fit_blob(const Ingredient& ingredient, double reach);

/// `float blob(vec3 p)`: the body of a function that blends the beads smoothly; at a bead alone it is the distance.
/// `before` are statements that may change p. In: at most max_blended_beads. Source: smooth minimum by exponentials,
/// spec/snippets.md.
std::string blob_function(const Ingredient& ingredient, const MoleculeFrame& frame, const std::string& before);

/// The OBJECT of a blob; it needs no files.
std::string blob_object(const std::string& name, const std::string& rgb, const std::string& function);

}  // namespace dmvv::authoring
