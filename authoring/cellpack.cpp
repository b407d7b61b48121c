#include "authoring/cellpack.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

#include "authoring/json_text.h"
#include "authoring/text_input.h"
#include "base/text.h"

namespace dmvv::authoring {
namespace {

struct Refusal {
  const Json& at;
  Code code;
  std::string message;
};

[[noreturn]] void refuse(const Json& at, std::string message, Code code = Code::cellpack_syntax) {
  throw Refusal{at, code, std::move(message)};
}

double number(const Json& json) {
  if (!json.is_number()) refuse(json, "this is not a number");
  const double value = json.get<double>();
  if (!(std::abs(value) <= std::numeric_limits<float>::max())) refuse(json, "a number is beyond the range of float32");
  return value;
}

std::vector<double> numbers(const Json& list) {
  if (!list.is_array()) refuse(list, "this is not a list of numbers");
  std::vector<double> result;
  for (const Json& json : list) result.push_back(number(json));
  return result;
}

glm::dvec3 vector(const Json& list) {
  if (!list.is_array() || list.size() != 3) refuse(list, "this is not a list of 3 numbers");
  return {number(list[0]), number(list[1]), number(list[2])};
}

/// A value that is there, not null and not an empty list; else null.
const Json* find(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() || (found->is_array() && found->empty()) ? nullptr : &*found;
}

/// The first level of detail of `positions` or `radii`; null if there is none. Without levels it is the value itself,
/// whose entries are then single points (`point`) or numbers.
const Json* first_level(const Json& ingredient, const char* key, bool point) {
  const Json* const value = find(ingredient, key);
  if (!value || value->is_object()) return value;
  if (!value->is_array()) refuse(*value, fmt::format("'{}' is not a list", key));
  const Json& first = value->front();
  const bool is_point = point && first.is_array() && first.size() == 3 && first[0].is_number();
  if (first.is_number() || is_point) return value;
  if (!first.is_array() && !first.is_object()) refuse(first, fmt::format("'{}' holds neither lists nor objects", key));
  return first.empty() ? nullptr : &first;
}

/// The list of a level: itself, or that of an object {"coords": [...]}, {"radii": [...]}.
const Json& list_of(const Json& level, const char* key) {
  if (!level.is_object()) return level;
  const auto list = level.find(key);
  if (list == level.end()) refuse(level, fmt::format("a level of detail without '{}'", key));
  return *list;
}

/// [[x, y, z], ...] or [x, y, z, x, ...]
std::vector<glm::dvec3> points_of(const Json& list) {
  std::vector<glm::dvec3> points;
  if (list.is_array() && !list.empty() && list[0].is_array()) {
    for (const Json& point : list) points.push_back(vector(point));
    return points;
  }
  const std::vector<double> flat = numbers(list);
  if (flat.size() % 3 != 0) refuse(list, fmt::format("{} numbers are no points of three", flat.size()));
  for (std::size_t i = 0; i < flat.size(); i += 3) points.push_back({flat[i], flat[i + 1], flat[i + 2]});
  return points;
}

double positive_radius(const Json& json) {
  const double radius = number(json);
  if (!(radius > 0.0) || !usable_scale(radius)) refuse(json, "a radius must be greater than zero");
  return radius;
}

/// An ingredient as it stands in the file.
class IngredientReader {
 public:
  IngredientReader(const std::string& name, const Json& json, const RadiusOf& radius_of, Packing& packing)
      : name_(name), json_(json), radius_of_(radius_of), packing_(packing) {}

  std::vector<Placement> placements() {
    std::vector<Placement> result;
    for (const Json& entry : json_["results"]) {
      if (!entry.is_array() || entry.size() != 2 || !entry[1].is_array())
        refuse(entry, "a placement is [position, rotation]; the rotation a quaternion, or a matrix of 3 or 4 rows");
      const bool matrix = !entry[1].empty() && entry[1][0].is_array();
      result.push_back(matrix ? matrix_placement(entry) : quaternion_placement(entry));
    }
    return result;
  }

