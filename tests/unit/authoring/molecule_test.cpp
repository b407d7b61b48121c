// Molecules: PDB columns and mmCIF syntax as their formats say, and the seeds made of atoms.
#include "authoring/molecule.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <glm/geometric.hpp>
#include <map>
#include <set>

#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::authoring;

namespace {

/// A record of the format's widths: name, alternate, residue, chain, number and insertion code as they stand in columns
/// 13-27.
std::string atom(std::string_view columns_13_to_27, const glm::dvec3& p, std::string_view element,
                 std::string_view record = "ATOM") {
  const std::string head = fmt::format("{:<6}{:>5} {:<15}   {:8.3f}{:8.3f}{:8.3f}{:6.2f}{:6.2f}", record, 1,
                                       columns_13_to_27, p.x, p.y, p.z, 1.0, 20.0);
  REQUIRE(head.size() == 66);
  return element.empty() ? head + '\n' : fmt::format("{:<76}{:>2}\n", head, element);
}

struct Reading {
  std::optional<Molecule> molecule;
  std::string messages;
};

Reading read(std::string_view text, bool keep_water = false) {
  Diagnostics diagnostics;
  Reading result;
  result.molecule = parse_molecule("m", text, {keep_water}, diagnostics);
  result.messages = diagnostics.render();
  return result;
}

/// The symbols of the atoms, in order.
std::string symbols(const Reading& reading) {
  REQUIRE_MESSAGE(reading.molecule, reading.messages);
  std::string text;
  for (const Atom& a : reading.molecule->atoms)
    text += std::string(text.empty() ? "" : " ") + std::string(a.element->symbol);
  return text;
}

void check_refused(std::string_view text, std::string_view place_and_code) {
  const Reading reading = read(text);
  CHECK_FALSE(reading.molecule);
  CHECK_MESSAGE(reading.messages.starts_with(place_and_code), reading.messages);
}

const char* const columns_of_cif =
    "loop_\n_atom_site.group_PDB\n_atom_site.type_symbol\n_atom_site.label_alt_id\n_atom_site.auth_comp_id\n"
    "_atom_site.auth_asym_id\n_atom_site.auth_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
    "_atom_site.pdbx_PDB_model_num\n";

std::string cif(std::string_view rows) { return std::string("data_M\n") + columns_of_cif + std::string(rows); }

}  // namespace

TEST_CASE("elements: known symbols once each, radii of the sources, any case") {
  std::set<std::string_view> seen;
  for (const Element& element : elements()) {
    CHECK(seen.insert(element.symbol).second);
    CHECK(find_element(element.symbol) == &element);
    CHECK(element.radius >= 1.2);  // hydrogen is the smallest, caesium the largest
    CHECK(element.radius <= 3.48);
    CHECK(element.rgb <= 0xffffff);
  }
  CHECK(find_element("C")->radius == 1.70);  // Bondi 1964
  CHECK(find_element("o")->radius == 1.52);
  CHECK(find_element("FE")->radius == 2.44);  // Alvarez 2013
  CHECK(find_element("D") == find_element("H"));
  CHECK(find_element("Xx") == nullptr);
  CHECK(find_element("") == nullptr);
}

TEST_CASE("PDB: coordinates stand in columns 31-54, also where numbers touch") {
  const Reading reading = read(atom(" N   THR A   1 ", {17.047, 14.099, 3.625}, "N") +
                               atom("FE   HEM A 142 ", {-999.125, -888.25, -777.5}, "FE", "HETATM") + "END\n");
  CHECK(symbols(reading) == "N Fe");
  CHECK(reading.molecule->atoms[0].position == glm::dvec3(17.047, 14.099, 3.625));
  CHECK(reading.molecule->atoms[1].position == glm::dvec3(-999.125, -888.25, -777.5));
  CHECK(symbols(read("ATOM      1  N   THR A   1      17.047  14.099   3.625")) == "N");  // ends at column 54
}

