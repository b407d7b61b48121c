// A table that says what kinds of things are called and how they are coloured.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/diagnostics.h"

namespace dmvv::authoring {

struct KindLook {
  std::string name;     ///< as the table has it; empty: that of the kind
  std::string rgb;      ///< "0.9 0.5 0.1"; empty: chosen
  double radius = 0.0;  ///< of a bead, where the beads have none; 0: chosen
};

/// By kind.
using KindTable = std::map<std::string, KindLook, std::less<>>;

/// Reads a table separated by tabs, or else commas, or else semicolons, with quotes as RFC 4180 has them, whose first
/// row names its columns: `kind` (or `entity`), and any of `name`, `rgb` (#rrggbb) and `radius`. Others are left out;
/// lines that begin with '#' and a blank are comments.
///
/// Errors: E0564 a row with another number of fields, a colour or radius that is none; E0565 no column `kind`, neither
/// of the others, or a column twice; E0564 a kind twice. Then the result is empty. Cost: n log n.
std::optional<KindTable> parse_kind_table(const std::string& path, std::string_view bytes, Diagnostics& diagnostics);

}  // namespace dmvv::authoring
