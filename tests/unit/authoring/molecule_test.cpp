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
  std::string bad_y = good, bad_element = good;
  bad_y.replace(38, 8, "  14.o99");
  bad_element.replace(76, 2, "QQ");
  const Reading reading = read(good + bad_y + bad_element);
  CHECK_FALSE(reading.molecule);
  CHECK_MESSAGE(reading.messages.find("m:2:39: error[E0560]") != std::string::npos, reading.messages);
  CHECK_MESSAGE(reading.messages.find("m:3:77: error[E0561]: unknown element 'QQ'") != std::string::npos,
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
  check_refused(cif("ATOM ? . THR A 1 1 0 0 1\n"), "m:13:6: error[E0561]: the atom's element is not given");
  check_refused("data_M loop_ _atom_site.Cartn_x _atom_site.Cartn_y 1 2",
                "m:1:14: error[E0560]: the atoms have no _atom_site.Cartn_z");
  check_refused("data_M _a.b 'open\n'", "m:1:13: error[E0560]: a quote");
  check_refused("data_M _a.b\n;open\n ;", "m:2:1: error[E0560]: the text that begins here");
  check_refused("data_M _a.b _c.d 1", "m:1:8: error[E0560]: '_a.b' has no value");
  check_refused("data_M loop_ 1", "m:1:8: error[E0560]: a loop without names");
  check_refused("data_M 1", "m:1:8: error[E0560]: a value without a name");
  check_refused("data_M save_x", "m:1:8: error[E0560]: 'save_x' has no meaning");
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