TEST_CASE("PDB: an atom without an element has that of its name's columns") {
  CHECK(symbols(read(atom(" CA  GLY A   1 ", {}, ""))) == "C");
  CHECK(symbols(read(atom("CA    CA A   1 ", {}, ""))) == "Ca");
  CHECK(symbols(read(atom("HG11 VAL A   1 ", {}, ""))) == "H");  // no mercury
  CHECK(symbols(read(atom("HG    HG A   1 ", {}, ""))) == "Hg");
  CHECK(symbols(read(atom("1HB  ALA A   1 ", {}, ""))) == "H");
  // Before 1996 columns 73-80 held the entry and the line's number.
  std::string old = atom(" N   THR A   1 ", {}, "");
  old.insert(old.size() - 1, "      1CRN 170");
  CHECK(symbols(read(old)) == "N");
}

TEST_CASE("PDB: water, alternate locations and further models are left out and counted") {
  const std::string text = "MODEL        1\n" + atom(" N   THR A   1 ", {}, "N") +
                           atom(" CA BTHR A   1 ", {1, 0, 0}, "C") + atom(" CA ATHR A   1 ", {2, 0, 0}, "C") +
                           atom(" CB ASER A   1 ", {3, 0, 0}, "C") + atom(" CB BTHR A   1 ", {4, 0, 0}, "C") +
                           atom(" CA AGLY A   1A", {5, 0, 0}, "C") + atom(" O   HOH A 201 ", {}, "O", "HETATM") +
                           "ENDMDL\nMODEL        2\n" + atom(" S   CYS A   1 ", {}, "S") + "ENDMDL\n";
  const Reading reading = read(text);
  // B was named first in residue 1, for all its atoms; residue 1A is another.
  CHECK(symbols(reading) == "N C C C");
  CHECK(reading.molecule->atoms[1].position.x == 1);
  CHECK(reading.molecule->atoms[2].position.x == 4);
  CHECK(reading.molecule->atoms[3].position.x == 5);
  CHECK(reading.molecule->waters == 1);
  CHECK(reading.molecule->alternates == 2);
  CHECK(reading.molecule->other_models == 1);
  CHECK(symbols(read(text, true)) == "N C C C O");
}

TEST_CASE("PDB: faults stand at their line and column, all of them") {
  const std::string good = atom(" N   THR A   1 ", {1, 2, 3}, "N");
  std::string bad_y = good, bad_x = good;
  bad_y.replace(38, 8, "  14.o99");
  bad_x.replace(30, 8, "  12,000");
  const Reading reading = read(good + bad_y + bad_x);
  CHECK_FALSE(reading.molecule);
  CHECK_MESSAGE(reading.messages.find("m:2:39: error[E0560]") != std::string::npos, reading.messages);
  CHECK_MESSAGE(
      reading.messages.find("m:3:31: error[E0560]: the coordinate x is '  12,000', not a finite number; write "
                            "12.000, with a point") != std::string::npos,
      reading.messages);
  check_refused(good + "ATOM      2  CA  THR A   1      17.047\r\n",
                "m:2:1: error[E0560]: the record ends at column 38");
  check_refused("ATOM\t1\n" + good, "m:1:5: error[E0560]: a tab");
  check_refused("ATOM  \t1" + good, "m:1:7: error[E0560]: a tab");
}

TEST_CASE("no atoms: said so, with what was looked for") {
  check_refused("", "m: error[E0562]: no atoms");
  check_refused("HEADER    EMPTY\n", "m:1:1: error[E0562]");
  check_refused("data_EMPTY\n_cell.length_a 1\n", "m:1:1: error[E0562]");
  check_refused(atom(" O   HOH A 201 ", {}, "O"), "m:1:1: error[E0562]: all 1 atoms are water");
  check_refused("\x1f\x8b\x08", "m: error[E0560]: the file is compressed");
}

