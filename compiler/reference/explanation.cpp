#include "compiler/reference/explanation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "compiler/grids/sample.h"
#include "compiler/grids/storage.h"
#include "compiler/ir/placements.h"
#include "compiler/layout/flatten.h"

namespace dmvv::compiler {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double grid_step = 1e-4;  // of the grid's box, for differences

/// How far, in units of the root, a point may go before a component leaves, or all that are outside enter, the box.
/// `local_from_root` is the linear part of the way.
double distance_to_faces(const glm::dvec3& q, const LocalBox& box, const glm::dmat3& local_from_root) {
  const glm::dmat3 rows = glm::transpose(local_from_root);
  double inside = infinity, outside = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double unit = glm::length(rows[i]);
    const double depth = std::min(q[i] - box.lo[i], box.hi[i] - q[i]);
    if (depth < 0.0) outside = std::max(outside, -depth / unit);
    inside = std::min(inside, depth / unit);
  }
  return outside > 0.0 ? outside : std::max(inside, 0.0);
}

class Distances {
 public:
  Distances(const Module& module, Filter filter, double time_ms)
      : module_(module), filter_(filter), time_ms_(time_ms) {}

  /// Fills in the distances of a visit and all below it.
  void measure(Visit& visit, const glm::dmat3& object_from_root) {
    for (AskedDecision& decision : visit.decisions) measure(decision, visit.object, object_from_root);
    const Region& region = at(module_.regions, visit.region);
    for (std::size_t g = 0; g < visit.groups.size(); ++g) {
      measure(visit.groups[g], region.groups[g], visit, object_from_root);
    }
  }

  void add(double distance, const std::string& what) {
    if (distance < nearest.distance || nearest.what.empty()) nearest = {what, distance};
  }

  NearestTest nearest{"", infinity};

 private:
  void measure(AskedDecision& decision, Id<Object> object, const glm::dmat3& object_from_root) {
    const Sdf& sdf = at(module_.sdfs, decision.sdf);
    // Inside a union one has to leave every part; outside, to enter one.
    decision.distance = decision.negative ? 0.0 : infinity;
    for (AskedPlacement& asked : decision.placements) {
      const glm::dmat3 local_from_root = sdf.local_from_object[asked.placement].linear * object_from_root;
      asked.distance = distance_of(asked, sdf, local_from_root);
      if (asked.negative == decision.negative) {
        decision.distance = decision.negative ? std::max(decision.distance, asked.distance)
                                              : std::min(decision.distance, asked.distance);
      }
    }
    add(decision.distance, fmt::format("SDF {} of {}", sdf.name, at(module_.objects, object).name));
  }

  double distance_of(const AskedPlacement& asked, const Sdf& sdf, const glm::dmat3& local_from_root) const {
    const double to_faces = distance_to_faces(asked.local, local_box(sdf, module_), local_from_root);
    if (!asked.held) return to_faces;
    const glm::dvec3 gradient = glm::transpose(local_from_root) * gradient_of(sdf, asked.local);
    const double steepness = glm::length(gradient);
    const double off = std::abs(asked.value.value_or(0.0) - sdf.iso);
    const double to_surface = off == 0.0 ? 0.0 : steepness > 0.0 ? off / steepness : infinity;
    // Outside, the faces are no boundary: beyond them it is positive too.
    return asked.negative ? std::min(to_surface, to_faces) : to_surface;
  }

  glm::dvec3 gradient_of(const Sdf& sdf, const glm::dvec3& q) const {
    if (const auto* function = std::get_if<Id<Function>>(&sdf.source)) {
      return at(module_.functions, *function).snippet.differentiate(q, time_ms_).gradient;
    }
    const voml::Grid& grid = at(module_.grids, std::get<Id<voml::Grid>>(sdf.source));
    glm::dvec3 gradient(0.0);
    for (int i = 0; i < 3; ++i) {
      glm::dvec3 step(0.0);
      step[i] = grid_step * (grid.box_hi[i] - grid.box_lo[i]);
      const auto value = [&](const glm::dvec3& at) {
        return filter_ == Filter::tricubic ? sample_tricubic(grid, at) : sample(grid, at);
      };
      gradient[i] = (value(q + step) - value(q - step)) / (2.0 * step[i]);
    }
    return gradient;
  }

  void measure(AskedGroup& asked, const CandidateGroup& group, const Visit& visit, const glm::dmat3& object_from_root) {
    if (asked.in_box) {
      asked.distance = distance_to_faces(*asked.in_box, {}, group.box_from_object->linear * object_from_root);
      add(asked.distance, fmt::format("the INDEX of {}", at(module_.regions, visit.region).name));
    }
    for (AskedCandidate& candidate : asked.candidates) {
      const Candidate& embedded = group.candidates[candidate.number - group.first_number];
      const glm::dmat3 local_from_root = embedded.local_from_parent.linear * object_from_root;
      candidate.distance = embedded.tiled ? infinity : distance_to_faces(candidate.local, {}, local_from_root);
      if (!embedded.tiled) {
        add(candidate.distance,
            fmt::format("the cube of {} [{}]", at(module_.objects, candidate.object).name, candidate.number));
      }
      for (Visit& inside : candidate.visit) measure(inside, local_from_root);
    }
  }

  const Module& module_;
  Filter filter_;
  double time_ms_;
};

}  // namespace

Explanation explain(const Module& module, const Reference& reference, Filter filter, const glm::dvec3& p,
                    double time_ms) {
  Explanation result;
  result.answer = reference.evaluate(p, time_ms, result.visit);
  Distances distances(module, filter, time_ms);
  distances.add(distance_to_faces(p, {}, glm::dmat3(1.0)),
                fmt::format("the cube of {}", at(module.objects, module.root).name));
  for (Visit& visit : result.visit) distances.measure(visit, glm::dmat3(1.0));
  result.nearest = distances.nearest;
  return result;
}

}  // namespace dmvv::compiler
