// PDB and mmCIF files, and what is made of their atoms.
#include "authoring/molecule.h"

#include <cmath>

#include "tests/fuzz/targets.h"
#include "voml/assets/grid.h"

namespace dmvv::fuzz {

void run_molecule(std::string_view bytes) {
  Diagnostics diagnostics;
  const authoring::MoleculeOptions options{bytes.size() % 2 == 0, bytes.size() % 3 == 0};
  const auto molecule = authoring::parse_molecule("a.pdb", bytes, options, diagnostics);
  must(molecule.has_value() == !diagnostics.has_errors(), "a molecule or an error");
  if (!molecule) return must(!diagnostics.render().empty(), "errors are told");
  must(!molecule->atoms.empty(), "a molecule has atoms");
  for (const auto& atom : molecule->atoms) {
    must(atom.element && std::isfinite(atom.position.x + atom.position.y + atom.position.z), "atoms are sound");
  }
  const auto seeds = authoring::element_seeds(molecule->atoms, authoring::fit_molecule(molecule->atoms));
  std::size_t count = 0;
  for (const auto& element : seeds) {
    count += element.count;
    const auto lines = voml::parse_vectors(diagnostics.add_source("seeds", element.seeds), diagnostics);
    must(lines && lines->size() == element.count, "the seeds can be read");
    const auto scales = voml::parse_vectors(diagnostics.add_source("scales", element.scales), diagnostics);
    must(scales && scales->size() == element.count, "the scales can be read");
  }
  must(count == molecule->atoms.size(), "every atom is a seed");
}

}  // namespace dmvv::fuzz
