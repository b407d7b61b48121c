#include "authoring/cellpack.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "voml/limits.h"

namespace dmvv::authoring {
namespace {

using Json = nlohmann::ordered_json;

struct Refusal {
  Code code;
  std::string message;
};

double number(const Json& list, std::size_t i, std::size_t count, const std::string& where) {
  if (!list.is_array() || list.size() != count || !list[i].is_number())
    throw Refusal{Code::cellpack_syntax, fmt::format("{} is not a list of {} numbers", where, count)};
  return list[i].get<double>();
}

glm::dvec3 vector(const Json& list, const std::string& where) {
  return {number(list, 0, 3, where), number(list, 1, 3, where), number(list, 2, 3, where)};
}

Ingredient ingredient_of(const std::string& name, const std::string& place, const Json& json, Packing& packing) {
  Ingredient result{name, place, {}, {}};
  const Json& results = json["results"];
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::string where = fmt::format("placement {} of '{}'", i + 1, name);
    if (!results[i].is_array() || results[i].size() != 2)
      throw Refusal{Code::cellpack_syntax, where + " is not a position and a quaternion"};
    const Json& q = results[i][1];
    const auto rotation = quaternion_rotation(number(q, 0, 4, where), number(q, 1, 4, where), number(q, 2, 4, where),
                                              number(q, 3, 4, where));
    if (!rotation) throw Refusal{Code::not_a_rotation, "the quaternion of " + where + " is too far from unit length"};
    packing.repaired += rotation->fault > exact_rotation;
    packing.worst = std::max(packing.worst, rotation->fault);
    result.placements.push_back({vector(results[i][0], where), rotation->matrix, glm::dvec3(1.0)});
  }
  const auto level = [&](const char* key) -> const Json& {
    if (!json.contains(key) || !json[key].is_array() || json[key].empty() || !json[key][0].is_array())
      throw Refusal{Code::cellpack_syntax, fmt::format("'{}' has no beads: '{}' is missing or empty", name, key)};
    return json[key][0];
  };
  const Json &positions = level("positions"), &radii = level("radii");
  if (positions.empty() || positions.size() != radii.size())
    throw Refusal{Code::cellpack_syntax,
                  fmt::format("'{}' has {} beads and {} radii", name, positions.size(), radii.size())};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double radius = number(radii, i, radii.size(), fmt::format("radii of '{}'", name));
    if (!(radius > 0.0)) throw Refusal{Code::cellpack_syntax, fmt::format("a radius of '{}' is not positive", name)};
    result.beads.push_back({vector(positions[i], fmt::format("bead {} of '{}'", i + 1, name)), radius});
  }
  return result;
}

constexpr int deepest_level = 64;  // results of cellPACK have 5

void collect(const Json& json, const std::string& place, int level, Packing& packing) {
  if (!json.is_object()) return;
  if (level > deepest_level)
    throw Refusal{Code::cellpack_syntax, fmt::format("objects stand more than {} deep in each other", deepest_level)};
  for (const auto& [key, value] : json.items()) {
    if (!value.is_object()) continue;
    if (value.contains("results") && value["results"].is_array()) {
      if (!value["results"].empty()) packing.ingredients.push_back(ingredient_of(key, place, value, packing));
    } else {
      collect(value, place.empty() ? key : place + '/' + key, level + 1, packing);
    }
  }
}

}  // namespace

std::optional<Packing> parse_cellpack(const std::string& path, std::string_view bytes, Diagnostics& diagnostics) {
  const bool too_long = bytes.size() > voml::max_file_bytes;
  const SourceId source = diagnostics.add_source(path, too_long ? "" : std::string(bytes));
  try {
    if (too_long) throw Refusal{Code::cellpack_syntax, "the file is 4 GiB or longer"};
    Packing packing;
    collect(Json::parse(bytes), "", 0, packing);
    if (packing.ingredients.empty()) throw Refusal{Code::cellpack_syntax, "no ingredient with results"};
    return packing;
  } catch (const Json::parse_error& error) {
    const auto at = static_cast<std::uint32_t>(std::min(error.byte == 0 ? 0 : error.byte - 1, bytes.size()));
    diagnostics.report(Code::cellpack_syntax, {source, at, at}, "the text is not JSON here");
  } catch (const Json::out_of_range&) {
    diagnostics.report(Code::cellpack_syntax, {source, 0, 0}, "a number is larger than any double");
  } catch (const Refusal& refusal) {
    diagnostics.report(refusal.code, {source, 0, 0}, refusal.message);
  }
  return std::nullopt;
}