TEST_CASE("mmCIF: columns by name, in any order and case, among quotes, comments and text") {
  const Reading reading = read(
      "# made by hand\ndata_M\n_struct.title 'it''s not the end' _a.b \"x y\"\n"
      "_text.one\n;loop_\n_atom_site.Cartn_x ; no\n;\n"
      "LOOP_ _ATOM_SITE.CARTN_Z _atom_site.Cartn_x # here\n _atom_site.type_symbol _atom_site.Cartn_y _atom_site.note\n"
      "3.5 1.5(2) N 2.5 'a b'  -3e0\n-1 FE -2 ;x;\n6 4 'C' 5\n;two\nlines\n;\n#\nloop_ _other.a 1 2 3\n");
  CHECK(symbols(reading) == "N Fe C");
  CHECK(reading.molecule->atoms[0].position == glm::dvec3(1.5, 2.5, 3.5));
  CHECK(reading.molecule->atoms[1].position == glm::dvec3(-1, -2, -3));
  CHECK(reading.molecule->atoms[2].position == glm::dvec3(4, 5, 6));
}

TEST_CASE("mmCIF: an atom outside loops, the first block that has any") {
  const Reading reading = read(
      "data_A _cell.length_a 3\ndata_B _atom_site.Cartn_x 1 _atom_site.Cartn_y 2 _atom_site.Cartn_z 3\n"
      "_atom_site.type_symbol O\n data_C _atom_site.Cartn_x 9\n");
  CHECK(symbols(reading) == "O");
  CHECK(reading.molecule->atoms[0].position == glm::dvec3(1, 2, 3));
}

TEST_CASE("mmCIF: water, alternate locations and further models") {
  const Reading reading =
      read(cif("ATOM C B THR A 1 1 0 0 1\nATOM C A THR A 1 2 0 0 1\nATOM N . THR A 1 3 0 0 1\n"
               "ATOM C A THR B 1 4 0 0 1\nHETATM O . HOH A 9 5 0 0 1\nATOM S . CYS A 2 6 0 0 2\n"));
  CHECK(symbols(reading) == "C N C");
  CHECK(reading.molecule->atoms[0].position.x == 1);
  CHECK(reading.molecule->waters == 1);
  CHECK(reading.molecule->alternates == 1);
  CHECK(reading.molecule->other_models == 1);
}

TEST_CASE("mmCIF: faults stand at their line and column") {
  check_refused(cif("ATOM C . THR A 1 1 0 0 1\nATOM C . THR A 1 2 0\n"),
                "m:14:1: error[E0560]: the last row of the loop has 8 values, its names are 10");
  check_refused(cif("ATOM C . THR A 1 ? 0 0 1\n"), "m:13:18: error[E0560]: the coordinate x is '?'");
  check_refused(cif("ATOM C . THR A 1 1 0 12.3(x) 1\n"), "m:13:22: error[E0560]: the coordinate z is '12.3(x)'");
  check_refused("data_M loop_ _atom_site.Cartn_x _atom_site.Cartn_y _atom_site.Cartn_z _atom_site.cartn_x 1 2 3 4",
                "m:1:14: error[E0560]: the atoms have _atom_site.Cartn_x twice");
  check_refused("data_M loop_ _atom_site.Cartn_x _atom_site.Cartn_y 1 2",
                "m:1:14: error[E0560]: the atoms have no _atom_site.Cartn_z");
  check_refused("data_M _a.b 'open\n'", "m:1:13: error[E0560]: a quote");
  check_refused("data_M _a.b\n;open\n ;", "m:2:1: error[E0560]: the text that begins here");
  check_refused("data_M _a.b _c.d 1", "m:1:8: error[E0560]: '_a.b' has no value");
  check_refused("data_M loop_ 1", "m:1:8: error[E0560]: a loop without names");
  check_refused("data_M 1", "m:1:8: error[E0560]: a value without a name");
  check_refused("data_M save_x", "m:1:8: error[E0560]: 'save_x' has no meaning");
}

namespace {

std::string with_line_ends(std::string text, std::string_view end) {
  std::string result;
  for (const char c : text) result += c == '\n' ? std::string(end) : std::string(1, c);
  return result;
}

/// The symbol of an atom without an element, alone in its file; a name of four columns and a residue of three.
std::string symbol_of(std::string_view name, std::string_view residue) {
  return symbols(read(atom(fmt::format("{:<4} {:>3} A   1 ", name, residue), {}, "")));
}

}  // namespace

