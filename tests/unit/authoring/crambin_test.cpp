// Real entries of the Protein Data Bank: counts that their READMEs and records state, and one entry in both formats.
#include <doctest/doctest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "authoring/molecule.h"
#include "base/files.h"

using namespace dmvv;
using namespace dmvv::authoring;

namespace {

Molecule read(const std::string& name, bool keep_water = true, bool assemblies = false) {
  const auto bytes = disk_files()(DMVV_MOLECULES "/" + name, 1u << 30);
  REQUIRE(bytes);
  Diagnostics diagnostics;
  auto molecule = parse_molecule(name, *bytes, {keep_water, assemblies}, diagnostics);
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

TEST_CASE("as many atoms of each element as gemmi 0.5.7 reads, water kept") {
  using Counts = std::vector<std::pair<const char*, std::size_t>>;
  const std::vector<std::pair<const char*, Counts>> files{
      {"capsid_1ihm/1IHM.pdb", {{"N", 1905}, {"C", 7205}, {"O", 2120}, {"S", 54}}},
      {"capsid_1m4x/1M4X.pdb", {{"N", 1647}, {"C", 6156}, {"O", 1866}, {"S", 24}}},
      {"gpcr_3sn6/3SN6.cif", {{"N", 1777}, {"C", 6519}, {"O", 1914}, {"S", 64}}},
      {"hemoglobin_2hhb/2hhb.pdb", {{"N", 780}, {"C", 2954}, {"O", 1027}, {"S", 12}, {"Fe", 4}, {"P", 2}}},
      {"osc_1w6k/1w6k.pdb", {{"N", 1024}, {"C", 3808}, {"O", 2026}, {"S", 37}}},
      {"ribosome30s_5lmo/5LMO.cif",
       {{"O", 14297}, {"C", 27927}, {"N", 10186}, {"P", 1530}, {"Mg", 108}, {"S", 60}, {"Zn", 2}}}};
  for (const auto& [name, counts] : files) {
    const Molecule molecule = read(name);
    std::size_t all = 0;
    for (const auto& [symbol, expected] : counts) {
      CHECK(count(molecule, symbol) == expected);
      all += expected;
    }
    CHECK(molecule.atoms.size() == all);
    CHECK(molecule.unknown_elements == 0);
  }
}

TEST_CASE("the operators of two capsids, of which the second has serial numbers that shift the columns") {
  for (const auto& [name, operators] : {std::pair("capsid_1ihm/1IHM.pdb", 60u), {"capsid_1m4x/1M4X.pdb", 1680u}}) {
    const Molecule molecule = read(name, false, true);
    REQUIRE(molecule.assemblies.size() == 1);
    CHECK(molecule.assemblies[0].parts.at(0).operators.size() == operators);
    CHECK(molecule.repaired_operators == 0);
  }
  const Operator last = read("capsid_1m4x/1M4X.pdb", false, true).assemblies[0].parts[0].operators.back();
  CHECK(last.translation == glm::dvec3(-11.99060, -134.06850, -89.32390));  // BIOMT1 to BIOMT3 of 1680
  CHECK(last.rotation[1][0] == doctest::Approx(-0.917901).epsilon(1e-5));
}
