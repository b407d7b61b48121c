#include "authoring/atom_names.h"

#include <algorithm>
#include <array>

#include "authoring/molecule.h"
#include "base/text.h"

namespace dmvv::authoring {
namespace {

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

bool is_any_of(std::string_view word, auto& list) {
  const auto has = [&](std::string_view w) {
    return std::ranges::any_of(list, [&](std::string_view other) { return same_word(w, other); });
  };
  return has(word) || (word.size() == 4 && has(word.substr(0, 3)));
}

constexpr std::array waters = std::to_array<std::string_view>(
    {"HOH",  "DOD",  "WAT",  "H2O",  "D2O",  "HHO", "OHH",  "HH0",   "OH2",   "SOL",  "WATER", "TIP",
     "TIP2", "TIP3", "TIP4", "TIP5", "TP3",  "TP4", "TP5",  "T3P",   "T4P",   "T5P",  "T3H",   "TIPS",
     "SPC",  "SPCE", "SPE",  "OPC",  "OPC3", "ST2", "TP3M", "TIP3P", "TIP4P", "TIP5P"});

/// Amino acids, their protonation states in force fields, and what caps a chain.
constexpr std::array amino_acids = std::to_array<std::string_view>(
    {"ALA", "ARG", "ASN", "ASP", "ASX", "CYS", "GLN", "GLU", "GLX", "GLY", "HIS", "ILE", "LEU", "LYS", "MET",
     "PHE", "PRO", "SER", "THR", "TRP", "TYR", "VAL", "UNK", "MSE", "SEC", "PYL", "HYP", "HID", "HIE", "HIP",
     "HSD", "HSE", "HSP", "CYX", "CYM", "ASH", "GLH", "LYN", "LYP", "TYM", "ACE", "NME", "NMA", "NH2"});
/// With D before the deoxy ones, R before the others, and 3, 5 or N behind those that end a strand.
constexpr std::array nucleotides =
    std::to_array<std::string_view>({"A", "C", "G", "T", "U", "I", "N", "ADE", "CYT", "GUA", "THY", "URA"});

bool is_amino_acid(std::string_view residue) {
  const bool may_end_chain = residue.size() == 4 && (residue[0] == 'N' || residue[0] == 'C');  // NALA, CALA of AMBER
  return is_any_of(residue, amino_acids) || (may_end_chain && is_any_of(residue.substr(1), amino_acids));
}

bool is_nucleotide(std::string_view residue) {
  if (is_any_of(residue, nucleotides)) return true;
  if (residue.size() > 1 && (residue.ends_with('3') || residue.ends_with('5') || residue.ends_with('N')))
    residue.remove_suffix(1);
  if (residue.size() > 1 && (residue.starts_with('D') || residue.starts_with('R') || residue.starts_with('+')))
    residue.remove_prefix(1);
  return is_any_of(residue, nucleotides);
}

/// What CHARMM calls ions, where the name is not the symbol.
struct Ion {
  std::string_view name, symbol;
};
constexpr std::array ions = std::to_array<Ion>({{"SOD", "Na"},
                                                {"POT", "K"},
                                                {"CLA", "Cl"},
                                                {"CAL", "Ca"},
                                                {"CES", "Cs"},
                                                {"LIT", "Li"},
                                                {"RUB", "Rb"},
                                                {"CAD", "Cd"},
                                                {"BAR", "Ba"}});

/// A name without the charge or number behind it: "NA+", "FE2"
std::string_view letters_of(std::string_view name) {
  return name.substr(0, static_cast<std::size_t>(std::ranges::find_if_not(name, is_letter) - name.begin()));
}

/// The symbol of an ion that is its residue's only atom; empty if the two are not named alike.
std::string_view element_of_ion(std::string_view name, std::string_view residue) {
  const std::string_view letters = letters_of(name);
  const std::string_view three = residue.substr(0, residue.size() == 4 ? 3 : residue.size());
  if (letters.empty() || (!same_word(letters, letters_of(residue)) && !same_word(letters, letters_of(three))))
    return {};
  const auto ion = std::ranges::find_if(ions, [&](const Ion& i) { return same_word(i.name, letters); });
  if (ion != ions.end()) return ion->symbol;
  return find_element(letters) ? letters : std::string_view{};
}

bool is_of_life(char letter) { return std::string_view("HCNOPSDhcnopsd").find(letter) != std::string_view::npos; }

/// The element of a name that no column tells.
std::string_view element_at_left(std::string_view name) {
  const std::string_view letters = letters_of(name);
  const bool two =
      letters.size() == 2 && find_element(letters) && (!is_of_life(letters[0]) || same_word(letters, "CL"));
  return letters.substr(0, two ? 2 : 1);
}

}  // namespace

bool is_water(std::string_view residue) { return is_any_of(residue, waters); }

std::string_view element_of_name(std::string_view columns, std::string_view residue, NameAlignment alignment) {
  const std::string_view name = trim(columns);
  const auto first = std::ranges::find_if(name, is_letter);
  const std::string_view from_letter = name.substr(static_cast<std::size_t>(first - name.begin()));  // "2HB" -> "HB"
  if (from_letter.empty()) return {};
  if (const std::string_view ion = element_of_ion(name, residue); !ion.empty()) return ion;
  if (is_amino_acid(residue) || is_nucleotide(residue))
    return from_letter.substr(0, same_word(from_letter.substr(0, 2), "SE") ? 2 : 1);
  if (alignment == NameAlignment::left || !is_letter(name[0])) return element_at_left(from_letter);
  if (columns[0] != name[0]) return name.substr(0, 1);                                // in the second column
  const bool long_hydrogen = name.size() == 4 && (name[0] == 'H' || name[0] == 'D');  // HG11
  return name.substr(0, !long_hydrogen && find_element(name.substr(0, 2)) ? 2 : 1);
}

}  // namespace dmvv::authoring
