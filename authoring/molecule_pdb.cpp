// PDB, format 3.3: of its records ATOM, HETATM, ENDMDL and END.
// https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html
#include <fmt/format.h>

#include <algorithm>

#include "authoring/molecule_readers.h"
#include "voml/text.h"

namespace dmvv::authoring {
namespace {

using voml::trim;

/// Columns first..last, counted from 1 as the format does; shorter where the line ends.
std::string_view columns(std::string_view line, std::size_t first, std::size_t last) {
  return first > line.size() ? line.substr(line.size()) : line.substr(first - 1, last - first + 1);
}

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/// The element as atom names tell it: right-justified in columns 13-14, except hydrogens of four letters (HG11).
std::string_view element_of_name(std::string_view line) {
  const std::string_view name = columns(line, 13, 16);
  if (name.size() < 2) return trim(name);
  if (!is_letter(name[0])) return trim(name.substr(1, 1));
  const bool long_hydrogen = trim(name).size() == 4 && (name[0] == 'H' || name[0] == 'D');
  return name.substr(0, !long_hydrogen && find_element(name.substr(0, 2)) ? 2 : 1);
}

/// Columns 77-78. Files from before 1996 have line numbers there.
std::string_view element_of(std::string_view line) {
  const std::string_view element = trim(columns(line, 77, 78));
  return !element.empty() && std::ranges::all_of(element, is_letter) ? element : element_of_name(line);
}

void read_atom(std::string_view line, MoleculeBuilder& builder) {
  if (const std::size_t tab = line.find('\t'); tab != line.npos) {
    builder.report(Code::molecule_syntax, line.substr(tab, 1), "a tab in an atom's record, whose columns have meaning");
    return;
  }
  if (line.size() < 54) {
    builder.report(Code::molecule_syntax, line,
                   fmt::format("the record ends at column {}; coordinates stand in columns 31-54", line.size()));
    return;
  }
  builder.add({{columns(line, 31, 38), columns(line, 39, 46), columns(line, 47, 54)},
               element_of(line),
               trim(columns(line, 18, 20)),
               trim(columns(line, 17, 17)),
               std::string(columns(line, 22, 27))});
}

}  // namespace

void read_pdb(MoleculeBuilder& builder) {
  const std::string_view text = builder.text();
  bool first_model = true;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.starts_with("ATOM ") || line.starts_with("ATOM\t") || line.starts_with("HETATM")) {
      first_model ? read_atom(line, builder) : builder.skip_other_model();
    } else if (line.starts_with("ENDMDL") || trim(line) == "END") {
      first_model = false;
    }
  }
}

}  // namespace dmvv::authoring
