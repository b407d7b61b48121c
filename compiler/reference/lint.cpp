// The walk over a module, and what the trees of objects make of the borders of cubes and tiles. What is said of a
// source alone stands in lint_sources.cpp.
#include "compiler/reference/lint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "compiler/grids/sample.h"
#include "compiler/reference/lint_samples.h"
#include "compiler/reference/lint_sources.h"
#include "compiler/reference/reference.h"
#include "compiler/snippet/probe_points.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler {
namespace {

using snippet::Snippet;

constexpr double margin = 1e-4;       // a surface that touches the border is not cut
constexpr double seam_margin = 1e-3;  // a period that is a little off is no cut
constexpr std::size_t most_placements = 64;

bool in_cube(const glm::dvec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 1.0; }

class Linter {
 public:
  Linter(const Module& module, Diagnostics& diagnostics, const LintProgress& progress)
      : module_(module),
        diagnostics_(diagnostics),
        progress_(progress),
        samples_(module),
        reported_(module.sdfs.size()),
        ends_at_nothing_(module.sdfs.size()) {}

  void run() {
    for (const Node& node : module_.nodes) {
      const auto* decision = std::get_if<Decision>(&node.content);
      if (decision != nullptr && is_empty_leaf(decision->positive)) ends_at_nothing_[decision->sdf.index] = true;
    }
    std::vector<Borders> borders;
    for (const Object& object : module_.objects) borders.push_back(borders_of(object));
    total_ = module_.sdfs.size();
    for (const Borders& one : borders) total_ += one.times.size();

    SourceLint sources(module_, samples_, diagnostics_);
    for (const Sdf& sdf : module_.sdfs) {
      sources.check(sdf);
      step();
    }
    for (const Borders& one : borders) check_borders(one);
  }

 private:
  /// What is to be looked at of an object.
  struct Borders {
    const Object* object;
    std::vector<Id<Sdf>> sdfs;
    std::vector<double> times;  ///< none: no SDF can be cut
  };

  const Snippet* snippet_of(const Sdf& sdf) const {
    const auto* function = std::get_if<Id<Function>>(&sdf.source);
    return function != nullptr ? &at(module_.functions, *function).snippet : nullptr;
  }
  bool uses_time(const Sdf& sdf) const {
    const Snippet* snippet = snippet_of(sdf);
    return snippet != nullptr && snippet->uses_time();
  }

  void step() {
    if (progress_) progress_(++done_, total_);
  }

  Borders borders_of(const Object& object) const;
  std::vector<Id<Sdf>> sdfs_of(const Object& object) const;
  void check_borders(const Borders& borders);
  void check_own_border(const Object& object, Id<Sdf> id, double t);
  void check_point(const Object& object, const glm::dvec3& p, double t, Id<Sdf> own_border);
  void check_seams(const Object& object, Id<Sdf> id, double t);
  bool shows_seam(const Object& object, const glm::dvec3& p, double t, Id<Sdf> id) const;
  std::optional<Id<Node>> leaf_at(const Object& object, const glm::dvec3& p, double t, Id<Sdf> chosen,
                                  bool inside) const;
  std::optional<double> source_value(const Sdf& sdf, const glm::dvec3& q, double t) const;
  std::optional<double> value(const Sdf& sdf, const glm::dvec3& p, double t, std::size_t first = 0) const;
  bool is_empty_leaf(Id<Node> node) const;

  const Module& module_;
  Diagnostics& diagnostics_;
  const LintProgress& progress_;
  SampledFunctions samples_;
  std::vector<bool> reported_;         // W0403 or W0405, parallel to module.sdfs
  std::vector<bool> ends_at_nothing_;  // some decision of it has an empty region on its positive side; likewise
  std::size_t done_ = 0, total_ = 0;
};

// ---- values ----

/// Of the source alone, at a point of its own frame; infinite beyond its domain, nothing where a snippet does not end.
std::optional<double> Linter::source_value(const Sdf& sdf, const glm::dvec3& q, double t) const {
  constexpr double beyond = std::numeric_limits<double>::infinity();
  if (const auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source)) {
    const voml::Grid& samples = at(module_.grids, *grid);
    const bool inside =
        glm::all(glm::greaterThanEqual(q, samples.box_lo)) && glm::all(glm::lessThanEqual(q, samples.box_hi));
    return inside && !samples.values.empty() ? sample(samples, q) : beyond;
  }
  if (!in_cube(q)) return beyond;
  const snippet::Value result = snippet_of(sdf)->evaluate(q, t);
  return result.finished ? std::optional(result.f) : std::nullopt;
}

