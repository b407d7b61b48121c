#include "authoring/cellpack.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
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

Ingredient ingredient_of(const std::string& name, const Json& json, Packing& packing) {
  Ingredient result{name, {}, {}};
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

void collect(const Json& json, Packing& packing) {
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_object()) continue;
    if (value.contains("results") && value["results"].is_array()) {
      if (!value["results"].empty()) packing.ingredients.push_back(ingredient_of(key, value, packing));
    } else {
      collect(value, packing);
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
    collect(Json::parse(bytes), packing);
    if (packing.ingredients.empty()) throw Refusal{Code::cellpack_syntax, "no ingredient with results"};
    return packing;
  } catch (const Json::parse_error& error) {
    const auto at = static_cast<std::uint32_t>(std::min(error.byte == 0 ? 0 : error.byte - 1, bytes.size()));
    diagnostics.report(Code::cellpack_syntax, {source, at, at}, "the text is not JSON here");
  } catch (const Refusal& refusal) {
    diagnostics.report(refusal.code, {source, 0, 0}, refusal.message);
  }
  return std::nullopt;
}

MoleculeFrame fit_beads(const Ingredient& ingredient) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  glm::dvec3 lo(infinity), hi(-infinity);
  for (const Bead& bead : ingredient.beads) {
    lo = glm::min(lo, bead.position - bead.radius);
    hi = glm::max(hi, bead.position + bead.radius);
  }
  const glm::dvec3 half = 0.5 * (hi - lo);
  return {0.5 * (lo + hi), std::max({half.x, half.y, half.z}) / 0.95};
}

MoleculeFrame fit_packing(const Packing& packing) {
  Ingredient all;
  for (const Ingredient& ingredient : packing.ingredients)
    for (const Placement& placement : ingredient.placements)
      for (const Bead& bead : ingredient.beads)
        all.beads.push_back({placement.position + placement.rotation * bead.position, bead.radius});
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

}  // namespace dmvv::authoring
