#include "compiler/passes/content.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <map>
#include <optional>
#include <queue>

#include "base/parallel.h"
#include "compiler/grids/grid_bounds.h"
#include "compiler/grids/storage.h"
#include "compiler/ir/placements.h"
#include "compiler/ir/rounding.h"
#include "compiler/snippet/time_range.h"

namespace dmvv::compiler {

namespace {

constexpr int halvings = 5;                         // of each side: boxes are found to a 32nd of the cube's edge
constexpr std::size_t most_tests = 192;             // of boxes, towards each face;
constexpr std::size_t most_instructions = 400'000;  // of a large snippet in these
constexpr LocalBox cube{};
const LocalBox nothing{glm::dvec3(1.0), glm::dvec3(-1.0)};

bool is_nothing(const LocalBox& box) { return glm::any(glm::greaterThan(box.lo, box.hi)); }
LocalBox hull(const LocalBox& a, const LocalBox& b) {
  if (is_nothing(a)) return b;
  return is_nothing(b) ? a : LocalBox{glm::min(a.lo, b.lo), glm::max(a.hi, b.hi)};
}
LocalBox intersection(const LocalBox& a, const LocalBox& b) { return {glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)}; }

/// How far the boxes that are not empty reach along an axis, to the positive side or the other; none if all are. The
/// box that reaches farthest is halved first, and of such the smallest: if it is not empty, that is the end.
template <class IsEmpty>
std::optional<double> farthest(int axis, double sign, std::size_t most, const IsEmpty& is_empty) {
  struct Part {
    snippet::Box box;
    int cut = 0;
  };
  const auto reach = [&](const Part& part) { return sign * (sign > 0 ? part.box.hi : part.box.lo)[axis]; };
  const auto nearer = [&](const Part& a, const Part& b) {
    return reach(a) != reach(b) ? reach(a) < reach(b) : a.cut < b.cut;
  };
  std::priority_queue<Part, std::vector<Part>, decltype(nearer)> open(nearer);
  open.push({{cube.lo, cube.hi}});
  for (std::size_t tests = 0; !open.empty(); ++tests) {
    const Part part = open.top();
    open.pop();
    if (tests < most && is_empty(part.box)) continue;
    if (tests >= most || part.cut == 3 * halvings) return sign * reach(part);
    const int side = (axis + part.cut) % 3;
    Part low = part, high = part;
    low.cut = high.cut = part.cut + 1;
    low.box.hi[side] = high.box.lo[side] = 0.5 * (part.box.lo[side] + part.box.hi[side]);
    open.push(low);
    open.push(high);
  }
  return std::nullopt;
}

/// Where a function may be below iso.
LocalBox content_of(const snippet::Snippet& snippet, double iso) {
  const snippet::BoxFunction function(snippet, {-any_time_ms, any_time_ms});
  const std::size_t most =
      std::min(most_tests, most_instructions / std::max<std::size_t>(snippet.instruction_count(), 1));
  const double slack = float_unit * std::abs(iso);
  const auto is_empty = [&](const snippet::Box& box) { return function(box).lo > iso + slack; };
  LocalBox content;
  for (int axis = 0; axis < 3; ++axis) {
    const auto hi = farthest(axis, 1.0, most, is_empty);
    if (!hi) return nothing;
    content.hi[axis] = *hi;
    content.lo[axis] = farthest(axis, -1.0, most, is_empty).value_or(-1.0);
  }
  return content;
}

/// Likewise of a grid: a point's value lies between those of the samples around it.
LocalBox content_of(const voml::Grid& grid, double iso, TexelFormat format, Filter filter) {
  if (format != TexelFormat::r32f || filter == Filter::tricubic) return cube;
  const double most = iso + filter_error(grid_bounds(grid), iso, format, filter);
  glm::dvec3 first(std::numeric_limits<double>::infinity()), last(-first);
  std::size_t i = 0;
  for (std::uint32_t z = 0; z < grid.size.z; ++z) {
    for (std::uint32_t y = 0; y < grid.size.y; ++y) {
      for (std::uint32_t x = 0; x < grid.size.x; ++x, ++i) {
        if (grid.values[i] > most) continue;
        first = glm::min(first, glm::dvec3(x, y, z));
        last = glm::max(last, glm::dvec3(x, y, z));
      }
    }
  }
  if (first.x > last.x) return nothing;
  const glm::dvec3 units_per_sample = (grid.box_hi - grid.box_lo) / glm::dvec3(grid.size);
  const glm::dvec3 around = 1.0 + sample_error(grid, glm::dvec3(0.0));
  const glm::dvec3 lo = grid.box_lo + (first + 0.5 - around) * units_per_sample;
  const glm::dvec3 hi = grid.box_lo + (last + 0.5 + around) * units_per_sample;
  return intersection({lo, hi}, cube);
}

/// Of the points that a placement takes into the box, those in the standard cube.
LocalBox placed(const LocalBox& box, const Affine& local_from_outer) {
  if (is_nothing(box)) return nothing;
  const Affine back = inverse(local_from_outer);
  const glm::dvec3 error = float_error(local_from_outer, glm::dvec3(1.0));
  const glm::dvec3 center = back(0.5 * (box.lo + box.hi)), half = 0.5 * (box.hi - box.lo) + error;
  const glm::dvec3 exact =
      glm::abs(back.linear[0]) * half.x + glm::abs(back.linear[1]) * half.y + glm::abs(back.linear[2]) * half.z;
  const glm::dvec3 reach = exact * (1.0 + 1e-9) + 1e-12;
  return intersection({center - reach, center + reach}, cube);
}

class Trimming {
 public:
  Trimming(const Module& module) : module_(module), of_nodes_(module.nodes.size()) {}

