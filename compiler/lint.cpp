#include "compiler/lint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "compiler/reference.h"
#include "compiler/snippet/probe_points.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler {
namespace {

using snippet::Snippet;

constexpr double steepest = 2.0;  // times a distance
constexpr double flattest = 0.25;
constexpr double margin = 1e-4;     // a surface that touches the border is not cut
constexpr int border_samples = 17;  // along each edge of the cube
constexpr std::size_t most_placements = 64;

bool in_cube(const glm::dvec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 1.0; }

/// Points on the faces of the standard cube.
const std::vector<glm::dvec3>& border_points() {
  static const std::vector<glm::dvec3> points = [] {
    std::vector<glm::dvec3> result;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        for (int i = 0; i < border_samples * border_samples; ++i) {
          glm::dvec3 p(side);
          p[(axis + 1) % 3] = 2.0 * (i % border_samples) / (border_samples - 1) - 1.0;
          p[(axis + 2) % 3] = 2.0 * (i / border_samples) / (border_samples - 1) - 1.0;
          result.push_back(p);
        }
      }
    }
    return result;
  }();
  return points;
}

/// Points of the standard cube for gradients.
const std::vector<glm::dvec3>& inner_points() {
  static const std::vector<glm::dvec3> points = [] {
    std::vector<glm::dvec3> result;
    for (std::uint32_t i = 1; i <= 600; ++i) {
      const glm::dvec3 unit(snippet::radical_inverse(i, 2), snippet::radical_inverse(i, 3),
                            snippet::radical_inverse(i, 5));
      result.push_back(unit * 2.0 - 1.0);
    }
    return result;
  }();
  return points;
}

std::vector<double> lint_times(bool uses_time) {
  std::vector<double> times = snippet::probe_times(uses_time);
  for (std::uint32_t i = 1; uses_time && i <= 24; ++i) times.push_back(20000.0 * snippet::radical_inverse(i, 2));
  return times;
}

class Linter {
 public:
  Linter(const Module& module, Diagnostics& diagnostics) : module_(module), diagnostics_(diagnostics) {
    reported_.resize(module.sdfs.size());
  }

  void run() {
    std::vector<bool> measured(module_.functions.size());
    for (const Sdf& sdf : module_.sdfs) {
      const auto* function = std::get_if<Id<Function>>(&sdf.source);
      if (function == nullptr || measured[function->index]) continue;
      measured[function->index] = true;
      measure_gradient(sdf, at(module_.functions, *function).snippet);
    }
    for (const Object& object : module_.objects) check_borders(object);
  }

 private:
  const Snippet* snippet_of(const Sdf& sdf) const {
    const auto* function = std::get_if<Id<Function>>(&sdf.source);
    return function != nullptr ? &at(module_.functions, *function).snippet : nullptr;
  }

  void measure_gradient(const Sdf& sdf, const Snippet& snippet);
  void check_borders(const Object& object);
  void check_own_border(const Object& object, Id<Sdf> id, double t);
  std::vector<Id<Sdf>> sdfs_of(const Object& object) const;
  void check_point(const Object& object, const glm::dvec3& p, double t, Id<Sdf> own_border);
  std::optional<double> value(const Sdf& sdf, const glm::dvec3& p, double t, std::size_t first = 0) const;
  bool is_positive_somewhere(const Sdf& sdf, double t) const;
  bool is_empty_leaf(Id<Node> node) const;

  const Module& module_;
  Diagnostics& diagnostics_;
  std::vector<bool> reported_;  // W0403, parallel to module.sdfs
};

// ---- W0402 ----

void Linter::measure_gradient(const Sdf& sdf, const Snippet& snippet) {
  double largest = 0.0, at_time = 0.0;
  glm::dvec3 at_point(0.0);
  for (const double t : snippet::probe_times(snippet.uses_time())) {
    for (const glm::dvec3& p : inner_points()) {
      const double norm = glm::length(snippet.differentiate(p, t).gradient);
      if (!(norm > largest)) continue;  // also NaN
      largest = norm;
      at_point = p;
      at_time = t;
    }
  }
  if (largest > flattest && largest <= steepest) return;
  const std::string where = snippet::describe(at_point, at_time, snippet.uses_time());
  diagnostics_.report(
      Code::distance_far_from_metric, sdf.span,
      largest > steepest
          ? fmt::format(
                "the SDF '{}' changes by {:.3g} a unit at {}, where a distance changes by at most 1; divided by "
                "that number it would be a bound",
                sdf.name, largest, where)
          : fmt::format("the SDF '{}' changes by no more than {:.3g} a unit (at {}), where a distance changes by 1",
                        sdf.name, largest, where));
}

