// PDB, format 3.3: of its records ATOM, HETATM, ENDMDL, END and REMARK 350.
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
               trim(columns(line, 22, 22)),
               std::string(columns(line, 22, 27))});
}

/// REMARK 350: BIOMOLECULE, the chains, and three BIOMT lines an operator.
class AssemblyReader {
 public:
  explicit AssemblyReader(MoleculeBuilder& builder) : builder_(builder) {}

  void read(std::string_view line) {
    const std::string_view rest = trim(columns(line, 12, 80));
    if (rest.starts_with("BIOMOLECULE:")) {
      finish();
      id_ = trim(rest.substr(12));
    } else if (const std::size_t at = rest.find("CHAINS:"); at != rest.npos) {
      if (rest.starts_with("APPLY")) finish();
      add_chains(rest.substr(at + 7));
    } else if (rest.starts_with("BIOMT")) {
      read_row(line);
    }
  }

  void finish() {
    if (row_ != 0) builder_.report(Code::molecule_assembly, last_, "the operator that ends here has not three rows");
    if (!part_.operators.empty()) builder_.add_part(id_, std::move(part_));
    part_ = {};
    row_ = 0;
  }

 private:
  void add_chains(std::string_view list) {
    for (std::size_t at = 0; at <= list.size();) {
      const std::size_t end = std::min(list.find(',', at), list.size());
      if (const std::string_view chain = trim(list.substr(at, end - at)); !chain.empty())
        part_.chains.push_back(chain == "NULL" ? std::string() : std::string(chain));
      at = end + 1;
    }
  }

  /// Large assemblies shift the columns by long serial numbers; where numbers touch, the columns hold.
  static std::vector<std::string_view> words_of(std::string_view text) {
    std::vector<std::string_view> words;
    for (std::size_t at = text.find_first_not_of(' '); at != text.npos; at = text.find_first_not_of(' ', at)) {
      const std::size_t end = std::min(text.find(' ', at), text.size());
      words.push_back(text.substr(at, end - at));
      at = end;
    }
    return words;
  }

  void read_row(std::string_view line) {
    last_ = line;
    const std::vector<std::string_view> words = words_of(columns(line, 14, 80));
    const std::string_view number = columns(line, 19, 19), serial = words.size() == 6 ? words[1] : columns(line, 20, 23);
    if (number != std::string_view("123").substr(row_, 1) || (row_ != 0 && serial != serial_)) {
      builder_.report(Code::molecule_assembly, number,
                      fmt::format("the row BIOMT{} of an operator was expected here", row_ + 1));
      row_ = 0;
      return;
    }
    if (id_.empty() || part_.chains.empty()) {
      builder_.report(Code::molecule_assembly, line, "an operator before BIOMOLECULE and CHAINS");
      return;
    }
    serial_ = serial;
    constexpr std::size_t first[] = {24, 34, 44, 54, 69};
    for (std::size_t i = 0; i < 4; ++i)
      rows_[row_][i] = words.size() == 6 ? words[i + 2] : trim(columns(line, first[i], first[i + 1] - 1));
    if (++row_ < 3) return;
    row_ = 0;
    if (const auto op = builder_.read_operator(rows_)) part_.operators.push_back(*op);
  }

  MoleculeBuilder& builder_;
  std::string_view id_, serial_, last_;
  AssemblyPart part_;
  std::string_view rows_[3][4];
  std::size_t row_ = 0;
};

}  // namespace

void read_pdb(MoleculeBuilder& builder) {
  const std::string_view text = builder.text();
  bool first_model = true;
  AssemblyReader assemblies(builder);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.starts_with("ATOM ") || line.starts_with("ATOM\t") || line.starts_with("HETATM")) {
      first_model ? read_atom(line, builder) : builder.skip_other_model();
    } else if (line.starts_with("ENDMDL") || trim(line) == "END") {
      first_model = false;
    } else if (builder.wants_assemblies() && line.starts_with("REMARK 350")) {
      assemblies.read(line);
    }
  }
  assemblies.finish();
}

}  // namespace dmvv::authoring
