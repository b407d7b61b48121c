// dmvv seeds MOLECULE -o PREFIX: seed files by element, and a scene that uses them.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <filesystem>
#include <memory>

#include "authoring/molecule.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/outputs.h"

namespace dmvv::cli {
namespace {

struct SeedsOptions {
  std::string molecule;
  std::string prefix;
  bool scene = false;
  authoring::MoleculeOptions molecule_options;
};

std::string left_out(const authoring::Molecule& molecule) {
  std::string text;
  const auto add = [&](std::size_t count, std::string_view what) {
    if (count != 0) text += fmt::format("{}{} {}", text.empty() ? "  left out: " : ", ", count, what);
  };
  add(molecule.waters, "of water");
  add(molecule.alternates, "at alternate locations");
  add(molecule.other_models, "of further models");
  return text.empty() ? text : text + '\n';
}

std::string summary(const SeedsOptions& options, const authoring::Molecule& molecule,
                    const authoring::MoleculeFrame& frame, std::span<const authoring::ElementSeeds> elements) {
  std::string by_element;
  for (const authoring::ElementSeeds& element : elements) {
    by_element += fmt::format("{}{} {}", by_element.empty() ? "" : ", ", element.element->symbol, element.count);
  }
  return fmt::format("{}: {} ({})\n{}  1 unit = {:.4g} A, the middle is {:.3f} {:.3f} {:.3f}\n", options.prefix,
                     plural(molecule.atoms.size(), "atom"), by_element, left_out(molecule), frame.angstrom_per_unit,
                     frame.center.x, frame.center.y, frame.center.z);
}

/// The part of a prefix behind its folder; it begins the files' names.
std::string stem_of(const std::string& prefix) {
  const std::string stem = std::filesystem::path(prefix).filename().string();
  if (stem.empty()) fail_usage(fmt::format("-o {}: the prefix ends with '/', a name is needed behind it", prefix));
  return stem;
}

int seeds(const SeedsOptions& options, Context& context) {
  const std::string stem = stem_of(options.prefix);
  Outputs outputs;
  const std::string scene = options.prefix + ".voml";
  if (options.scene) outputs.announce(scene);

  Diagnostics diagnostics;
  const auto molecule =
      authoring::parse_molecule(options.molecule, read_bytes(options.molecule), options.molecule_options, diagnostics);
  context.stopwatch.lap("read");
  if (!molecule) stop_with(diagnostics, context);
  const authoring::MoleculeFrame frame = authoring::fit_molecule(molecule->atoms);
  const std::vector<authoring::ElementSeeds> elements = authoring::element_seeds(molecule->atoms, frame);
  context.stopwatch.lap("seeds");

  const auto write = [&](const std::string& path, std::string_view bytes) {
    outputs.announce(path);
    outputs.write_bytes(path, bytes);
  };
  for (const authoring::ElementSeeds& element : elements) {
    const std::string name = fmt::format("{}_{}", options.prefix, element.element->symbol);
    write(name + ".txt", element.seeds);
    write(name + "_scale.txt", element.scales);
  }
  if (options.scene) {
    const std::string source = std::filesystem::path(options.molecule).filename().string();
    outputs.write_bytes(scene, authoring::molecule_scene(elements, stem, source));
  }
  outputs.commit();
  context.stopwatch.lap("write");
  if (!context.quiet) print_result(summary(options, *molecule, frame, elements));
  return exit_done;
}

}  // namespace

void add_seeds(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<SeedsOptions>();
  CLI::App& command = *app.add_subcommand("seeds", "Make seed files, and a scene, from a molecule's atoms");
  command.add_option("MOLECULE", options->molecule, "PDB or mmCIF file")->required()->type_name("");
  command
      .add_option("-o,--output", options->prefix,
                  "Writes PREFIX_C.txt (places) and PREFIX_C_scale.txt (radii) for carbon, and so on for each element")
      ->required()
      ->type_name("PREFIX");
  command.add_flag("--voml", options->scene, "Also write PREFIX.voml, a scene of coloured balls");
  command.add_flag("--water", options->molecule_options.keep_water, "Keep water (HOH, DOD, WAT)");
  add_common_options(command, invocation.context);
  command.footer(
      "The molecule fills the standard cube; 0.9 in a seed's cube is the van der Waals radius. Of several models, and\n"
      "of the alternate locations of a residue, the first is taken.\n"
      "Example:  dmvv seeds 2hhb.pdb -o haemoglobin --voml");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return seeds(*options, context); };
  });
}

}  // namespace dmvv::cli
