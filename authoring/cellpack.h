// cellPACK results: ingredients, each a bead model and a list of placements.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "authoring/placements.h"
#include "voml/diagnostics.h"

namespace dmvv::authoring {

struct Bead {
  glm::dvec3 position;  ///< angstrom
  double radius;
};

struct Ingredient {
  std::string name;
  std::vector<Bead> beads;  ///< of the first level of detail
  std::vector<Placement> placements;
};

struct Packing {
  std::vector<Ingredient> ingredients;  ///< in the order of the file; without those that stand nowhere
  std::size_t repaired = 0;
  double worst = 0.0;
};

/// Reads a result of cellPACK (JSON): every object with `results`, a list of [[x, y, z], [w, x, y, z]], `positions`
/// and `radii`, wherever it stands; its name is that of its key. world = R(q) * local + position.
/// Errors: E0568, at its place in the text or with the ingredient's name; E0567. Then the result is empty.
/// Source: Johnson et al. 2015, "cellPACK: a virtual mesoscope to model and visualize structural systems biology".
std::optional<Packing> parse_cellpack(const std::string& path, std::string_view bytes, Diagnostics& diagnostics);

/// The frame in which all beads of an ingredient fill the cube up to 5 %; and one for all copies.
MoleculeFrame fit_beads(const Ingredient& ingredient);
MoleculeFrame fit_packing(const Packing& packing);

/// Seeds and scales of the beads in their frame, and the OBJECT that draws them from `stem`_bead.txt.
PlacementFiles bead_files(const Ingredient& ingredient, const MoleculeFrame& frame);
std::string bead_object(const std::string& name, const std::string& rgb, const std::string& stem);

}  // namespace dmvv::authoring
