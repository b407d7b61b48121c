// Real entries of the Protein Data Bank: counts that their READMEs and records state, and one entry in both formats.
#include <doctest/doctest.h>

#include <algorithm>

#include "authoring/molecule.h"
#include "voml/files.h"

using namespace dmvv;
using namespace dmvv::authoring;

namespace {

Molecule read(const std::string& name, bool keep_water = true) {
  const auto bytes = disk_files()(DMVV_MOLECULES "/" + name, 1u << 30);
  REQUIRE(bytes);
  Diagnostics diagnostics;
  auto molecule = parse_molecule(name, *bytes, {keep_water}, diagnostics);
  REQUIRE_MESSAGE(molecule, diagnostics.render());
  return *molecule;
}

std::size_t count(const Molecule& molecule, std::string_view symbol) {
  return static_cast<std::size_t>(
      std::ranges::count_if(molecule.atoms, [&](const Atom& a) { return a.element->symbol == symbol; }));
}

}  // namespace

TEST_CASE("crambin is the same molecule in PDB and in mmCIF: C202 N55 O64 S6") {
  const Molecule pdb = read("crambin_1crn/1crn.pdb"), cif = read("crambin_1crn/1CRN.cif");
  REQUIRE(pdb.atoms.size() == 327);
  REQUIRE(cif.atoms.size() == 327);
  for (std::size_t i = 0; i < pdb.atoms.size(); ++i) {
    CHECK(pdb.atoms[i].position == cif.atoms[i].position);
    CHECK(pdb.atoms[i].element == cif.atoms[i].element);
  }
  CHECK(count(pdb, "C") == 202);  // FORMUL and sequence of the entry
  CHECK(count(pdb, "N") == 55);
  CHECK(count(pdb, "O") == 64);
  CHECK(count(pdb, "S") == 6);
}

TEST_CASE("haemoglobin has 4779 atoms, of which 221 are water, and four irons") {
  const Molecule molecule = read("hemoglobin_2hhb/2hhb.pdb", false);
  CHECK(molecule.atoms.size() == 4558);
  CHECK(molecule.waters == 221);
  CHECK(count(molecule, "Fe") == 4);
}

TEST_CASE("an mmCIF with quotes, texts and many loops has its 10,274 atoms") {
  const Molecule molecule = read("gpcr_3sn6/3SN6.cif");
  CHECK(molecule.atoms.size() + molecule.alternates == 10274);
}