// ---- W0403 ----

/// At a point of the object, by the placements from `first` on; nothing where it would take too long, or a snippet does
/// not end.
std::optional<double> Linter::value(const Sdf& sdf, const glm::dvec3& p, double t, std::size_t first) const {
  if (sdf.local_from_object.size() > most_placements) return std::nullopt;
  const Snippet* snippet = snippet_of(sdf);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = first; i < sdf.local_from_object.size(); ++i) {
    glm::dvec3 q = sdf.local_from_object[i](p);
    if (sdf.placement == voml::Placement::tiled) q -= 2.0 * glm::floor((q + 1.0) / 2.0);
    if (const auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source)) {
      const voml::Grid& samples = at(module_.grids, *grid);
      const bool inside =
          glm::all(glm::greaterThanEqual(q, samples.box_lo)) && glm::all(glm::lessThanEqual(q, samples.box_hi));
      if (inside && !samples.values.empty()) least = std::min(least, sample(samples, q));
    } else if (snippet == nullptr) {
      return std::nullopt;
    } else if (in_cube(q)) {
      const snippet::Value result = snippet->evaluate(q, t);
      if (!result.finished) return std::nullopt;
      least = std::fmin(least, result.f);
    }
  }
  return least;
}

bool Linter::is_positive_somewhere(const Sdf& sdf, double t) const {
  const Snippet& snippet = *snippet_of(sdf);
  const auto positive = [&](const glm::dvec3& q) { return snippet.evaluate(q, t).f > sdf.iso; };
  return std::any_of(border_points().begin(), border_points().end(), positive) ||
         std::any_of(inner_points().begin(), inner_points().end(), positive);
}

bool Linter::is_empty_leaf(Id<Node> node) const {
  const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, node).content);
  return region != nullptr && at(module_.regions, *region).kind == voml::RegionKind::empty;
}

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
    if (!is_positive_somewhere(at(module_.sdfs, sdf), t)) continue;
    reported_[sdf.index] = true;
    const std::string where = snippet::describe(p, t, snippet_of(at(module_.sdfs, sdf))->uses_time());
    diagnostics_.report(
        Code::surface_clipped, at(module_.sdfs, sdf).span,
        fmt::format("the surface of the SDF '{}' is cut off by the standard cube{}: it is still inside at "
                    "{} of the object '{}'",
                    at(module_.sdfs, sdf).name, own_border.valid() ? " of its own frame" : "", where, object.name));
  }
}

std::vector<Id<Sdf>> Linter::sdfs_of(const Object& object) const {
  std::vector<Id<Sdf>> found;
  std::vector<Id<Node>> open = {object.root};
  while (!open.empty()) {
    const auto* decision = std::get_if<Decision>(&at(module_.nodes, open.back()).content);
    open.pop_back();
    if (decision == nullptr) continue;
    found.push_back(decision->sdf);
    open.push_back(decision->negative);
    open.push_back(decision->positive);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// The cube of the SDF's first placement, where it lies in the object's and no other placement covers its border.
void Linter::check_own_border(const Object& object, Id<Sdf> id, double t) {
  const Sdf& sdf = at(module_.sdfs, id);
  const Snippet* snippet = snippet_of(sdf);
  if (snippet == nullptr || sdf.placement == voml::Placement::tiled || sdf.local_from_object.empty()) return;
  const Affine object_from_local = inverse(sdf.local_from_object.front());
  for (const glm::dvec3& border : border_points()) {
    const glm::dvec3 q = border * (1.0 - 1e-9);  // rounding must not take it out of the cube
    const glm::dvec3 p = object_from_local(q);
    if (reported_[id.index] || !in_cube(p) || !(snippet->evaluate(q, t).f < sdf.iso - margin)) continue;
    const auto others = value(sdf, p, t, 1);
    if (others && *others > sdf.iso) check_point(object, p, t, id);
  }
}

void Linter::check_borders(const Object& object) {
  const std::vector<Id<Sdf>> sdfs = sdfs_of(object);
  bool any = false, uses_time = false;
  for (const Id<Sdf> id : sdfs) {
    const Snippet* snippet = snippet_of(at(module_.sdfs, id));
    any |= snippet != nullptr;
    uses_time |= snippet != nullptr && snippet->uses_time();
  }
  if (!any) return;
  for (const double t : lint_times(uses_time)) {
    for (const glm::dvec3& p : border_points()) check_point(object, p, t, {});
    for (const Id<Sdf> id : sdfs) check_own_border(object, id, t);
  }
}

}  // namespace

void lint(const Module& module, Diagnostics& diagnostics) { Linter(module, diagnostics).run(); }

}  // namespace dmvv::compiler