  /// Where a tree has another answer than none.
  const LocalBox& of_tree(Id<Node> id) {
    std::optional<LocalBox>& known = of_nodes_[id.index];
    if (known) return *known;
    if (const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, id).content)) {
      const Region& answers = at(module_.regions, *region);
      return known.emplace(answers.number == 0 && answers.groups.empty() ? nothing : cube);
    }
    const auto& decision = std::get<Decision>(at(module_.nodes, id).content);
    const LocalBox negative = intersection(of_tree(decision.negative), of_sdf(at(module_.sdfs, decision.sdf)));
    return of_nodes_[id.index].emplace(hull(negative, of_tree(decision.positive)));
  }

 private:
  /// Where some placement's source may be negative.
  static LocalBox of_sdf(const Sdf& sdf) {
    if (sdf.placement == voml::Placement::tiled) return cube;
    LocalBox all = nothing;
    for (const Affine& affine : sdf.local_from_object) all = hull(all, placed(sdf.content, affine));
    return all;
  }

  const Module& module_;
  std::vector<std::optional<LocalBox>> of_nodes_;
};

}  // namespace

void trim_cubes(Module& module, TexelFormat format, Filter filter) {
  // Many SDFs share a source and an iso.
  std::map<std::pair<decltype(Sdf::source), double>, LocalBox> contents;
  for (const Sdf& sdf : module.sdfs) contents.try_emplace({sdf.source, sdf.iso});
  std::vector<decltype(contents)::value_type*> jobs;
  for (auto& job : contents) jobs.push_back(&job);
  in_parallel(jobs.size(), [&](std::size_t i) {
    const auto& [source, iso] = jobs[i]->first;
    const auto* function = std::get_if<Id<Function>>(&source);
    const LocalBox found = function
                               ? content_of(at(module.functions, *function).snippet, iso)
                               : content_of(at(module.grids, std::get<Id<voml::Grid>>(source)), iso, format, filter);
    jobs[i]->second = is_nothing(found) ? cube : found;  // rare, and not worth a case of its own
  });
  for (Sdf& sdf : module.sdfs) sdf.content = contents.at({sdf.source, sdf.iso});
  Trimming trimming(module);
  for (Object& object : module.objects) {
    const LocalBox content = trimming.of_tree(object.root);
    object.content = is_nothing(content) ? cube : content;
  }
}

}  // namespace dmvv::compiler
