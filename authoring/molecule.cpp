// From a molecule's file to the atoms that are drawn, and from these to seeds and a scene.
#include "authoring/molecule.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <map>

#include "authoring/atom_names.h"
#include "authoring/molecule_readers.h"
#include "authoring/placements.h"
#include "authoring/text_input.h"
#include "base/text.h"

namespace dmvv::authoring {
namespace {

/// PDB writes six decimals: entries of R^T R are off by up to 3 * 5e-7 * 2.
constexpr double exact_operator = 4e-6;

std::string red_green_blue(std::uint32_t rgb) {
  return fmt::format("{:.3f} {:.3f} {:.3f}", (rgb >> 16 & 0xff) / 255.0, (rgb >> 8 & 0xff) / 255.0,
                     (rgb & 0xff) / 255.0);
}

std::string vector_line(const glm::dvec3& v) { return fmt::format("{:.7f} {:.7f} {:.7f}\n", v.x, v.y, v.z); }

}  // namespace

void MoleculeBuilder::report(Code code, std::string_view part, std::string message) {
  const auto begin = static_cast<std::uint32_t>(part.data() - text_.data());
  diagnostics_.report(code, {source_, begin, begin + static_cast<std::uint32_t>(part.size())}, std::move(message));
}

std::optional<glm::dvec3> MoleculeBuilder::position(const AtomRecord& record) {
  glm::dvec3 position;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view text = record.coordinates[axis];
    const auto number = parse_number(text);
    if (!std::holds_alternative<double>(number)) {
      report(Code::molecule_syntax, text,
             fmt::format("the coordinate {} is {}, not a finite number{}", "xyz"[axis], in_quotes(text),
                         decimal_point_hint(text)));
      return std::nullopt;
    }
    position[axis] = std::get<double>(number);
  }
  return position;
}

void MoleculeBuilder::leave_out_unknown(const AtomRecord& record) {
  const std::string_view element = record.element;
  if (unknown_.empty()) first_unknown_ = element.empty() ? record.coordinates[0] : element;
  const bool nothing = element.empty() || element == "." || element == "?";
  ++unknown_[nothing ? "not given" : in_quotes(element)];
  ++molecule_.unknown_elements;
}

std::string MoleculeBuilder::unknown_elements() const {
  constexpr std::size_t shown = 8;
  std::string list;
  std::size_t i = 0;
  for (const auto& [element, count] : unknown_)
    if (i++ < shown) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", element, count);
  if (unknown_.size() > shown) list += fmt::format(" and {} more", unknown_.size() - shown);
  return list;
}

void MoleculeBuilder::add(const AtomRecord& record) {
  const auto position = this->position(record);
  if (!position) return;
  if (!options_.keep_water && is_water(record.residue_name)) {
    ++molecule_.waters;
    return;
  }
  const Element* const element = find_element(record.element);
  if (!element) return leave_out_unknown(record);
  if (!record.alternate.empty() &&
      first_alternate_.try_emplace(record.residue, record.alternate).first->second != record.alternate) {
    ++molecule_.alternates;
    return;
  }
  const auto [chain, is_new] =
      chains_.try_emplace(std::string(record.chain), static_cast<std::uint32_t>(molecule_.chains.size()));
  if (is_new) molecule_.chains.emplace_back(record.chain);
  molecule_.atoms.push_back({*position, element, chain->second});
}

void MoleculeBuilder::add_part(std::string_view id, AssemblyPart part) {
  if (molecule_.assemblies.empty() || molecule_.assemblies.back().id != id)
    molecule_.assemblies.push_back({std::string(id), {}});
  std::ranges::sort(part.chains);
  molecule_.assemblies.back().parts.push_back(std::move(part));
}

std::optional<Operator> MoleculeBuilder::read_operator(const std::string_view (&rows)[3][4]) {
  glm::dmat3 matrix;
  Operator result;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const std::string_view text = rows[row][column];
      const auto number = parse_number(text);
      if (!std::holds_alternative<double>(number)) {
        report(Code::molecule_assembly, text,
               fmt::format("a number of an operator is {}, not a finite number", in_quotes(text)));
        return std::nullopt;
      }
      (column < 3 ? matrix[column][row] : result.translation[row]) = std::get<double>(number);
    }
  }
  const auto rotation = nearest_rotation(matrix);
  if (!rotation) {
    report(Code::not_a_rotation, rows[0][0], "the operator that begins here is too far from orthogonal, or mirrors");
    return std::nullopt;
  }
  molecule_.repaired_operators += rotation->fault > exact_operator;
  result.rotation = rotation->matrix;
  return result;
}