/// At a point of the object, by the placements from `first` on; nothing where it would take too long, or a snippet does
/// not end.
std::optional<double> Linter::value(const Sdf& sdf, const glm::dvec3& p, double t, std::size_t first) const {
  if (sdf.local_from_object.size() > most_placements) return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i < sdf.local_from_object.size(); ++i) {
    glm::dvec3 q = sdf.local_from_object[i](p);
    if (sdf.placement == voml::Placement::tiled) q -= 2.0 * glm::floor((q + 1.0) / 2.0);
    const auto f = source_value(sdf, q, t);
    if (!f) return std::nullopt;
    least = std::fmin(least, *f);
  }
  return least;
}

bool Linter::is_empty_leaf(Id<Node> node) const {
  const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, node).content);
  return region != nullptr && at(module_.regions, *region).kind == voml::RegionKind::empty;
}

// ---- W0403 ----

/// Follows the tree at p. What is filled there, but empty on the other side of an SDF, ends at that SDF's surface;
/// here, at a border, it ends at the cube. With `own_border`, p lies on the border of that SDF's cube, and it alone is
/// meant.
void Linter::check_point(const Object& object, const glm::dvec3& p, double t, Id<Sdf> own_border) {
  std::vector<Id<Sdf>> cut;
  Id<Node> id = object.root;
  while (const auto* decision = std::get_if<Decision>(&at(module_.nodes, id).content)) {
    const Sdf& sdf = at(module_.sdfs, decision->sdf);
    const auto f = value(sdf, p, t);
    if (!f) return;
    const bool candidate = sdf.placement != voml::Placement::tiled && snippet_of(sdf) != nullptr &&
                           *f < sdf.iso - margin && is_empty_leaf(decision->positive) &&
                           (!own_border.valid() || own_border == decision->sdf);
    if (candidate && !reported_[decision->sdf.index]) cut.push_back(decision->sdf);
    id = *f <= sdf.iso ? decision->negative : decision->positive;
  }
  if (is_empty_leaf(id)) return;
  for (const Id<Sdf> sdf : cut) {
    const auto function = std::get<Id<Function>>(at(module_.sdfs, sdf).source);
    if (!(samples_.at(function, t).most > at(module_.sdfs, sdf).iso)) continue;  // no surface: W0404 speaks of it
    reported_[sdf.index] = true;
    const std::string where = snippet::describe(p, t, uses_time(at(module_.sdfs, sdf)));
    diagnostics_.report(
        Code::surface_clipped, at(module_.sdfs, sdf).span,
        fmt::format("the surface of the SDF '{}' is cut off by the standard cube{}: it is still inside at "
                    "{} of the object '{}'",
                    at(module_.sdfs, sdf).name, own_border.valid() ? " of its own frame" : "", where, object.name));
  }
}

/// The cube of the SDF's first placement, where it lies in the object's and no other placement covers its border.
void Linter::check_own_border(const Object& object, Id<Sdf> id, double t) {
  const Sdf& sdf = at(module_.sdfs, id);
  const Snippet* snippet = snippet_of(sdf);
  if (snippet == nullptr || sdf.placement == voml::Placement::tiled || sdf.local_from_object.empty()) return;
  if (!ends_at_nothing_[id.index] || sdf.local_from_object.front() == Affine{})
    return;  // the object's border is seen to
  const Affine object_from_local = inverse(sdf.local_from_object.front());
  for (const glm::dvec3& border : border_points()) {
    const glm::dvec3 q = border * (1.0 - 1e-9);  // rounding must not take it out of the cube
    const glm::dvec3 p = object_from_local(q);
    if (reported_[id.index] || !in_cube(p) || !(snippet->evaluate(q, t).f < sdf.iso - margin)) continue;
    const auto others = value(sdf, p, t, 1);
    if (others && *others > sdf.iso) check_point(object, p, t, id);
  }
}

// ---- W0405 ----

