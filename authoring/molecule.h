// Molecules: the atoms of PDB and mmCIF files, and what is drawn of them.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "voml/diagnostics.h"

namespace dmvv::authoring {

struct Element {
  std::string_view symbol;  ///< "C", "Fe"
  double radius;            ///< van der Waals, in angstrom
  std::uint32_t rgb;        ///< 0xRRGGBB, sRGB
};

/// All elements that are known, by atomic number.
///
/// Sources: radii of nonmetals from Bondi 1964, "van der Waals Volumes and Radii"; of all others, for which Bondi gives
/// none or a few contacts only, from Alvarez 2013, "A cartography of the van der Waals territories". Colours after
/// Corey and Pauling 1953 and Koltun 1965 (CPK) as the program Jmol extends them to all elements.
std::span<const Element> elements();

/// The element of a symbol in any case; deuterium (D) is hydrogen. Null if there is none.
const Element* find_element(std::string_view symbol);

struct Atom {
  glm::dvec3 position;  ///< angstrom, as in the file
  const Element* element;
};

struct MoleculeOptions {
  bool keep_water = false;  ///< residues HOH, DOD and WAT
};

/// The atoms to draw, in file order, and how many the file has beside them.
struct Molecule {
  std::vector<Atom> atoms;
  std::size_t waters = 0;        ///< atoms of water left out
  std::size_t alternates = 0;    ///< atoms left out because their residue has an earlier alternate location
  std::size_t other_models = 0;  ///< atoms of models behind the first
};

/// Reads the atoms of a PDB file (columns of format 3.3) or an mmCIF file (CIF 1.1, the first block with _atom_site).
///
/// The format follows from the content: an mmCIF file begins with data_, behind comments. Of several models the first
/// counts, of a residue's alternate locations the one named first; atoms without one always count. A PDB atom without
/// an element (columns 77-78) has that of its name (columns 13-14).
/// Errors: E0560 what breaks the rules of the format, E0561 an element that is not known, E0562 no atom that is to be
/// drawn; then the result is empty. Faults of single atoms are reported together, others end the reading.
/// Cost: linear in the file; the diagnostics keep a copy of it.
std::optional<Molecule> parse_molecule(const std::string& path, std::string_view bytes, const MoleculeOptions& options,
                                       Diagnostics& diagnostics);

/// From angstrom to the standard cube: (p - center) / angstrom_per_unit.
struct MoleculeFrame {
  glm::dvec3 center;
  double angstrom_per_unit;
};

/// The frame in which all van der Waals balls fill the standard cube up to a margin of 5 % along the longest side.
/// In: at least one atom.
MoleculeFrame fit_molecule(std::span<const Atom> atoms);

/// Radius of an atom's ball in the local cube of its seed: it leaves room for a ball that moves.
inline constexpr double local_ball_radius = 0.9;

/// What stands in the files of one element (spec/voml.md, Seeds), in file order of the atoms.
struct ElementSeeds {
  const Element* element;
  std::size_t count;
  std::string seeds;   ///< positions in fractions of the cube's edge
  std::string scales;  ///< each so that local_ball_radius is the van der Waals radius
};

/// By element, the rarest first; equally many by atomic number. Where balls overlap and the first wins, the few oxygens
/// and metals are then whole.
std::vector<ElementSeeds> element_seeds(std::span<const Atom> atoms, const MoleculeFrame& frame);

/// A scene that draws the molecule: a seeded ball for each element, in its colour, as files `stem`_C.txt and so on.
/// `source` names the molecule's file in a comment.
std::string molecule_scene(std::span<const ElementSeeds> elements, const std::string& stem, std::string_view source);

}  // namespace dmvv::authoring
