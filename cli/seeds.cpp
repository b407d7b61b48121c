// dmvv seeds FILE -o PREFIX: seed files of molecules, tables of placements and packings, and a scene that uses them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "authoring/cellpack.h"
#include "authoring/gunzip.h"
#include "authoring/kind_table.h"
#include "authoring/molecule.h"
#include "authoring/placement_table.h"
#include "authoring/placements.h"
#include "base/text.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/outputs.h"
#include "voml/format.h"

namespace dmvv::cli {
namespace {

struct SeedsOptions {
  std::string input;
  std::string prefix;
  std::string format = "auto";
  bool scene = false;
  std::string assembly;
  double radius = 0.0;  ///< of placements, beads or ingredients without one; 0: chosen
  std::string beads;    ///< table beside one of placements
  std::string kinds;    ///< table of names and colours
  bool blend = false;
  double jiggle = 0.0;  ///< amplitude, in units of the source
  authoring::TableOptions table_options;
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

/// The part of a path behind its folder.
std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

/// A whole file, unpacked if gzip packed it.
std::string read_unpacked(const std::string& path) {
  std::string bytes = read_bytes(path);
  if (!authoring::is_gzip(bytes)) return bytes;
  auto unpacked = authoring::gunzip(bytes);
  if (!unpacked) fail_with({unpacked.error().fault, path + ": " + unpacked.error().message, unpacked.error().reasons});
  return std::move(*unpacked);
}

void write(Outputs& outputs, const std::string& path, std::string_view bytes) {
  outputs.announce(path);
  outputs.write_bytes(path, bytes);
}

void write_placements(Outputs& outputs, const std::string& name, const authoring::PlacementFiles& files) {
  write(outputs, name + ".txt", files.seeds);
  write(outputs, name + "_rotate.txt", files.rotates);
  write(outputs, name + "_scale.txt", files.scales);
}

/// Writes a scene in its canonical layout.
void write_laid_out(Outputs& outputs, const std::string& path, std::string scene) {
  Diagnostics diagnostics;
  const SourceId source = diagnostics.add_source(path, std::move(scene));
  const auto formatted = voml::format_document(source, diagnostics);
  if (!formatted) throw std::logic_error("the scene is malformed: " + diagnostics.render());
  outputs.write_bytes(path, *formatted);
}

/// Writes the scene of the objects, if it is asked for, and puts every output in its place. `what` of the input it
/// shows.
void write_scene(Outputs& outputs, const SeedsOptions& options, std::span<const authoring::PlacedObject> objects,
                 std::string_view what, Context& context) {
  context.stopwatch.lap("seeds");
  if (options.scene) {
    write_laid_out(outputs, options.prefix + ".voml",
                   authoring::placed_scene(objects, file_name(options.prefix),
                                           fmt::format("{} of {}", what, file_name(options.input))));
  }
  outputs.commit();
  context.stopwatch.lap("write");
}

/// "repaired 12 rotations"; nothing if there are none.
std::string repaired_note(std::size_t repaired, double worst) {
  if (repaired == 0) return {};
  return fmt::format("  repaired {}, not quite orthogonal, by up to {:.2g}\n", plural(repaired, "rotation"), worst);
}

std::string frame_note(const authoring::MoleculeFrame& frame, std::string_view unit) {
  return fmt::format("  1 unit = {:.4g} {}, the middle is {:.3f} {:.3f} {:.3f}\n", frame.angstrom_per_unit, unit,
                     frame.center.x, frame.center.y, frame.center.z);
}

constexpr std::size_t listed_kinds = 12;

/// What the table of kinds says, if there is one.
class Looks {
 public:
  Looks(const SeedsOptions& options, Context& context) {
    if (options.kinds.empty()) return;
    Diagnostics diagnostics;
    auto table = authoring::parse_kind_table(options.kinds, read_unpacked(options.kinds), diagnostics);
    if (!table) stop_with(diagnostics, context);
    table_ = std::move(*table);
  }

