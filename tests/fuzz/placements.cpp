// Tables of placements and of kinds, and results of cellPACK, packed by gzip or not, and what is made of them.
#include <cmath>

#include "authoring/cellpack.h"
#include "authoring/gunzip.h"
#include "authoring/kind_table.h"
#include "tests/fuzz/targets.h"
#include "voml/assets/grid.h"

namespace dmvv::fuzz {

namespace {

constexpr std::size_t most_unpacked = 1u << 20;
constexpr std::size_t most_written = 2000;  // placements: writing more of them only repeats

/// The bytes, unpacked if they are packed; nothing where they claim to be and are not.
std::optional<std::string> unpacked(std::string_view bytes) {
  if (!authoring::is_gzip(bytes)) return std::string(bytes);
  auto made = authoring::gunzip(bytes, most_unpacked);
  if (!made) return std::nullopt;
  must(made->size() <= most_unpacked, "no more is unpacked than allowed");
  return std::move(*made);
}

void check_files(std::span<const authoring::Placement> placements) {
  for (const auto& placement : placements) {
    must(std::isfinite(placement.position.x + placement.position.y + placement.position.z), "positions are finite");
    const glm::dmat3 product = glm::transpose(placement.rotation) * placement.rotation;
    for (int i = 0; i < 3; ++i) must(std::abs(product[i][i] - 1.0) < 1e-9, "rotations are orthogonal");
  }
  if (placements.empty() || placements.size() > most_written) return;
  const auto files = authoring::placement_files(placements, authoring::fit_placements(placements));
  Diagnostics diagnostics;
  for (const std::string* text : {&files.seeds, &files.rotates, &files.scales}) {
    const auto lines = voml::parse_vectors(diagnostics.add_source("file", *text), diagnostics);
    must(lines && lines->size() == placements.size(), "what is written can be read");
  }
}

}  // namespace

void run_table(std::string_view bytes) {
  const auto text = unpacked(bytes);
  if (!text) return;
  Diagnostics of_kinds;
  must(authoring::parse_kind_table("k.csv", *text, of_kinds).has_value() == !of_kinds.has_errors(),
       "kinds or an error");
  must(!of_kinds.has_errors() || !of_kinds.render().empty(), "errors are told");
  Diagnostics diagnostics;
  const auto table = authoring::parse_placement_table("t.csv", *text, {}, diagnostics);
  must(table.has_value() == !diagnostics.has_errors(), "a table or an error");
  if (!table) return must(!diagnostics.render().empty(), "errors are told");
  must(!table->kinds.empty(), "a table has rows");
  must(std::isfinite(authoring::default_scale(*table)), "the default scale is finite");
  std::vector<std::string> names;
  for (const auto& kind : table->kinds) {
    names.push_back(kind.name);
    check_files(kind.placements);
  }
  must(authoring::file_names_of(names).size() == names.size(), "each kind has a name");
  const auto joined = authoring::join_tables(*table, *table, "t.csv", 0.0, diagnostics);  // its own places as beads
  must(joined.has_value() == !diagnostics.has_errors(), "a join or an error");
}

void run_cellpack(std::string_view bytes) {
  const auto text = unpacked(bytes);
  if (!text) return;
  Diagnostics diagnostics;
  const auto packing = authoring::parse_cellpack(
      "p.json", *text, [&](const std::string&) { return text->size() % 2 == 0 ? 2.0 : 0.0; }, diagnostics);
  must(packing.has_value() == !diagnostics.has_errors(), "a packing or an error");
  if (!packing) return must(!diagnostics.render().empty(), "errors are told");
  for (const auto& ingredient : packing->ingredients) {
    check_files(ingredient.placements);
    if (ingredient.beads.empty() || ingredient.beads.size() > authoring::max_blended_beads) continue;
    const auto frame = authoring::fit_blob(ingredient, 1.0);
    must(!authoring::blob_function(ingredient, frame, "").empty(), "beads blend");
  }
}

}  // namespace dmvv::fuzz
