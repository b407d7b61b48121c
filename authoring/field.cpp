#include "authoring/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <set>

#include "compiler/grids/sample.h"
#include "compiler/ir/placements.h"
#include "compiler/layout/flatten.h"
#include "compiler/layout/lookup.h"
#include "compiler/reference/reference.h"

namespace dmvv::authoring {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double beyond = 4.0;  // the cube's diagonal is 3.46 long
constexpr std::size_t shortest_indexed_list = 8;

// ---- names ----

/// The SDFs that the tree of an object uses, each once.
std::vector<Id<compiler::Sdf>> sdfs_of(const compiler::Module& module, const compiler::Object& object) {
  std::vector<Id<compiler::Sdf>> found;
  std::vector<bool> seen(module.nodes.size());
  std::vector<Id<compiler::Node>> pending{object.root};
  while (!pending.empty()) {
    const Id<compiler::Node> id = pending.back();
    pending.pop_back();
    if (seen[id.index]) continue;
    seen[id.index] = true;
    const auto* decision = std::get_if<compiler::Decision>(&at(module.nodes, id).content);
    if (decision == nullptr) continue;
    if (std::ranges::find(found, decision->sdf) == found.end()) found.push_back(decision->sdf);
    pending.push_back(decision->positive);
    pending.push_back(decision->negative);
  }
  return found;
}

// ---- boxes ----

struct Box {
  glm::dvec3 lo{infinity}, hi{-infinity};
  bool empty() const { return lo.x > hi.x; }
  void hold(const glm::dvec3& p) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  bool holds(const glm::dvec3& a, const glm::dvec3& b) const {
    return glm::all(glm::lessThanEqual(lo, a)) && glm::all(glm::greaterThanEqual(hi, b));
  }
};

/// The box of a placement without the faces that the object's cube does not reach: those end nothing. A wrapped point
/// reaches no face of the cube either.
Box ending_box(const compiler::Affine& local_from_object, const compiler::LocalBox& box, bool tiled) {
  constexpr double rounding = 1e-12;
  Box result{box.lo, box.hi};
  for (int axis = 0; axis < 3; ++axis) {
    double reach = 0.0;
    for (int column = 0; column < 3; ++column) reach += std::abs(local_from_object.linear[column][axis]);
    const double middle = tiled ? 0.0 : local_from_object.translation[axis];
    if (tiled) reach = 1.0;
    if (middle - reach >= box.lo[axis] - rounding) result.lo[axis] = -infinity;
    if (middle + reach <= box.hi[axis] + rounding) result.hi[axis] = infinity;
  }
  return result;
}

}  // namespace

Result<Id<compiler::Sdf>> find_sdf(const compiler::Module& module, const std::string& name) {
  std::vector<std::string> known;
  std::vector<std::string> users;
  std::set<Id<compiler::Sdf>> matching;
  for (const compiler::Object& object : module.objects) {
    const bool is_root = &object == &at(module.objects, module.root);
    for (const Id<compiler::Sdf> id : sdfs_of(module, object)) {
      const std::string& own = at(module.sdfs, id).name;
      if (std::ranges::find(known, own) == known.end()) known.push_back(own);
      if (own != name) continue;
      if (is_root) return id;
      users.push_back(object.name);
      matching.insert(id);
    }
  }
  if (matching.size() == 1) return *matching.begin();
  if (!matching.empty()) {
    std::ranges::sort(users);
    return fail(Fault::input, fmt::format("several objects have an SDF '{}'", name),
                {fmt::format("choose one with --root: {}", fmt::join(users, ", "))});
  }
  const std::vector<std::string_view> candidates(known.begin(), known.end());
  const auto near = nearest_name(name, candidates);
  std::vector<std::string> reasons;
  if (near) reasons.push_back(fmt::format("did you mean '{}'?", *near));
  reasons.push_back(known.empty() ? "the objects that the root reaches decide by no SDF"
                                  : fmt::format("what the root reaches decides by: {}", fmt::join(known, ", ")));
  return fail(Fault::input, fmt::format("no object that the root reaches decides by an SDF '{}'", name),
              std::move(reasons));
}

struct Field::Impl {
  const compiler::Module& module;
  const compiler::Sdf& sdf;
  double time_ms;
  compiler::LocalBox source_box;
  std::vector<Box> ends;  // of each placement
  std::optional<compiler::Lookup> lookup;
  double far = std::numeric_limits<float>::max();  // where the lookup knows of no box

  Impl(const compiler::Module& m, Id<compiler::Sdf> id, double t, double reach)
      : module(m), sdf(at(m.sdfs, id)), time_ms(t), source_box(compiler::local_box(sdf, m)) {
    const bool tiled = sdf.placement == voml::Placement::tiled;
    for (const compiler::Affine& affine : sdf.local_from_object) ends.push_back(ending_box(affine, source_box, tiled));
    if (tiled || sdf.local_from_object.size() < shortest_indexed_list) return;
    std::vector<compiler::PlacedBox> boxes = compiler::placed_boxes(sdf, m);
    for (compiler::PlacedBox& box : boxes) {
      glm::dvec3 widening;
      for (int axis = 0; axis < 3; ++axis) {
        const glm::dmat3 rows = glm::transpose(box.local_from_frame.linear);
        widening[axis] = reach * glm::length(rows[axis]);
      }
      box.lo -= widening;
      box.hi += widening;
      far = std::min({far, widening.x, widening.y, widening.z});  // the greatest distance that it knows
    }
    lookup = compiler::build_lookup(boxes, glm::uvec3(0));
  }