  const std::string& name(const std::string& kind) const {
    const auto found = table_.find(kind);
    return found == table_.end() || found->second.name.empty() ? kind : found->second.name;
  }
  /// `i`: the place of the kind among all.
  std::string rgb(const std::string& kind, std::size_t i) const {
    const auto found = table_.find(kind);
    return found == table_.end() || found->second.rgb.empty() ? authoring::kind_rgb(i) : found->second.rgb;
  }

  double radius(const std::string& kind, double otherwise) const {
    const auto found = table_.find(kind);
    return found == table_.end() || found->second.radius == 0.0 ? otherwise : found->second.radius;
  }

 private:
  authoring::KindTable table_;
};

/// Thermal motion of a blob whose unit is `angstrom_per_unit`: it sways and its surface quivers, each kind in a rhythm
/// of its own. `i`: the place of the kind among all.
std::string jiggle(double amplitude, double angstrom_per_unit, std::size_t i) {
  if (amplitude == 0.0) return {};
  const double a = amplitude / angstrom_per_unit, phase = 2.4 * static_cast<double>(i % 100);
  const int pace = 300 + 37 * static_cast<int>(i % 11);  // ms a radian
  return fmt::format("\n      p += {0:.5f} * sin(t / {1}.0 + {2:.1f} + 4.0 * p.yzx);", a, pace, phase);
}

/// Writes the files and the scene of a packing; returns the note of what it holds.
std::string write_packing(const SeedsOptions& options, const authoring::Packing& packing, const Looks& looks,
                          Outputs& outputs, Context& context) {
  const std::string stem = file_name(options.prefix);
  const authoring::MoleculeFrame frame = authoring::fit_packing(packing);
  std::vector<std::string> ingredient_names;
  for (const authoring::Ingredient& ingredient : packing.ingredients)
    ingredient_names.push_back(looks.name(ingredient.name));
  const std::vector<std::string> names = authoring::file_names_of(ingredient_names);
  std::vector<authoring::PlacedObject> objects;
  std::size_t placements = 0, beads = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const authoring::Ingredient& ingredient = packing.ingredients[i];
    const bool blob = options.blend && ingredient.beads.size() <= authoring::max_blended_beads;
    const authoring::MoleculeFrame own =
        blob ? authoring::fit_blob(ingredient, options.jiggle) : authoring::fit_beads(ingredient);
    std::vector<authoring::Placement> placed = ingredient.placements;
    for (authoring::Placement& placement : placed) {
      placement.position += placement.rotation * (placement.scale * own.center);
      placement.scale *= own.angstrom_per_unit;
    }
    const std::string path = fmt::format("{}_{}", options.prefix, names[i]);
    const std::string rgb = looks.rgb(ingredient.name, i);
    if (!blob) {
      const authoring::PlacementFiles files = authoring::bead_files(ingredient, own);
      write(outputs, path + "_bead.txt", files.seeds);
      write(outputs, path + "_bead_scale.txt", files.scales);
    }
    write_placements(outputs, path, authoring::placement_files(placed, frame));
    objects.push_back(
        {names[i], placed.size(),
         blob ? authoring::blob_object(
                    names[i], rgb,
                    authoring::blob_function(ingredient, own, jiggle(options.jiggle, own.angstrom_per_unit, i)))
              : authoring::bead_object(names[i], rgb, fmt::format("{}_{}", stem, names[i]))});
    placements += placed.size();
    beads += ingredient.beads.size();
  }
  write_scene(outputs, options, objects, "The packing", context);
  return fmt::format("{}: {} of {} with {}\n{}{}", options.prefix, plural(placements, "placement"),
                     plural(names.size(), "ingredient"), plural(beads, "bead"), frame_note(frame, "A"),
                     repaired_note(packing.repaired, packing.worst));
}

/// A table of placements and one of beads.
int joined_seeds(const SeedsOptions& options, const authoring::PlacementTable& table, Outputs& outputs,
                 Context& context) {
  Diagnostics diagnostics;
  const auto beads = authoring::parse_placement_table(options.beads, read_unpacked(options.beads), {}, diagnostics);
  auto joined =
      beads ? authoring::join_tables(table, *beads, options.beads, options.radius, diagnostics) : std::nullopt;
  context.stopwatch.lap("read");
  if (!joined) stop_with(diagnostics, context);
  const Looks looks(options, context);
  if (joined->chose_radii) {
    for (authoring::Ingredient& ingredient : joined->packing.ingredients)
      for (authoring::Bead& bead : ingredient.beads) bead.radius = looks.radius(ingredient.name, bead.radius);
  }
  std::string note = write_packing(options, joined->packing, looks, outputs, context);
  if (joined->beads_unused != 0)
    note += fmt::format("  left out: {} with beads that stand nowhere\n", plural(joined->beads_unused, "kind"));
  if (joined->chose_radii)
    note += fmt::format(
        "  no radii: each is {} of the median distance between beads of its kind, where --kinds does not tell it\n",
        authoring::bead_spacing_share);
  if (!context.quiet) print_result(note);
  return exit_done;
}

int table_seeds(const SeedsOptions& options, Context& context) {
  Outputs outputs;
  if (options.scene) outputs.announce(options.prefix + ".voml");
  Diagnostics diagnostics;
  auto table =
      authoring::parse_placement_table(options.input, read_unpacked(options.input), options.table_options, diagnostics);
  context.stopwatch.lap("read");
  if (!table) stop_with(diagnostics, context);

  if (!options.beads.empty()) return joined_seeds(options, *table, outputs, context);
  const Looks looks(options, context);
  const double scale = options.radius != 0.0 ? options.radius : authoring::default_scale(*table);
  std::vector<authoring::Placement> all;
  std::vector<std::string> kind_names;
  for (authoring::PlacedKind& kind : table->kinds) {
    if (!table->has_scales)
      for (authoring::Placement& placement : kind.placements) placement.scale = glm::dvec3(scale);
    all.insert(all.end(), kind.placements.begin(), kind.placements.end());
    kind_names.push_back(looks.name(kind.name));
  }
  const authoring::MoleculeFrame frame = authoring::fit_placements(all);
  const std::vector<std::string> names = authoring::file_names_of(kind_names);
  std::vector<authoring::PlacedObject> objects;
  std::string by_kind;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& placements = table->kinds[i].placements;
    write_placements(outputs, fmt::format("{}_{}", options.prefix, names[i]),
                     authoring::placement_files(placements, frame));
    objects.push_back({names[i], placements.size(),
                       authoring::simple_object(names[i], looks.rgb(table->kinds[i].name, i), table->has_rotations)});
    if (i < listed_kinds) by_kind += fmt::format("{}{} {}", i == 0 ? "" : ", ", names[i], placements.size());
  }
  if (names.size() > listed_kinds) by_kind += fmt::format(" and {} kinds more", names.size() - listed_kinds);
  write_scene(outputs, options, objects, "The placements", context);
  if (context.quiet) return exit_done;
  print_result(fmt::format("{}: {} ({})\n{}{}{}", options.prefix, plural(all.size(), "placement"), by_kind,
                           frame_note(frame, "of the table"), repaired_note(table->repaired, table->worst),
                           table->has_scales ? "" : fmt::format("  no scales: each is {:.4g} of the table\n", scale)));
  return exit_done;
}

int cellpack_seeds(const SeedsOptions& options, Context& context) {
  Outputs outputs;
  if (options.scene) outputs.announce(options.prefix + ".voml");
  Diagnostics diagnostics;
  const Looks looks(options, context);
  const auto packing = authoring::parse_cellpack(
      options.input, read_unpacked(options.input),
      [&](const std::string& name) { return looks.radius(name, options.radius); }, diagnostics);
  context.stopwatch.lap("read");
  if (!packing) stop_with(diagnostics, context);
  std::string note = write_packing(options, *packing, looks, outputs, context);
  if (packing->without_beads != 0)
    note += fmt::format("  {} without beads: one ball each\n", plural(packing->without_beads, "ingredient"));
  if (packing->real_last != 0)
    note += fmt::format("  {} of ingredients with a principalAxis: quaternions read as x y z w\n",
                        plural(packing->real_last, "placement"));
  if (packing->fibres != 0) note += fmt::format("  left out: {}\n", plural(packing->fibres, "curve"));
  if (!context.quiet) print_result(note);
  return exit_done;
}

std::string operators_of(const authoring::Assembly& assembly) {
  std::string text;
  for (const authoring::AssemblyPart& part : assembly.parts)
    text += fmt::format("{}{} of chains {}", text.empty() ? "" : "; ", plural(part.operators.size(), "operator"),
                        fmt::join(part.chains, ", "));
  return text;
}

authoring::Molecule read_assemblies(const SeedsOptions& options, Context& context) {
  Diagnostics diagnostics;
  authoring::MoleculeOptions molecule_options = options.molecule_options;
  molecule_options.assemblies = true;
  auto molecule = authoring::parse_molecule(options.input, read_unpacked(options.input), molecule_options, diagnostics);
  context.stopwatch.lap("read");
  if (!molecule) stop_with(diagnostics, context);
  print_diagnostics(diagnostics, context);
  return std::move(*molecule);
}

int list_assemblies(const SeedsOptions& options, Context& context) {
  const authoring::Molecule molecule = read_assemblies(options, context);
  std::string text =
      fmt::format("{}: {}\n", options.input, molecule.assemblies.empty() ? "no assemblies" : "assemblies");
  for (const authoring::Assembly& assembly : molecule.assemblies)
    text += fmt::format("  {}: {}\n", assembly.id, operators_of(assembly));
  print_result(text);
  return exit_done;
}

[[noreturn]] void refuse_assembly(const SeedsOptions& options, fmt::format_string<const std::string&> message,
                                  Context& context) {
  Diagnostics diagnostics;
  diagnostics.report(Code::molecule_assembly, {diagnostics.add_source(options.input, ""), 0, 0},
                     fmt::format(message, options.assembly));
  stop_with(diagnostics, context);
}

int assembly_seeds(const SeedsOptions& options, Context& context) {
  const std::string stem = file_name(options.prefix);
  Outputs outputs;
  if (options.scene) outputs.announce(options.prefix + ".voml");
  const authoring::Molecule molecule = read_assemblies(options, context);
  const auto assembly = std::ranges::find(molecule.assemblies, options.assembly, &authoring::Assembly::id);
  if (assembly == molecule.assemblies.end())
    refuse_assembly(options, "there is no assembly '{}'; --assembly list tells which there are", context);

  const authoring::PlacedAssembly placed = authoring::place_assembly(molecule, *assembly);
  if (placed.units.empty()) refuse_assembly(options, "the assembly '{}' holds no atom that is to be drawn", context);
  std::vector<authoring::PlacedObject> objects;
  std::size_t atoms = 0;
  for (std::size_t i = 0; i < placed.units.size(); ++i) {
    const authoring::PlacedUnit& unit = placed.units[i];
    const std::string name = i == 0 ? "UNIT" : fmt::format("UNIT_{}", i + 1);
    const std::string path = fmt::format("{}_{}", options.prefix, name);
    const auto elements = authoring::element_seeds(unit.atoms, unit.frame);
    for (const authoring::ElementSeeds& element : elements) {
      write(outputs, fmt::format("{}_{}.txt", path, element.element->symbol), element.seeds);
      write(outputs, fmt::format("{}_{}_scale.txt", path, element.element->symbol), element.scales);
    }
    write_placements(outputs, path, authoring::placement_files(unit.placements, placed.frame));
    objects.push_back(
        {name, unit.placements.size(), authoring::molecule_object(name, elements, fmt::format("{}_{}", stem, name))});
    atoms += unit.atoms.size() * unit.placements.size();
  }
  write_scene(outputs, options, objects, fmt::format("Assembly {}", options.assembly), context);
  if (context.quiet) return exit_done;
  print_result(fmt::format(
      "{}: {} ({})\n{}{}{}", options.prefix, plural(atoms, "atom"), operators_of(*assembly), left_out(molecule),
      frame_note(placed.frame, "A"),
      molecule.repaired_operators == 0
          ? ""
          : fmt::format("  repaired {}, not quite orthogonal\n", plural(molecule.repaired_operators, "operator"))));
  return exit_done;
}

int molecule_seeds(const SeedsOptions& options, Context& context) {
  const std::string stem = file_name(options.prefix);
  Outputs outputs;
  const std::string scene = options.prefix + ".voml";
  if (options.scene) outputs.announce(scene);

  Diagnostics diagnostics;
  const auto molecule =
      authoring::parse_molecule(options.input, read_unpacked(options.input), options.molecule_options, diagnostics);
  context.stopwatch.lap("read");
  if (!molecule) stop_with(diagnostics, context);
  print_diagnostics(diagnostics, context);
  const authoring::MoleculeFrame frame = authoring::fit_molecule(molecule->atoms);
  const std::vector<authoring::ElementSeeds> elements = authoring::element_seeds(molecule->atoms, frame);
  context.stopwatch.lap("seeds");

  for (const authoring::ElementSeeds& element : elements) {
    const std::string name = fmt::format("{}_{}", options.prefix, element.element->symbol);
    write(outputs, name + ".txt", element.seeds);
    write(outputs, name + "_scale.txt", element.scales);
  }
  if (options.scene) {
    write_laid_out(outputs, scene, authoring::molecule_scene(elements, stem, file_name(options.input)));
  }
  outputs.commit();
  context.stopwatch.lap("write");
  if (!context.quiet) print_result(summary(options, *molecule, frame, elements));
  return exit_done;
}

/// What a file is, by the ending of its name where the option leaves it open.
std::string format_of(const SeedsOptions& options) {
  if (options.format != "auto") return options.format;
  std::filesystem::path path(options.input);
  if (lower_case(path.extension().string()) == ".gz") path.replace_extension();
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".json" || ending == ".cpr") return "cellpack";
  return ending == ".csv" || ending == ".tsv" || ending == ".txt" ? "table" : "molecule";
}

