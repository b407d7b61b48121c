// PDB, format 3.3: of its records ATOM, HETATM, MODEL, ENDMDL, END and REMARK 350.
// https://www.wwpdb.org/documentation/file-format-content/format33/sect9.html
#include <fmt/format.h>

#include <algorithm>

#include "authoring/atom_names.h"
#include "authoring/molecule_readers.h"
#include "base/text.h"

namespace dmvv::authoring {
namespace {

/// Columns first..last, counted from 1 as the format does; shorter where the line ends.
std::string_view columns(std::string_view line, std::size_t first, std::size_t last) {
  return first > line.size() ? line.substr(line.size()) : line.substr(first - 1, last - first + 1);
}

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

bool is_record(std::string_view line, std::string_view name) { return same_word(line.substr(0, name.size()), name); }

/// Some programs write longer serial numbers, from column 5 on.
bool is_atom(std::string_view line) {
  if (is_record(line, "HETATM")) return true;
  return is_record(line, "ATOM") && line.size() > 4 && std::string_view(" \t0123456789").find(line[4]) != line.npos;
}

/// The model's end of some programs is END. A MODEL record begins one, which need not have ended the one before.
bool ends_model(std::string_view line) { return is_record(line, "ENDMDL") || same_word(trim(line), "END"); }
bool begins_model(std::string_view line) { return is_record(line, "MODEL") && trim(columns(line, 6, 6)).empty(); }

/// Columns 77-78; empty where these hold something else: line numbers before 1996, types of force fields in 78-79.
std::string_view element_column(std::string_view line) {
  const std::string_view element = trim(columns(line, 77, 78)), behind = columns(line, 79, 79);
  const bool letters = std::ranges::all_of(element, is_letter) && std::ranges::none_of(behind, is_letter);
  return letters ? element : std::string_view{};
}

/// Whether the names of atoms without an element begin in column 13, wherever their element stands: then a name of
/// fewer than four characters has H, C, N, O, P or S there, and no letter behind it.
bool has_names_at_left(std::string_view line) {
  if (!element_column(line).empty()) return false;
  const std::string_view name = columns(line, 13, 16);
  return name.size() == 4 && std::string_view("HCNOPS").find(name[0]) != name.npos && !is_letter(name[1]) &&
         name[3] == ' ';
}

/// Columns 18-20, and 21, where the names of force fields have a fourth letter and some chains their first.
std::string_view residue_name(std::string_view line) { return trim(columns(line, 18, 21)); }

void read_atom(std::string_view line, NameAlignment alignment, MoleculeBuilder& builder) {
  if (const std::size_t tab = line.find('\t'); tab != line.npos) {
    builder.report(Code::molecule_syntax, line.substr(tab, 1), "a tab in an atom's record, whose columns have meaning");
    return;
  }
  if (line.size() < 54) {
    builder.report(Code::molecule_syntax, line,
                   fmt::format("the record ends at column {}; coordinates stand in columns 31-54", line.size()));
    return;
  }
  const std::string_view residue = residue_name(line), told = element_column(line);
  builder.add({{columns(line, 31, 38), columns(line, 39, 46), columns(line, 47, 54)},
               told.empty() ? element_of_name(columns(line, 13, 16), residue, alignment) : told,
               residue,
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
    const std::string_view number = columns(line, 19, 19),
                           serial = words.size() == 6 ? words[1] : columns(line, 20, 23);
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

namespace {

void for_each_line(std::string_view text, auto&& visit) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    visit(line);
  }
}

NameAlignment alignment_of(std::string_view text) {
  NameAlignment alignment = NameAlignment::columns;
  for_each_line(text, [&](std::string_view line) {
    if (is_atom(line) && has_names_at_left(line)) alignment = NameAlignment::left;
  });
  return alignment;
}

}  // namespace

void read_pdb(MoleculeBuilder& builder) {
  const NameAlignment alignment = alignment_of(builder.text());
  AssemblyReader assemblies(builder);
  bool first_model = true, any_atom = false;
  for_each_line(builder.text(), [&](std::string_view line) {
    if (is_atom(line)) {
      first_model ? read_atom(line, alignment, builder) : builder.skip_other_model();
      any_atom = true;
    } else if (any_atom && (ends_model(line) || begins_model(line))) {
      first_model = false;
    } else if (builder.wants_assemblies() && is_record(line, "REMARK 350")) {
      assemblies.read(line);
    }
  });
  assemblies.finish();
}

}  // namespace dmvv::authoring
