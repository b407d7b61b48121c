// Private to authoring/molecule*.cpp: what the readers of the two formats share.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>

#include "authoring/molecule.h"

namespace dmvv::authoring {

/// Thrown at a fault behind which nothing can be trusted; parse_molecule turns it into a diagnostic.
struct MoleculeRefusal {
  std::size_t begin;
  std::size_t end;
  std::string message;
  Code code = Code::molecule_syntax;
};

/// An atom as it stands in a file; views into its text. Empty where the file says nothing.
struct AtomRecord {
  std::string_view coordinates[3];
  std::string_view element;  ///< where the file has none, what its name tells
  std::string_view residue_name;
  std::string_view alternate;
  std::string_view chain;
  std::string residue;  ///< what tells residues apart: chain, number, insertion code
};

/// Chooses the atoms to draw and reports faults at their places in `source`.
class MoleculeBuilder {
 public:
  MoleculeBuilder(SourceId source, const MoleculeOptions& options, Diagnostics& diagnostics)
      : source_(source), text_(diagnostics.source_text(source)), options_(options), diagnostics_(diagnostics) {}

  std::string_view text() const { return text_; }
  bool wants_assemblies() const { return options_.assemblies; }
  /// Operators of `chains` for assembly `id`; further parts of one assembly follow each other.
  void add_part(std::string_view id, AssemblyPart part);
  /// An operator of three rows of four numbers; faults are reported at their place, and give none.
  std::optional<Operator> read_operator(const std::string_view (&rows)[3][4]);

  /// An atom of the first model.
  void add(const AtomRecord& record);
  void skip_other_model() { ++molecule_.other_models; }
  /// `part` is a view into text().
  void report(Code code, std::string_view part, std::string message);

  std::optional<Molecule> finish(std::size_t errors_before);

 private:
  std::optional<glm::dvec3> position(const AtomRecord& record);
  void leave_out_unknown(const AtomRecord& record);
  /// "X 2, QQ 1"
  std::string unknown_elements() const;

  SourceId source_;
  std::string_view text_;
  MoleculeOptions options_;
  Diagnostics& diagnostics_;
  Molecule molecule_;
  std::unordered_map<std::string, std::uint32_t> chains_;
  std::unordered_map<std::string, std::string_view> first_alternate_;  ///< of each residue that has any
  std::map<std::string, std::size_t> unknown_;                         ///< atoms by elements that are not known
  std::string_view first_unknown_;  ///< the element of the first of them, or where none is given its coordinates
};

void read_pdb(MoleculeBuilder& builder);
void read_mmcif(MoleculeBuilder& builder);
/// Whether the first word behind blanks and comments is data_, loop_ or a name.
bool looks_like_mmcif(std::string_view text);

}  // namespace dmvv::authoring
