#include "compiler/reference/lint_sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <queue>

#include "compiler/snippet/probe_points.h"
#include "compiler/snippet/rounding_doubt.h"
#include "compiler/snippet/time_range.h"

namespace dmvv::compiler {

namespace {

using snippet::Snippet;

constexpr double steepest_distance = 2.0;  // times a distance
constexpr double flattest_distance = 0.25;
constexpr double last_t_ms = 3.6e6;  // up to which lint looks

// ---- one side alone ----

enum class Answer { yes, no, open };

/// Is there a point of the cube where the function is on the other side than `is_inside`? The box that may reach
/// farthest over iso is halved first, and its centre tried.
Answer is_elsewhere(const Snippet& snippet, double iso, bool is_inside) {
  constexpr std::size_t most_boxes = 2000, most_instructions = 2'000'000;
  const snippet::BoxFunction function(snippet, {0.0, snippet.uses_time() ? last_t_ms : 0.0});
  struct Part {
    snippet::Box box;
    double beyond;  ///< iso, at most
  };
  const auto part = [&](const snippet::Box& box) {
    const snippet::Interval f = function(box);
    if (!is_inside) return Part{box, iso - f.lo};
    return Part{box, f.maybe_nan ? std::numeric_limits<double>::infinity() : f.hi - iso};
  };
  const auto nearer = [](const Part& a, const Part& b) { return a.beyond < b.beyond; };
  std::priority_queue<Part, std::vector<Part>, decltype(nearer)> open(nearer);
  open.push(part({glm::dvec3(-1.0), glm::dvec3(1.0)}));
  const std::size_t most =
      std::min(most_boxes, most_instructions / std::max<std::size_t>(snippet.instruction_count(), 1));
  for (std::size_t tested = 1; tested < most; tested += 2) {
    const Part first = open.top();
    open.pop();
    const bool may_be = is_inside ? first.beyond > 0.0 : first.beyond >= 0.0;
    if (!may_be) return Answer::no;
    const glm::dvec3 center = 0.5 * (first.box.lo + first.box.hi), edges = first.box.hi - first.box.lo;
    if ((snippet.evaluate(center, 0.0).f <= iso) != is_inside) return Answer::yes;
    const int axis = edges.x >= edges.y && edges.x >= edges.z ? 0 : edges.y >= edges.z ? 1 : 2;
    snippet::Box low = first.box, high = first.box;
    low.hi[axis] = high.lo[axis] = center[axis];
    open.push(part(low));
    open.push(part(high));
  }
  return Answer::open;
}

// ---- rounding ----

/// What rounding does at the points that were tried.
struct Doubts {
  std::size_t tried = 0;
  std::size_t open = 0;       ///< float32 may come to either side, though the exact value is not near iso
  std::size_t different = 0;  ///< of these: float32 did come to another value
  snippet::RoundingDoubt first;
  glm::dvec3 p{0.0};
  double t_ms = 0.0;
};

constexpr double near_surface = 0.01;  // of iso: there every function is open

/// Inner points, moved: many of them lie on thirds and fifths, where the cells of noise have their borders.
glm::vec3 point_beside(const glm::dvec3& inner) {
  const glm::dvec3 moved = 0.5 * (inner + 1.0) + glm::dvec3(0.41421356, 0.73205081, 0.23606798);
  return glm::vec3(2.0 * glm::fract(moved) - 1.0);
}

Doubts find_doubts(const Snippet& snippet, double iso) {
  constexpr std::size_t most_instructions = 10'000'000;
  Doubts doubts;
  const std::vector<double> times = snippet.uses_time() ? std::vector{0.0, 1000.0} : std::vector{0.0};
  const std::size_t most = most_instructions / std::max<std::size_t>(snippet.instruction_count() * times.size(), 1);
  const std::size_t count = std::min(inner_points().size(), std::max<std::size_t>(most, 50));
  for (const double t : times) {
    for (std::size_t i = 0; i < count; ++i) {
      const glm::vec3 p = point_beside(inner_points()[i]);
      snippet::RoundingDoubt doubt = snippet::rounding_doubt(snippet, p, static_cast<float>(t));
      ++doubts.tried;
      const bool is_open =
          doubt.bounds.lo <= iso && doubt.bounds.hi > iso && std::abs(doubt.exact - iso) > near_surface;
      if (!is_open) continue;
      ++doubts.open;
      doubts.different += std::abs(doubt.single - doubt.exact) > near_surface ? 1 : 0;
      const bool is_better = doubts.open == 1 || (doubts.first.jump.empty() && !doubt.jump.empty());
      if (!is_better) continue;
      doubts.first = std::move(doubt);
      doubts.p = p;
      doubts.t_ms = t;
    }
  }
  return doubts;
}

}  // namespace

void SourceLint::check(const Sdf& sdf) {
  if (const auto* function = std::get_if<Id<Function>>(&sdf.source)) {
    check_function(sdf, *function);
  } else {
    check_grid(sdf, at(module_.grids, std::get<Id<voml::Grid>>(sdf.source)));
  }
}

void SourceLint::check_function(const Sdf& sdf, Id<Function> id) {
  const Snippet& snippet = at(module_.functions, id).snippet;
  const Steepest steepest = steepest_gradient(snippet);
  const bool is_missing = report_missing_surface(sdf, id, steepest.norm);
  if (measured_[id.index]) return;
  measured_[id.index] = true;
  if (!is_missing || steepest.norm != 0.0) report_gradient(sdf, steepest, snippet.uses_time());
  if (!is_missing) check_rounding(sdf, snippet);
}

// ---- W0402 ----

SourceLint::Steepest SourceLint::steepest_gradient(const Snippet& snippet) const {
  Steepest steepest;
  for (const double t : snippet::probe_times(snippet.uses_time())) {
    for (const glm::dvec3& p : inner_points()) {
      const double norm = glm::length(snippet.differentiate(p, t).gradient);
      if (norm > steepest.norm) steepest = {norm, p, t};  // not NaN
    }
  }
  return steepest;
}

void SourceLint::report_gradient(const Sdf& sdf, const Steepest& steepest, bool uses_time) {
  if (steepest.norm > flattest_distance && steepest.norm <= steepest_distance) return;
  const std::string where = snippet::describe(steepest.p, steepest.t_ms, uses_time);
  diagnostics_.report(
      Code::distance_far_from_metric, sdf.span,
      steepest.norm > steepest_distance
          ? fmt::format(
                "the SDF '{}' changes by {:.3g} a unit at {}, where a distance changes by at most 1; divided by "
                "that number it would be a bound",
                sdf.name, steepest.norm, where)
          : fmt::format("the SDF '{}' changes by no more than {:.3g} a unit (at {}), where a distance changes by 1",
                        sdf.name, steepest.norm, where));
}

// ---- W0404 ----

/// Samples must all be on one side, at all times; and either intervals prove the rest, or they do not disprove it and
/// the samples stay farther from iso than the function changes between them.
bool SourceLint::report_missing_surface(const Sdf& sdf, Id<Function> id, double steepest) {
  const Snippet& snippet = at(module_.functions, id).snippet;
  Extremes all;
  for (const double t : lint_times(snippet.uses_time())) {
    include(all, samples_.at(id, t));
    if (all.any_nan || (all.least <= sdf.iso && all.most > sdf.iso)) return false;  // NaN: W0401 speaks of it
  }
  const bool is_inside = all.most <= sdf.iso;
  const Answer elsewhere = is_elsewhere(snippet, sdf.iso, is_inside);
  const double distance = is_inside ? sdf.iso - all.most : all.least - sdf.iso;
  const bool is_likely = steepest > flattest_distance && distance > steepest * widest_gap;
  if (elsewhere == Answer::yes || (elsewhere == Answer::open && !is_likely)) return false;
  report_one_side(sdf, all, is_inside, snippet.uses_time(), false);
  return true;
}

void SourceLint::report_one_side(const Sdf& sdf, const Extremes& extremes, bool is_inside, bool uses_time,
                                 bool is_grid) {
  const glm::dvec3& p = is_inside ? extremes.at_most : extremes.at_least;
  const std::string where =
      is_grid ? "" : " at " + snippet::describe(p, is_inside ? extremes.most_t_ms : extremes.least_t_ms, uses_time);
  const std::string offset = sdf.iso != 0.0 ? fmt::format(", and its offset is {:.6g}", sdf.iso) : "";
  diagnostics_.report(
      Code::surface_missing, sdf.span,
      fmt::format(
          "the SDF '{}' is {} everywhere: its {} {}{} is {:.6g}{}{}", sdf.name, is_inside ? "inside" : "outside",
          is_inside ? "largest" : "least", is_grid ? "sample" : "value in the standard cube [-1,1]^3", where,
          is_inside ? extremes.most : extremes.least, offset,
          is_inside
              ? "; it has no surface but the faces of that cube, and a shape of another size needs a scale"
              : "; nothing lies inside of it, and a shape of another size or place needs a scale or a translate"));
}

void SourceLint::check_grid(const Sdf& sdf, const voml::Grid& grid) {
  if (grid.values.empty()) return;
  Extremes all;
  const auto [least, most] = std::ranges::minmax_element(grid.values);
  all.least = *least;
  all.most = *most;
  if (all.least <= sdf.iso && all.most > sdf.iso) return;
  report_one_side(sdf, all, all.most <= sdf.iso, false, true);
}

// ---- W0406 ----

void SourceLint::check_rounding(const Sdf& sdf, const Snippet& snippet) {
  constexpr double least_share = 0.05;  // of the points
  const Doubts doubts = find_doubts(snippet, sdf.iso);
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(doubts.tried, 1));
  };
  const bool has_jump = !doubts.first.jump.empty();
  // Bounds alone may be open where no device is: 2.0 * floor(x) within mod. So float32 must have been seen to differ.
  if (share(has_jump ? doubts.open : doubts.different) < least_share || doubts.different == 0) return;
  const std::string where = snippet::describe(doubts.p, doubts.t_ms, snippet.uses_time());
  const std::string cause =
      has_jump
          ? fmt::format("{}, which float32 knows to within {:.2g} only", doubts.first.jump, doubts.first.operand_width)
          : fmt::format("float32 comes to {:.3g} where the value is {:.3g}", doubts.first.single, doubts.first.exact);
  diagnostics_.report(
      Code::rounding_decides, sdf.span,
      fmt::format(
          "the side of the SDF '{}' depends on rounding at {:.0f} % of the points of its cube, as at {}: {}; pictures "
          "differ between devices. op_noise of #include <sdf>, or a hash of integers, does not depend on it",
          sdf.name, 100.0 * share(doubts.open), where, cause));
}

}  // namespace dmvv::compiler