  /// At a local point of the source's box, iso taken off; may be anything.
  double source(const glm::dvec3& q) const {
    if (const auto* grid = std::get_if<Id<voml::Grid>>(&sdf.source)) {
      return compiler::sample(at(module.grids, *grid), q) - sdf.iso;
    }
    const auto value = at(module.functions, std::get<Id<compiler::Function>>(sdf.source)).snippet.evaluate(q, time_ms);
    return value.f - sdf.iso;
  }

  glm::dvec3 local(const compiler::Affine& affine, const glm::dvec3& p) const {
    glm::dvec3 q = affine(p);
    if (sdf.placement == voml::Placement::tiled) q -= 2.0 * glm::floor((q + 1.0) * 0.5);
    return q;
  }

  double placed(std::size_t i, const glm::dvec3& p, bool& finite) const {
    const glm::dvec3 q = local(sdf.local_from_object[i], p);
    const Box& end = ends[i];
    const glm::dvec3 nearest = glm::clamp(q, end.lo, end.hi);
    double value = source(nearest);
    if (!(std::abs(value) <= std::numeric_limits<float>::max())) {
      value = value < 0.0 ? -beyond : beyond;
      finite = false;
    }
    const double outside = glm::distance(q, nearest);
    if (outside > 0.0) return std::max(value, 0.0) + outside;
    const glm::dvec3 depth = glm::min(q - end.lo, end.hi - q);
    return std::max(value, -std::min({depth.x, depth.y, depth.z}));
  }

  template <class Visit>
  void for_each_placement(const glm::dvec3& p, Visit visit) const {
    if (lookup) {
      for (const std::uint32_t i : lookup->at(p)) visit(i);
    } else {
      for (std::size_t i = 0; i < ends.size(); ++i) visit(i);
    }
  }

  /// Where the source can be negative, in its own frame.
  Box local_inside() const {
    Box inside;
    if (const auto* id = std::get_if<Id<voml::Grid>>(&sdf.source)) {
      hold_negative(at(module.grids, *id), inside);
    } else {
      constexpr int levels = 6;
      hold_negative(source_box.lo, source_box.hi, levels, inside);
    }
    return inside;
  }

  /// A trilinear interpolant is negative only next to a negative sample.
  void hold_negative(const voml::Grid& grid, Box& inside) const {
    const glm::dvec3 step = (grid.box_hi - grid.box_lo) / glm::dvec3(grid.size);
    std::size_t i = 0;
    for (std::uint32_t z = 0; z < grid.size.z; ++z) {
      for (std::uint32_t y = 0; y < grid.size.y; ++y) {
        for (std::uint32_t x = 0; x < grid.size.x; ++x, ++i) {
          if (!(grid.values[i] <= sdf.iso)) continue;
          const glm::dvec3 corner = grid.box_lo + glm::dvec3(x, y, z) * step;
          inside.hold(glm::max(corner - 0.5 * step, grid.box_lo));
          inside.hold(glm::min(corner + 1.5 * step, grid.box_hi));
        }
      }
    }
  }

  /// Halves the box along all axes until it is decided, known already, or small.
  void hold_negative(const glm::dvec3& lo, const glm::dvec3& hi, int levels, Box& inside) const {
    if (!inside.empty() && inside.holds(lo, hi)) return;
    const auto& snippet = at(module.functions, std::get<Id<compiler::Function>>(sdf.source)).snippet;
    const auto bounds =
        snippet.evaluate(compiler::snippet::Box{lo, hi}, {time_ms, time_ms}, compiler::snippet::Rounding::real);
    if (bounds.lo > sdf.iso) return;
    if (levels == 0) {
      inside.hold(lo);
      inside.hold(hi);
      return;
    }
    const glm::dvec3 middle = 0.5 * (lo + hi);
    for (int child = 0; child < 8; ++child) {
      const glm::bvec3 upper(child & 1, child & 2, child & 4);
      hold_negative(glm::mix(lo, middle, upper), glm::mix(middle, hi, upper), levels - 1, inside);
    }
  }
};

Field::Field(const compiler::Module& module, Id<compiler::Sdf> sdf, double time_ms, double reach)
    : impl_(std::make_unique<Impl>(module, sdf, time_ms, reach)) {}
Field::Field(Field&&) noexcept = default;
Field::~Field() = default;

Field::Value Field::evaluate(const glm::dvec3& p) const {
  Value least{impl_->far, true};
  impl_->for_each_placement(
      p, [&](std::size_t i) { least.value = std::min(least.value, impl_->placed(i, p, least.finite)); });
  return least;
}

std::optional<voml::Bounds> Field::inside() const {
  const Box local = impl_->local_inside();
  if (local.empty()) return std::nullopt;
  if (impl_->sdf.placement == voml::Placement::tiled) return voml::Bounds{glm::dvec3(-1.0), glm::dvec3(1.0)};
  Box inside;
  for (const compiler::Affine& local_from_object : impl_->sdf.local_from_object) {
    const compiler::Affine object_from_local = compiler::inverse(local_from_object);
    Box placed;
    for (int corner = 0; corner < 8; ++corner) {
      placed.hold(object_from_local(glm::mix(local.lo, local.hi, glm::bvec3(corner & 1, corner & 2, corner & 4))));
    }
    placed.lo = glm::max(placed.lo, -1.0);
    placed.hi = glm::min(placed.hi, 1.0);
    if (glm::any(glm::greaterThan(placed.lo, placed.hi))) continue;  // outside the object's cube
    inside.hold(placed.lo);
    inside.hold(placed.hi);
  }
  if (inside.empty()) return std::nullopt;
  return voml::Bounds{inside.lo, inside.hi};
}

}  // namespace dmvv::authoring