  std::vector<Bead> beads() {
    const Json* const positions = first_level(json_, "positions", true);
    const Json* const radii = first_level(json_, "radii", false);
    const std::vector<double> known = radii ? radii_of(list_of(*radii, "radii")) : std::vector<double>{};
    std::vector<glm::dvec3> points = positions ? points_of(list_of(*positions, "coords")) : std::vector<glm::dvec3>{};
    if (points.empty() && known.size() < 2) {
      ++packing_.without_beads;
      return {{glm::dvec3(0.0), known.empty() ? own_radius() : known[0]}};
    }
    if (points.size() == 1 && known.empty()) return {{points[0], own_radius()}};
    if (!known.empty() && known.size() != points.size())
      refuse(*radii, fmt::format("'{}' has {} beads and {} radii", name_, points.size(), known.size()));
    std::vector<Bead> result;
    for (std::size_t i = 0; i < points.size(); ++i)
      result.push_back({points[i], known.empty() ? given_radius("has beads without radii") : known[i]});
    return result;
  }

 private:
  static std::vector<double> radii_of(const Json& list) {
    if (!list.is_array()) refuse(list, "this is not a list of numbers");
    std::vector<double> radii;
    for (const Json& radius : list) radii.push_back(positive_radius(radius));
    return radii;
  }

  /// Of an ingredient that is one ball.
  double own_radius() const {
    for (const char* const key : {"radius", "encapsulatingRadius"})
      if (const Json* const radius = find(json_, key); radius && !(radius->is_number() && *radius == 0.0))
        return positive_radius(*radius);
    return given_radius("has no radii of beads, and neither 'radius' nor 'encapsulatingRadius'");
  }

  double given_radius(std::string_view lack) const {
    const double radius = radius_of_ ? radius_of_(name_) : 0.0;
    if (radius > 0.0) return radius;
    refuse(json_, fmt::format("'{}' {}; give it a radius by --radius, or in the table of --kinds", name_, lack));
  }

  Placement placed(const glm::dvec3& position, const std::optional<Rotation>& rotation, const Json& at) {
    if (!rotation) {
      refuse(at, fmt::format("this rotation of '{}' is too far from orthogonal, or mirrors", name_),
             Code::not_a_rotation);
    }
    packing_.repaired += rotation->fault > exact_rotation;
    packing_.worst = std::max(packing_.worst, rotation->fault);
    return {position, rotation->matrix, glm::dvec3(1.0)};
  }

  Placement quaternion_placement(const Json& entry) {
    const std::vector<double> q = numbers(entry[1]);
    if (q.size() != 4) refuse(entry[1], "a quaternion has 4 numbers");
    // Programs that write the axis of an ingredient under this name put the real part last; see spec/seeds.md.
    const bool real_last = json_.contains("principalAxis");
    packing_.real_last += real_last;
    const auto rotation =
        real_last ? quaternion_rotation(q[3], q[0], q[1], q[2]) : quaternion_rotation(q[0], q[1], q[2], q[3]);
    return placed(vector(entry[0]), rotation, entry[1]);
  }

  /// p_world = matrix * p_local: its rows are lists, a fourth column moves.
  Placement matrix_placement(const Json& entry) {
    const Json& rows = entry[1];
    if (rows.size() != 3 && rows.size() != 4) refuse(rows, "a rotation has 3 or 4 rows");
    glm::dmat3 matrix;
    glm::dvec3 position = vector(entry[0]), moved(0.0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::vector<double> row = numbers(rows[i]);
      if (row.size() != 4 && (row.size() != 3 || rows.size() != 3))
        refuse(rows[i], "a row of a rotation has as many numbers as there are rows");
      if (i == 3) {
        if (row != std::vector<double>{0.0, 0.0, 0.0, 1.0})
          refuse(rows[i],
                 "the fourth row is not 0 0 0 1; a matrix is given by rows, what it moves by in the fourth column");
        break;
      }
      for (int j = 0; j < 3; ++j) matrix[j][static_cast<int>(i)] = row[static_cast<std::size_t>(j)];
      if (row.size() == 4) moved[static_cast<int>(i)] = row[3];
    }
    if (moved != glm::dvec3(0.0) && position != glm::dvec3(0.0) && moved != position)
      refuse(rows, "the matrix moves to another place than the position beside it; one of the two must be zero");
    return placed(position == glm::dvec3(0.0) ? moved : position, nearest_rotation(matrix), rows);
  }