double median_spacing(std::span<const glm::dvec3> points) {
  // By x: neighbours along the sorted row are tried until x alone is farther than the nearest so far.
  std::vector<glm::dvec3> row(points.begin(), points.end());
  std::ranges::sort(row, {}, [](const glm::dvec3& p) { return p.x; });
  const auto square = [](const glm::dvec3& d) { return glm::dot(d, d); };
  std::vector<double> nearest;
  const std::size_t step = std::max<std::size_t>(1, row.size() / 2000);
  for (std::size_t i = 0; i < row.size(); i += step) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t j = i + 1; j < row.size() && (row[j].x - row[i].x) * (row[j].x - row[i].x) < best; ++j)
      best = std::min(best, square(row[j] - row[i]));
    for (std::size_t j = i; j-- > 0 && (row[i].x - row[j].x) * (row[i].x - row[j].x) < best;)
      best = std::min(best, square(row[i] - row[j]));
    nearest.push_back(std::sqrt(best));
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::ranges::nth_element(nearest, middle);
  return *middle;
}

namespace {

/// Radii by the spacing of each kind's beads; those of kinds with one bead, or with all at one place, by the others'.
void choose_radii(std::vector<Ingredient>& ingredients) {
  std::vector<double> spacings, known;
  for (const Ingredient& ingredient : ingredients) {
    std::vector<glm::dvec3> points;
    for (const Bead& bead : ingredient.beads) points.push_back(bead.position);
    spacings.push_back(points.size() < 2 ? 0.0 : median_spacing(points));
    if (spacings.back() > 0.0) known.push_back(spacings.back());
  }
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  if (!known.empty()) std::ranges::nth_element(known, middle);
  const double usual = known.empty() ? 1.0 / bead_spacing_share : *middle;
  for (std::size_t i = 0; i < ingredients.size(); ++i)
    for (Bead& bead : ingredients[i].beads) bead.radius = bead_spacing_share * (spacings[i] > 0.0 ? spacings[i] : usual);
}

}  // namespace

std::optional<JoinedTables> join_tables(const PlacementTable& placements, const PlacementTable& beads,
                                        const std::string& beads_path, double radius, Diagnostics& diagnostics) {
  std::map<std::string_view, const PlacedKind*> beads_of;
  for (const PlacedKind& kind : beads.kinds) beads_of[kind.name] = &kind;
  JoinedTables result;
  result.packing.repaired = placements.repaired;
  result.packing.worst = placements.worst;
  std::vector<std::string> without;
  for (const PlacedKind& kind : placements.kinds) {
    const auto found = beads_of.find(kind.name);
    if (found == beads_of.end()) {
      without.push_back(kind.name);
      continue;
    }
    Ingredient ingredient{kind.name, {}, {}, kind.placements};
    for (const Placement& bead : found->second->placements) {
      const double own = std::max({bead.scale.x, bead.scale.y, bead.scale.z});
      ingredient.beads.push_back({bead.position, beads.has_scales ? own : radius});
    }
    result.packing.ingredients.push_back(std::move(ingredient));
  }
  if (!without.empty()) {
    diagnostics.report(Code::table_without_rows, {diagnostics.add_source(beads_path, ""), 0, 0},
                       fmt::format("there is no bead of {} of the kinds that are placed, the first is '{}'",
                                   without.size(), without.front()));
    return std::nullopt;
  }
  result.beads_unused = beads.kinds.size() - result.packing.ingredients.size();
  result.chose_radii = !beads.has_scales && radius == 0.0;
  if (result.chose_radii) choose_radii(result.packing.ingredients);
  return result;
}

namespace {

/// The frame in which the beads fill `share` of the cube's longest side.
MoleculeFrame fit(const Ingredient& ingredient, double share) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  glm::dvec3 lo(infinity), hi(-infinity);
  for (const Bead& bead : ingredient.beads) {
    lo = glm::min(lo, bead.position - bead.radius);
    hi = glm::max(hi, bead.position + bead.radius);
  }
  const glm::dvec3 half = 0.5 * (hi - lo);
  return {0.5 * (lo + hi), std::max({half.x, half.y, half.z}) / share};
}

}  // namespace

