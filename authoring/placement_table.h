// Tables of placements: CSV, TSV or blank-separated text.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "authoring/placements.h"
#include "base/diagnostics.h"

namespace dmvv::authoring {

/// Placements of one name, in file order.
struct PlacedKind {
  std::string name;
  std::vector<Placement> placements;
};

struct PlacementTable {
  std::vector<PlacedKind> kinds;  ///< by their first row
  bool has_rotations = false;
  bool has_scales = false;   ///< without, every scale is 1
  std::size_t repaired = 0;  ///< rotations further than exact_rotation from orthogonal
  double worst = 0.0;        ///< how far the worst of them was
};

struct TableOptions {
  std::string columns;  ///< names that replace those of the file, separated by commas; empty: none
};

/// Reads a table (spec/seeds.md). Separated by tabs, commas, semicolons or blanks, whichever of them the first row has
/// in this order; quotes as RFC 4180 has them; `#` begins a comment. The first row holds names if no field of it is a
/// number.
///
/// Errors: E0564 a row with another number of fields, a value that is no finite number, a scale that is not positive;
/// E0565 columns missing, incomplete or twice; E0566 no row; E0567 a rotation that is none. Then the result is empty.
/// Cost: linear in the file.
std::optional<PlacementTable> parse_placement_table(const std::string& path, std::string_view bytes,
                                                    const TableOptions& options, Diagnostics& diagnostics);

/// A scale for placements that have none: half the edge of a cube whose copies would fill the box round the positions,
/// with that box's longest side for sides shorter than a hundredth of it; 1 if all positions are the same.
double default_scale(const PlacementTable& table);

}  // namespace dmvv::authoring
