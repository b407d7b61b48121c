// Distance grids, lists of vectors, bitmaps.
#include <cmath>

#include "tests/fuzz/targets.h"
#include "voml/grid.h"

namespace dmvv::fuzz {

void run_lxn(std::string_view bytes) {
  Diagnostics diagnostics;
  const auto grid = voml::parse_lxn(bytes, diagnostics.add_source("a.lxn", {}), diagnostics);
  must(grid.has_value() == !diagnostics.has_errors(), "a grid or an error");
  if (!grid) return must(!diagnostics.render().empty(), "errors are told");
  must(grid->values.size() == std::size_t{grid->size.x} * grid->size.y * grid->size.z, "as many values as samples");
  for (const float value : grid->values) must(std::isfinite(value), "values are finite");
  for (int axis = 0; axis < 3; ++axis) must(grid->box_lo[axis] < grid->box_hi[axis], "the box is not empty");
  const std::string written = voml::write_lxn(*grid);
  const auto again = voml::parse_lxn(written, diagnostics.add_source("b.lxn", {}), diagnostics);
  must(again && again->values == grid->values && voml::write_lxn(*again) == written, "what is written can be read");
}

void run_vectors(std::string_view bytes) {
  Diagnostics diagnostics;
  const auto vectors = voml::parse_vectors(diagnostics.add_source("a.txt", std::string(bytes)), diagnostics);
  must(vectors.has_value() == !diagnostics.has_errors(), "vectors or an error");
  if (!vectors) return must(!diagnostics.render().empty(), "errors are told");
  for (const glm::dvec3& v : *vectors) must(std::isfinite(v.x + v.y + v.z), "vectors are finite");
}

void run_bitmap(std::string_view bytes) {
  Diagnostics diagnostics;
  const auto bitmap = voml::parse_bitmap(bytes, "a.png", {diagnostics.add_source("a.voml", {}), 0, 0}, diagnostics);
  must(bitmap.has_value() == !diagnostics.has_errors(), "a bitmap or an error");
  if (!bitmap) return must(!diagnostics.render().empty(), "errors are told");
  must(bitmap->texels.size() == std::size_t{bitmap->n} * bitmap->n * bitmap->n, "n^3 texels");
}

}  // namespace dmvv::fuzz