  const std::string& name_;
  const Json& json_;
  const RadiusOf& radius_of_;
  Packing& packing_;
};

constexpr int deepest_level = 64;  // results of cellPACK have 5

/// Walks the objects of a file, and those in lists, to the ingredients.
class PackingReader {
 public:
  explicit PackingReader(const RadiusOf& radius_of) : radius_of_(radius_of) {}

  Packing read(const Json& root) {
    collect(root, "", 0);
    if (packing_.ingredients.empty()) {
      refuse(root, packing_.fibres == 0 ? "no ingredient with 'results': a recipe alone has none"
                                        : "no ingredient with 'results'; curves are not drawn");
    }
    return std::move(packing_);
  }

 private:
  void collect(const Json& json, const std::string& place, int level) {
    if (!json.is_structured()) return;
    if (level > deepest_level)
      refuse(json, fmt::format("objects stand more than {} deep in each other", deepest_level));
    for (const auto& [key, value] : json.items()) {
      if (!value.is_object() && !(json.is_object() && value.is_array() && !value.empty() && value[0].is_object()))
        continue;
      const auto told = json.is_array() ? value.find("name") : value.end();
      const std::string name = told != value.end() && told->is_string() ? told->get<std::string>() : key;
      const auto results = value.is_object() ? value.find("results") : value.end();
      if (results == value.end() || results->is_object())
        collect(value, place.empty() ? name : place + '/' + name, level + 1);
      else
        read_ingredient(name, place, value, *results);
    }
  }

  void read_ingredient(const std::string& name, const std::string& place, const Json& json, const Json& results) {
    if (!results.is_array() && !results.is_null()) refuse(results, "'results' is not a list of placements");
    if (results.empty()) {
      packing_.fibres += json.contains("nbCurve");
      return;
    }
    IngredientReader reader(name, json, radius_of_, packing_);
    std::vector<Placement> placements = reader.placements();
    packing_.ingredients.push_back({name, place, reader.beads(), std::move(placements)});
  }

  const RadiusOf& radius_of_;
  Packing packing_;
};

}  // namespace

std::optional<Packing> parse_cellpack(const std::string& path, std::string_view bytes, const RadiusOf& radius_of,
                                      Diagnostics& diagnostics) {
  const auto source = add_text(path, bytes, Code::cellpack_syntax, diagnostics);
  if (!source) return std::nullopt;
  const std::string& text = diagnostics.source_text(*source);
  const auto report = [&](Code code, const JsonPlace& place, std::string message) {
    const auto begin = static_cast<std::uint32_t>(place.begin), end = static_cast<std::uint32_t>(place.end);
    diagnostics.report(code, {*source, begin, end}, std::move(message));
  };
  JsonFault fault;
  const std::optional<Json> root = parse_json(text, fault);
  if (!root) {
    report(Code::cellpack_syntax, fault.place, fault.why);
    return std::nullopt;
  }
  try {
    return PackingReader(radius_of).read(*root);
  } catch (const Refusal& refusal) {
    report(refusal.code, place_of(refusal.at, *root, text), refusal.message);
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
    for (Bead& bead : ingredients[i].beads)
      bead.radius = bead_spacing_share * (spacings[i] > 0.0 ? spacings[i] : usual);
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
    beads += fmt::format("{}vec4({:.5f}, {:.5f}, {:.5f}, {:.5f})", beads.empty() ? "" : ",\n        ", p.x, p.y, p.z,
                         radius);
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