MoleculeFrame fit_beads(const Ingredient& ingredient) { return fit(ingredient, 0.95); }

namespace {

double mean_radius(const Ingredient& ingredient) {
  double sum = 0.0;
  for (const Bead& bead : ingredient.beads) sum += bead.radius;
  return sum / static_cast<double>(ingredient.beads.size());
}

/// How steep the exponentials of a blend are, in units of its frame: it reaches over a fifth of a mean radius; steeper
/// ones would leave the range of float32 at the cube's corners, exp(-24 * 2 sqrt(3)).
double steepness(const Ingredient& ingredient, double angstrom_per_unit) {
  return std::min(24.0, 5.0 * angstrom_per_unit / mean_radius(ingredient));
}

}  // namespace

MoleculeFrame fit_blob(const Ingredient& ingredient, double reach) {
  MoleculeFrame frame = fit(ingredient, 0.9);
  // Where m balls of a radius meet in a point, their blend is log(m) / steepness thicker; at most some six do.
  const double together = std::log(static_cast<double>(std::min<std::size_t>(6, ingredient.beads.size())));
  const double blend = together / steepness(ingredient, frame.angstrom_per_unit) * frame.angstrom_per_unit;
  frame.angstrom_per_unit = 1.02 * (0.9 * frame.angstrom_per_unit + blend + reach);
  return frame;
}

MoleculeFrame fit_packing(const Packing& packing) {
  Ingredient all;
  for (const Ingredient& ingredient : packing.ingredients)
    for (const Placement& placement : ingredient.placements)
      for (const Bead& bead : ingredient.beads)
        all.beads.push_back({placement.position + placement.rotation * (placement.scale * bead.position),
                             bead.radius * std::max({placement.scale.x, placement.scale.y, placement.scale.z})});
  return fit_beads(all);
}

PlacementFiles bead_files(const Ingredient& ingredient, const MoleculeFrame& frame) {
  std::vector<Placement> balls;
  for (const Bead& bead : ingredient.beads)
    balls.push_back({bead.position, glm::dmat3(1.0), glm::dvec3(bead.radius / local_ball_radius)});
  return placement_files(balls, frame);
}

std::string bead_object(const std::string& name, const std::string& rgb, const std::string& stem) {
  return fmt::format(
      "  <OBJECT name=\"{0}\">\n    <SDF name=\"BEADS\" function=\"true\" type=\"seeding\" seedFile=\"{2}_bead.txt\""
      " scaleFile=\"{2}_bead_scale.txt\">return length(p) - {3};</SDF>\n"
      "    <REGION name=\"R.BEADS\" type=\"color\" rgb=\"{1}\"/>\n  </OBJECT>\n",
      name, rgb, for_attribute(stem), local_ball_radius);
}

std::string blob_function(const Ingredient& ingredient, const MoleculeFrame& frame, const std::string& before) {
  std::string beads;
  for (const Bead& bead : ingredient.beads) {
    const glm::dvec3 p = (bead.position - frame.center) / frame.angstrom_per_unit;
    const double radius = bead.radius / frame.angstrom_per_unit;
    beads += fmt::format("{}vec4({:.5f}, {:.5f}, {:.5f}, {:.5f})", beads.empty() ? "" : ",\n        ", p.x, p.y, p.z, radius);
  }
  const std::size_t count = ingredient.beads.size();
  const double steep = steepness(ingredient, frame.angstrom_per_unit);
  return fmt::format(R"({0}
      const vec4 beads[{1}] = vec4[{1}](
        {2});
      float sum = 0.0;
      for (int i = 0; i < {1}; ++i) sum += exp({3:.4f} * (beads[i].w - length(p - beads[i].xyz)));
      return -log(sum) / {3:.4f};)",
                     before, count, beads, steep);
}

std::string blob_object(const std::string& name, const std::string& rgb, const std::string& function) {
  return fmt::format(
      "  <OBJECT name=\"{0}\">\n    <SDF name=\"BLOB\" function=\"true\"><![CDATA[{2}\n    ]]></SDF>\n"
      "    <REGION name=\"R.{0}\" type=\"color\" rgb=\"{1}\"/>\n  </OBJECT>\n",
      name, rgb, function);
}

}  // namespace dmvv::authoring