std::optional<Molecule> MoleculeBuilder::finish(std::size_t errors_before) {
  if (diagnostics_.error_count() != errors_before) return std::nullopt;
  if (molecule_.atoms.empty()) {
    std::string why = "no atoms: neither ATOM or HETATM records of PDB nor _atom_site of mmCIF";
    if (molecule_.waters != 0) why = fmt::format("all {} atoms are water, which is left out", molecule_.waters);
    if (!unknown_.empty())
      why =
          fmt::format("no atom has an element that is known ({}); PDB tells it in columns 77-78, mmCIF in type_symbol",
                      unknown_elements());
    diagnostics_.report(Code::molecule_without_atoms, {source_, 0, 0}, why);
    return std::nullopt;
  }
  if (!unknown_.empty()) {
    report(Code::molecule_unknown_elements, first_unknown_,
           fmt::format("{} left out, because no such element is known: {}",
                       molecule_.unknown_elements == 1
                           ? std::string("1 atom is")
                           : fmt::format("{} atoms, of which this is the first, are", molecule_.unknown_elements),
                       unknown_elements()));
  }
  return std::move(molecule_);
}

std::optional<Molecule> parse_molecule(const std::string& path, std::string_view bytes, const MoleculeOptions& options,
                                       Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  const auto source = add_text(path, bytes, Code::molecule_syntax, diagnostics);
  if (!source) return std::nullopt;
  MoleculeBuilder builder(*source, options, diagnostics);
  try {
    looks_like_mmcif(builder.text()) ? read_mmcif(builder) : read_pdb(builder);
  } catch (const MoleculeRefusal& refusal) {
    builder.report(refusal.code, builder.text().substr(refusal.begin, refusal.end - refusal.begin), refusal.message);
  }
  return builder.finish(errors_before);
}

MoleculeFrame fit_molecule(std::span<const Atom> atoms) {
  glm::dvec3 lo = atoms.front().position, hi = lo;
  for (const Atom& atom : atoms) {
    lo = glm::min(lo, atom.position - atom.element->radius);
    hi = glm::max(hi, atom.position + atom.element->radius);
  }
  const glm::dvec3 half = 0.5 * (hi - lo);
  return {0.5 * (lo + hi), std::max({half.x, half.y, half.z}) / 0.95};
}

std::vector<ElementSeeds> element_seeds(std::span<const Atom> atoms, const MoleculeFrame& frame) {
  std::map<const Element*, ElementSeeds> by_element;  // all point into one table, so this is by atomic number
  for (const Atom& atom : atoms) {
    ElementSeeds& seeds = by_element.try_emplace(atom.element, ElementSeeds{atom.element, 0, {}, {}}).first->second;
    ++seeds.count;
    seeds.seeds += vector_line((atom.position - frame.center) / (2.0 * frame.angstrom_per_unit));
    seeds.scales += vector_line(glm::dvec3(atom.element->radius / (local_ball_radius * frame.angstrom_per_unit)));
  }
  std::vector<ElementSeeds> result;
  result.reserve(by_element.size());
  for (auto& [element, seeds] : by_element) result.push_back(std::move(seeds));
  std::ranges::stable_sort(result, {}, &ElementSeeds::count);
  return result;
}

std::vector<Atom> atoms_of(const Molecule& molecule, const AssemblyPart& part) {
  std::vector<Atom> atoms;
  std::ranges::copy_if(molecule.atoms, std::back_inserter(atoms), [&](const Atom& atom) {
    return std::ranges::binary_search(part.chains, molecule.chains[atom.chain]);
  });
  return atoms;
}

std::string molecule_object(const std::string& name, std::span<const ElementSeeds> elements, const std::string& stem) {
  std::string sdfs, regions, open, close;
  for (const ElementSeeds& element : elements) {
    const std::string_view symbol = element.element->symbol;
    const std::string file = for_attribute(stem) + '_' + std::string(symbol);
    sdfs += fmt::format(
        "    <SDF name=\"{0}\" function=\"true\" type=\"seeding\" seedFile=\"{1}.txt\" scaleFile=\"{1}_scale.txt\">"
        "return length(p) - {2};</SDF>\n",
        symbol, file, local_ball_radius);
    regions += fmt::format("    <REGION name=\"R.{}\" type=\"color\" rgb=\"{}\"/>\n", symbol,
                           red_green_blue(element.element->rgb));
    open += fmt::format("      <SDF name=\"{0}\"><NEGATIVE region=\"R.{0}\"/><POSITIVE>\n", symbol);
    close += "      </POSITIVE></SDF>\n";
  }
  return fmt::format(R"(  <OBJECT name="{}">
{}
    <REGION name="R.OUTSIDE" type="empty"/>
{}
    <MAPPINGS>
{}        <REGION name="R.OUTSIDE"/>
{}    </MAPPINGS>
  </OBJECT>
)",
                     name, sdfs, regions, open, close);
}

std::string molecule_scene(std::span<const ElementSeeds> elements, const std::string& stem, std::string_view source) {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- The atoms of {} as van der Waals balls by element, the rarest first. Made by `dmvv seeds`. -->
<MVV>
{}</MVV>
)",
                     for_comment(source), molecule_object("MOLECULE", elements, stem));
}

}  // namespace dmvv::authoring
