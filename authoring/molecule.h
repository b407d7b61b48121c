// Molecules: the atoms of PDB and mmCIF files, and what is drawn of them.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"

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
  std::uint32_t chain = 0;  ///< index into Molecule::chains
};

struct MoleculeOptions {
  bool keep_water = false;  ///< residues that are water by any usual name: HOH, WAT, TIP3, SOL, ...
  bool assemblies = false;  ///< read them too
};

/// p -> rotation * p + translation, in angstrom; the rotation is proper and orthogonal.
struct Operator {
  glm::dmat3 rotation{1.0};
  glm::dvec3 translation{0.0};
};

/// The atoms of some chains stand once an operator.
struct AssemblyPart {
  std::vector<std::string> chains;  ///< sorted
  std::vector<Operator> operators;
};

struct Assembly {
  std::string id;
  std::vector<AssemblyPart> parts;
};

/// More operators of one assembly are refused.
inline constexpr std::size_t max_operators = 1u << 20;

/// The atoms to draw, in file order, and how many the file has beside them.
struct Molecule {
  std::vector<Atom> atoms;
  std::vector<std::string> chains;     ///< mmCIF: label_asym_id, of which assemblies speak
  std::vector<Assembly> assemblies;    ///< in file order; empty unless asked for
  std::size_t repaired_operators = 0;  ///< off by more than six decimals explain
  std::size_t waters = 0;              ///< atoms of water left out
  std::size_t alternates = 0;          ///< atoms left out because their residue has an earlier alternate location
  std::size_t other_models = 0;        ///< atoms of models behind the first
  std::size_t unknown_elements = 0;    ///< atoms left out because their element is not known
};

/// Reads the atoms of a PDB file (columns of format 3.3) or an mmCIF file (CIF 1.1, the first block with _atom_site).
///
/// The format follows from the content: an mmCIF file begins with data_, loop_ or a name, behind comments. A byte order
/// mark and any line ends are read over. Of several models the first counts, of a residue's alternate locations the one
/// named first; atoms without one always count. An atom without an element (PDB: columns 77-78) has that of its name,
/// by its residue or the name's columns.
/// Errors: E0560 what breaks the rules of the format, E0562 no atom that is to be drawn; E0563 an assembly that breaks
/// the rules, E0567 an operator that is no rotation; then the result is empty. Faults of single atoms are reported
/// together, others end the reading. Warning: W0580 how many atoms were left out because their elements are not known.
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

/// The atoms of one part of an assembly.
std::vector<Atom> atoms_of(const Molecule& molecule, const AssemblyPart& part);

/// An OBJECT that draws atoms: a seeded ball for each element, in its colour, as files `stem`_C.txt and so on.
std::string molecule_object(const std::string& name, std::span<const ElementSeeds> elements, const std::string& stem);

/// A scene that draws the molecule: a seeded ball for each element, in its colour, as files `stem`_C.txt and so on.
/// `source` names the molecule's file in a comment.
std::string molecule_scene(std::span<const ElementSeeds> elements, const std::string& stem, std::string_view source);

}  // namespace dmvv::authoring