int seeds(const SeedsOptions& options, Context& context) {
  const std::string format = format_of(options);
  if (format != "table" && (!options.table_options.columns.empty() || !options.beads.empty()))
    fail_usage(fmt::format("--columns and --beads are for tables; {} is read as {}", options.input, format));
  if (format == "molecule" && options.radius != 0.0)
    fail_usage(fmt::format("--radius is for tables and results of cellPACK; {} is read as molecule", options.input));
  const bool beads = format == "cellpack" || !options.beads.empty();
  if (options.blend && !beads) fail_usage("--blend is for beads: results of cellPACK, and tables with --beads");
  if (options.jiggle != 0.0 && !options.blend) fail_usage("--jiggle moves blobs; --blend makes them");
  if (!options.kinds.empty() && format == "molecule") fail_usage("--kinds is for tables and results of cellPACK");
  if (format != "molecule" && !options.assembly.empty()) fail_usage("--assembly is for molecules");
  if (options.assembly == "list") return list_assemblies(options, context);
  if (options.prefix.empty()) fail_usage("-o PREFIX is needed: where the files' names begin");
  if (file_name(options.prefix).empty())
    fail_usage(fmt::format("-o {}: the prefix ends with '/', a name is needed behind it", options.prefix));
  if (!options.assembly.empty()) return assembly_seeds(options, context);
  if (format == "cellpack") return cellpack_seeds(options, context);
  return format == "table" ? table_seeds(options, context) : molecule_seeds(options, context);
}

}  // namespace