TEST_CASE("PDB and mmCIF: a byte order mark and any line ends; places stay exact") {
  // Two atoms, the first of which follows the mark: gemmi and Biopython read both.
  const std::string pdb =
      "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00 10.00           C\n"
      "ATOM      2  CA  ALA A   2       4.000   0.000   0.000  1.00 10.00           C\n";
  const std::string mmcif = "# a comment\n" + cif("ATOM C . THR A 1 0 0 0 1\nATOM C . THR A 2 4 0 0 1\n");
  for (const std::string& text : {pdb, mmcif}) {
    for (const char* const mark : {"", "\xef\xbb\xbf"}) {
      for (const char* const end : {"\n", "\r\n", "\r"}) {
        const Reading reading = read(mark + with_line_ends(text, end));
        CHECK(symbols(reading) == "C C");
        CHECK(reading.molecule->atoms[1].position.x == 4);
      }
    }
  }
  check_refused("\xef\xbb\xbf" + with_line_ends(pdb + "ATOM      3  CA\n", "\r"),
                "m:3:1: error[E0560]: the record ends at column 15");
  check_refused(with_line_ends(mmcif + "ATOM C . THR A 3 0 x 0 1\n", "\r"), "m:16:20: error[E0560]: the coordinate y");
  check_refused("\xff\xfe\x41", "m: error[E0560]: the file is UTF-16");
}

TEST_CASE("PDB: a MODEL record begins a model, whether the one before has ended or not") {
  const std::string ca = "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00 10.00           C\n";
  for (const std::string& text : {"MODEL        1\n" + ca + "MODEL        2\n" + ca,
                                  "MODEL        1\n" + ca + "ENDMDL\nMODEL        2\n" + ca + "ENDMDL\n",
                                  "model        1\n" + ca + "MODEL        2\n" + ca + "END\n",
                                  "MODEL        1\nENDMDL\nMODEL        2\n" + ca + "MODEL        3\n" + ca}) {
    const Reading reading = read(text);
    CHECK(symbols(reading) == "C");
    CHECK(reading.molecule->other_models == 1);
  }
  CHECK(symbols(read("MODEL        1\n" + ca + ca)) == "C C");  // no end at all
}

TEST_CASE("PDB: elements of names at the left, by residue: standard amino acids and nucleotides hold no metals") {
  // As prediction servers wrote it: no elements, names from column 13 on.
  CHECK(symbols(read("ATOM      1 N    LEU A   1       0.000   0.000   0.000  1.00 10.00\n"
                     "ATOM      2 CA   LEU A   1       2.000   0.000   0.000  1.00 10.00\n"
                     "ATOM      3 CD1  LEU A   1       4.000   0.000   0.000  1.00 10.00\n"
                     "ATOM      4 NE2  GLN A   2       6.000   0.000   0.000  1.00 10.00\n"
                     "ATOM      5 HG   SER A   3       8.000   0.000   0.000  1.00 10.00\n"
                     "ATOM      6 ND1  HIS A   4      10.000   0.000   0.000  1.00 10.00\n")) == "N C C N H N");
  for (const char* const residue : {"HIS", "HSD", "HIE", "CYX", "MSE", "ASX"}) CHECK(symbol_of("CD", residue) == "C");
  for (const char* const residue : {"A", "DA", "DA5", "RG", "ADE", "  U"}) CHECK(symbol_of("NE", residue) == "N");
  CHECK(symbol_of("SE", "MSE") == "Se");
  CHECK(symbol_of("HO5'", "DT") == "H");
  CHECK(symbol_of("OS", "SER") == "O");
  CHECK(symbols(read(atom("CA   NALAA   1 ", {}, ""))) == "C");  // residues of four letters: AMBER
}