/// The leaf that a point comes to if one SDF's side is given; nothing if its value is not known, or that SDF not asked.
std::optional<Id<Node>> Linter::leaf_at(const Object& object, const glm::dvec3& p, double t, Id<Sdf> chosen,
                                        bool inside) const {
  bool is_asked = false;
  Id<Node> id = object.root;
  while (const auto* decision = std::get_if<Decision>(&at(module_.nodes, id).content)) {
    const Sdf& sdf = at(module_.sdfs, decision->sdf);
    const bool is_chosen = decision->sdf == chosen;
    const auto f = is_chosen ? std::nullopt : value(sdf, p, t);
    if (!is_chosen && !f) return std::nullopt;
    is_asked |= is_chosen;
    id = (is_chosen ? inside : *f <= sdf.iso) ? decision->negative : decision->positive;
  }
  return is_asked ? std::optional(id) : std::nullopt;
}

/// Are there two regions at p, on the two sides of the SDF?
bool Linter::shows_seam(const Object& object, const glm::dvec3& p, double t, Id<Sdf> id) const {
  const auto negative = leaf_at(object, p, t, id, true), positive = leaf_at(object, p, t, id, false);
  if (!negative || !positive) return false;
  return std::get<Id<Region>>(at(module_.nodes, *negative).content) !=
         std::get<Id<Region>>(at(module_.nodes, *positive).content);
}

/// The faces of the tile around the object's centre: what is inside on one of them must be inside on the opposite one.
void Linter::check_seams(const Object& object, Id<Sdf> id, double t) {
  const Sdf& sdf = at(module_.sdfs, id);
  if (sdf.placement != voml::Placement::tiled || sdf.local_from_object.empty()) return;
  const Affine object_from_local = inverse(sdf.local_from_object.front());
  const glm::dvec3 tile = 2.0 * glm::floor((sdf.local_from_object.front()(glm::dvec3(0.0)) + 1.0) / 2.0);
  for (const glm::dvec3& face : border_points()) {
    if (reported_[id.index]) return;
    const glm::dvec3 p = object_from_local(tile + face);
    if (!in_cube(p * (1.0 + 1e-6))) continue;  // on the object's border there is no next tile
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(face[axis]) != 1.0) continue;
      glm::dvec3 opposite = face;
      opposite[axis] = -face[axis];
      const auto here = source_value(sdf, face, t), there = source_value(sdf, opposite, t);
      const bool is_cut = here && there && *here<sdf.iso - seam_margin&& * there> sdf.iso + seam_margin;
      if (!is_cut || !shows_seam(object, p, t, id)) continue;
      reported_[id.index] = true;
      diagnostics_.report(
          Code::tile_cut, sdf.span,
          fmt::format(
              "the surface of the SDF '{}' is cut at the edge of its tile: at {} it is {:.3g}, and {:.3g} where the "
              "next tile begins; a tile's opposite faces must be equal, or empty",
              sdf.name, snippet::describe(face, t, uses_time(sdf)), *here, *there));
      break;
    }
  }
}

// ---- objects ----

std::vector<Id<Sdf>> Linter::sdfs_of(const Object& object) const {
  std::vector<Id<Sdf>> found;
  std::vector<Id<Node>> open = {object.root};
  std::set<Id<Node>> seen;
  while (!open.empty()) {
    const Id<Node> id = open.back();
    open.pop_back();
    const auto* decision = std::get_if<Decision>(&at(module_.nodes, id).content);
    if (decision == nullptr || !seen.insert(id).second) continue;
    found.push_back(decision->sdf);
    open.push_back(decision->negative);
    open.push_back(decision->positive);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

Linter::Borders Linter::borders_of(const Object& object) const {
  Borders borders{&object, sdfs_of(object), {}};
  bool any = false, moves = false;
  for (const Id<Sdf> id : borders.sdfs) {
    const Sdf& sdf = at(module_.sdfs, id);
    any |= snippet_of(sdf) != nullptr || sdf.placement == voml::Placement::tiled;
    moves |= uses_time(sdf);
  }
  if (any) borders.times = lint_times(moves);
  return borders;
}

void Linter::check_borders(const Borders& borders) {
  const bool may_be_cut =
      std::ranges::any_of(borders.sdfs, [&](Id<Sdf> id) { return bool{ends_at_nothing_[id.index]}; });
  for (const double t : borders.times) {
    if (may_be_cut) {
      for (const glm::dvec3& p : border_points()) check_point(*borders.object, p, t, {});
    }
    for (const Id<Sdf> id : borders.sdfs) {
      check_own_border(*borders.object, id, t);
      check_seams(*borders.object, id, t);
    }
    step();
  }
}

}  // namespace

void lint(const Module& module, Diagnostics& diagnostics, const LintProgress& progress) {
  Linter(module, diagnostics, progress).run();
}

}  // namespace dmvv::compiler