void add_seeds(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<SeedsOptions>();
  CLI::App& command = *app.add_subcommand("seeds", "Make seed files, and a scene, from atoms or a table of placements");
  command.add_option("FILE", options->input, "PDB or mmCIF file, a table (CSV, TSV, blanks), or a result of cellPACK")
      ->required()
      ->type_name("");
  command
      .add_option("-o,--output", options->prefix,
                  "Writes PREFIX_C.txt (places) and PREFIX_C_scale.txt (sizes) for carbon, and so on for each element\n"
                  "or kind; for kinds PREFIX_C_rotate.txt (angles) too")
      ->type_name("PREFIX");
  command
      .add_option(
          "--format", options->format,
          "molecule, table, cellpack or auto: .csv, .tsv and .txt are tables, .json and .cpr results of cellPACK, all\n"
          "others molecules")
      ->check(CLI::IsMember({"auto", "molecule", "table", "cellpack"}))
      ->type_name("FORMAT");
  command.add_flag("--voml", options->scene, "Also write PREFIX.voml, a scene of them in colours");
  command.add_flag("--water", options->molecule_options.keep_water,
                   "Keep water (HOH, WAT, H2O, DOD, TIP3, SOL, SPC and the like)");
  command
      .add_option(
          "--assembly", options->assembly,
          "An assembly of the file: its unit is an object that stands once an operator; list tells which there are")
      ->type_name("ID");
  command
      .add_option("--columns", options->table_options.columns,
                  "Names of a table's columns instead of its own: x,y,z,kind")
      ->type_name("NAMES");
  command
      .add_option(
          "--radius", options->radius,
          "Half the edge of a placement's cube, for a table without scales; with --beads, the radius of a bead; of a\n"
          "result of cellPACK, that of ingredients without beads or a radius")
      ->check(CLI::PositiveNumber)
      ->type_name("R");
  command
      .add_option("--beads", options->beads,
                  "A second table: the beads of each kind, as x y z kind, and radius if they have any")
      ->type_name("FILE");
  command
      .add_option("--kinds", options->kinds,
                  "A table kind,name,rgb,radius: what kinds are called, their colours (#e6801a), radii of beads")
      ->type_name("FILE");
  command.add_flag("--blend", options->blend,
                   fmt::format("Blend the beads of a thing into one smooth body, where they are at most {}",
                               authoring::max_blended_beads));
  command
      .add_option("--jiggle", options->jiggle,
                  "Thermal motion of blended bodies with t: how far, in units of the file (A)")
      ->check(CLI::PositiveNumber)
      ->type_name("A");
  add_common_options(command, invocation.context);
  command.footer(
      "The molecule fills the standard cube; 0.9 in a seed's cube is the van der Waals radius. Of several models, and\n"
      "of the alternate locations of a residue, the first is taken.\n"
      "A table's first row names its columns: x y z; a rotation as qw qx qy qz, as some of rx ry rz (degrees, Rz Ry "
      "Rx) or as\n"
      "m00 to m22 (row, column; from m11 to m33 too); scale or sx sy sz; kind. Others are left out. '#' begins a "
      "comment.\n"
      "Files packed by gzip are unpacked, up to 1 GiB.\n"
      "Examples: dmvv seeds 2hhb.pdb -o haemoglobin --voml\n"
      "          dmvv seeds 1m4x.pdb.gz --assembly 1 -o capsid --voml\n"
      "          dmvv seeds grains.csv -o grains --voml\n"
      "          dmvv seeds virion.cpr -o virion --voml --blend --jiggle 3 --kinds colours.csv\n"
      "          dmvv seeds instances.tsv.gz --beads beads.tsv.gz -o cell --voml\n"
      "A scene of placements fills no face of the standard cube: draw it with --cut \"0 0 1 0\", or make a support "
      "mesh\n"
      "of it by dmvv mesh.");
  command.callback([&invocation, options] {
    invocation.command = [options](Context& context) { return seeds(*options, context); };
  });
}

}  // namespace dmvv::cli