TEST_CASE("PDB: ions are named like their residues; other residues by the columns, or as the file writes names") {
  CHECK(symbol_of("CA", "CA") == "Ca");
  CHECK(symbol_of(" ZN", "ZN") == "Zn");
  CHECK(symbol_of("NA+", "NA+") == "Na");
  CHECK(symbol_of("SOD", "SOD") == "Na");  // CHARMM
  CHECK(symbol_of("CLA", "CLA") == "Cl");
  CHECK(symbol_of("FE", "HEM") == "Fe");
  CHECK(symbol_of("CD", "LIG") == "Cd");
  const std::string at_left = atom("N    LIG A   1 ", {}, "");  // right-justified, it would stand in column 14
  const auto in_file = [&](std::string_view name) {
    return symbols(read(at_left + atom(fmt::format("{:<4} LIG A   1 ", name), {}, "")));
  };
  CHECK(in_file("CD") == "N C");
  CHECK(in_file("NA") == "N N");
  CHECK(in_file("CL1") == "N Cl");
  CHECK(in_file("FE") == "N Fe");
  CHECK(in_file("BR2") == "N Br");
}

TEST_CASE("PDB: digits before a hydrogen, wherever the name stands") {
  CHECK(symbols(read("ATOM      1  CB  ALA A   1       0.000   0.000   0.000  1.00 10.00\n"
                     "ATOM      2  2HB ALA A   1       1.000   0.000   0.000  1.00 10.00\n")) == "C H");
  for (const char* const name : {"1HB", " 1H", "2HB1", "3HG2", " 2HA", "1H5*", "''H"}) {
    CHECK(symbol_of(name, "ALA") == "H");
    CHECK(symbol_of(name, "LIG") == "H");
  }
  CHECK(symbol_of("1D", "ALA") == "H");  // deuterium
}

TEST_CASE("PDB: what stands in columns 77-78 and is no element") {
  const auto with_tail = [](std::string_view tail) {  // from column 67 on
    std::string text = atom(" OD1 ASP A   1 ", {}, "");
    return symbols(read(text.insert(text.size() - 1, tail)));
  };
  CHECK(with_tail("           N1-") == "N");  // a charge
  CHECK(with_tail("          n ") == "N");    // at the left
  CHECK(with_tail("      1ABC1234") == "O");  // before 1996
  CHECK(with_tail("    -0.648 NA") == "O");   // AutoDock: a charge, and a type in columns 78-79
}

TEST_CASE("elements that are not known: counted and named in one warning, the others drawn") {
  const std::string good = atom(" N   THR A   1 ", {1, 2, 3}, "N");
  const std::string x = atom(" DU  THR A   1 ", {}, "X"), qq = atom(" Q1  THR A   1 ", {}, "QQ");
  const Reading reading = read(good + x + qq + x);
  CHECK(symbols(reading) == "N");
  CHECK(reading.molecule->unknown_elements == 3);
  CHECK_MESSAGE(
      reading.messages.starts_with("m:2:78: warning[W0580]: 3 atoms, of which this is the first, are left out, "
                                   "because no such element is known: 'QQ' 1, 'X' 2"),
      reading.messages);
  CHECK(reading.messages.find("1 warning") != std::string::npos);
  const Reading other = read(cif("ATOM X . THR A 1 1 0 0 1\nATOM C . THR A 1 1 0 0 1\nATOM ? . THR A 1 1 0 0 1\n"));
  CHECK(symbols(other) == "C");
  CHECK_MESSAGE(other.messages.starts_with("m:13:6: warning[W0580]: 2 atoms, of which this is the first, are left out, "
                                           "because no such element is known: 'X' 1, not given 1"),
                other.messages);
  const Reading nameless = read(good + atom("     THR A   1 ", {}, ""));
  CHECK_MESSAGE(nameless.messages.starts_with("m:2:31: warning[W0580]: 1 atom is left out, because no such element is "
                                              "known: not given 1"),
                nameless.messages);
  check_refused(x + qq, "m:1:1: error[E0562]: no atom has an element that is known ('QQ' 1, 'X' 1)");
}

