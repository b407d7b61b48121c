// Private to authoring/molecule*.cpp: what the names of residues and atoms tell where a file says no more.
#pragma once

#include <string_view>

namespace dmvv::authoring {

/// Whether a residue is water, by any name that archives and programs of molecular dynamics give it. Of a name of four
/// characters, here and below, the last may belong to the chain.
bool is_water(std::string_view residue);

/// Where an atom's name stands in its four columns.
enum class NameAlignment {
  columns,  ///< as PDB has it: the element right-justified in the first two
  left,     ///< from the first column on; so are names that have no columns
};

/// The symbol of an atom's element after its name, in the case of the name; it may be of no element. Empty: none.
///
/// `name` is the four columns of PDB as they stand, or a name without columns. An ion is named like its residue; amino
/// acids and nucleotides hold H, C, N, O, P and S alone, and Se where its name begins so. For others the alignment
/// counts: of a name at the left, two letters are an element only if the first of them is not one of these six, or
/// the two are CL.
/// Source: PDB format 3.3, section ATOM; the residues' names of the wwPDB, AMBER, CHARMM and GROMACS.
std::string_view element_of_name(std::string_view name, std::string_view residue, NameAlignment alignment);

}  // namespace dmvv::authoring