TEST_CASE("water by every usual name, alike in both formats") {
  for (const char* const name :
       {"HOH", "WAT", "H2O", "DOD", "TIP", "TIP3", "TP3", "TIP4", "SOL", "SPC", "T4P", "OH2"}) {
    const std::string water = atom(fmt::format(" OH2 {:<4}A   2 ", name), {}, ""),
                      point = atom(" MW  SOL A   2 ", {}, "");
    const std::string text = atom(" N   THR A   1 ", {}, "N") + water + point;
    const Reading pdb = read(text),
                  mmcif = read(cif(fmt::format("ATOM C . THR A 1 1 0 0 1\nATOM O . {} A 2 1 0 0 1\n", name)));
    CHECK(symbols(pdb) == "N");
    CHECK(pdb.molecule->waters == 2);  // the point without mass of a model of four points is water as well
    CHECK(symbols(mmcif) == "C");
    CHECK(mmcif.molecule->waters == 1);
    CHECK(symbols(read(text, true)) == "N O");
  }
  CHECK(read(atom(" O   WAX A   2 ", {}, "O")).molecule->waters == 0);
}

TEST_CASE("mmCIF: elements with charges, of names where the file has none; a file that begins without data_") {
  const Reading reading = read(
      "loop_ _atom_site.label_atom_id _atom_site.label_comp_id _atom_site.Cartn_x _atom_site.Cartn_y "
      "_atom_site.Cartn_z\n"
      "CA ALA 0 0 0 \"HO5'\" DA 0 0 0 CA CA 0 0 0 CL1 LIG 0 0 0 CD LIG 0 0 0\n");
  CHECK(symbols(reading) == "C H Ca Cl C");
  CHECK(symbols(read(cif("ATOM Fe3+ . HEM A 1 1 0 0 1\nATOM O2- . HEM A 1 1 0 0 1\nATOM 'C' . HEM A 1 1 0 0 ?\n"))) ==
        "Fe O C");
}

TEST_CASE("the balls fill the cube up to its margin, and seeds give every atom back") {
  const std::vector<Atom> atoms{{{10, 0, 0}, find_element("C")},
                                {{-2, 3, 1}, find_element("O")},
                                {{4, -1, 5}, find_element("C")},
                                {{0, 2, -6}, find_element("Fe")}};
  const MoleculeFrame frame = fit_molecule(atoms);
  // Along x, the longest side: from -2 - 1.52 to 10 + 1.70.
  CHECK(frame.angstrom_per_unit == doctest::Approx((11.7 + 3.52) / 2.0 / 0.95));
  CHECK(frame.center.x == doctest::Approx((11.7 - 3.52) / 2.0));

  const std::vector<ElementSeeds> by_element = element_seeds(atoms, frame);
  REQUIRE(by_element.size() == 3);
  CHECK(by_element[0].element->symbol == "O");  // one each: by atomic number
  CHECK(by_element[1].element->symbol == "Fe");
  CHECK(by_element[2].element->symbol == "C");
  CHECK(by_element[2].count == 2);

  std::map<std::string, std::string> files{{"m.voml", molecule_scene(by_element, "m", "a--b<c.pdb")}};
  for (const ElementSeeds& element : by_element) {
    files[fmt::format("m_{}.txt", element.element->symbol)] = element.seeds;
    files[fmt::format("m_{}_scale.txt", element.element->symbol)] = element.scales;
  }
  Diagnostics diagnostics(true);
  const auto scene = voml::read_scene("m.voml", memory_files(files), {}, diagnostics);
  REQUIRE_MESSAGE(scene, diagnostics.render());
  CHECK_MESSAGE(diagnostics.all().empty(), diagnostics.render());
  REQUIRE(scene->sdfs.size() == 3);
  for (const voml::Sdf& sdf : scene->sdfs) {
    std::size_t i = 0;
    for (const Atom& a : atoms) {
      if (a.element->symbol != sdf.name) continue;
      const voml::Seed& seed = scene->seed_lists[sdf.seeds.index].seeds.at(i++);
      const glm::dvec3 back = 2.0 * seed.position * frame.angstrom_per_unit + frame.center;  // spec/voml.md, Seeds
      CHECK(glm::distance(back, a.position) < 1e-5);
      CHECK(seed.scale.x * local_ball_radius * frame.angstrom_per_unit == doctest::Approx(a.element->radius));
    }
    CHECK(i == scene->seed_lists[sdf.seeds.index].seeds.size());
  }
}
