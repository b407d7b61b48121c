#include "compiler/reference/reference.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "compiler/grids/grid_bounds.h"
#include "compiler/grids/sample.h"
#include "compiler/grids/storage.h"
#include "compiler/grids/texels.h"
#include "compiler/ir/placements.h"
#include "compiler/ir/rounding.h"
#include "compiler/layout/flatten.h"
#include "compiler/layout/lookup.h"
#include "compiler/reference/explanation.h"

namespace dmvv::compiler {

namespace {

constexpr std::size_t shortest_indexed_list = 8;
// Colours agree within 1e-3; of that, rounding a bitmap's values to rgba16f takes up to 2^-12.
constexpr double color_slack = 7e-4;

/// Whether a test passes, and whether float32 arithmetic must come to the same.
struct Tested {
  bool yes;
  bool certain;
};

/// A source against the iso value.
struct Below : Tested {
  double value;
};

Tested in_box(const Approximate& q, const glm::dvec3& lo, const glm::dvec3& hi) {
  // The bounds are rounded to float32 as well.
  const glm::dvec3 slack = q.error() + float_unit * glm::max(glm::abs(lo), glm::abs(hi));
  const bool inside = glm::all(glm::greaterThanEqual(q.p, lo)) && glm::all(glm::lessThanEqual(q.p, hi));
  const bool surely_in = glm::all(glm::greaterThan(q.p - slack, lo)) && glm::all(glm::lessThan(q.p + slack, hi));
  const bool surely_out = glm::any(glm::lessThan(q.p + slack, lo)) || glm::any(glm::greaterThan(q.p - slack, hi));
  return {inside, inside ? surely_in : surely_out};
}

Tested in_cube(const Approximate& q) { return in_box(q, glm::dvec3(-1.0), glm::dvec3(1.0)); }

/// Wraps into [-1,1)^3; certain unless a component is within its error of a seam.
Tested wrap(Approximate& q) {
  const glm::dvec3 turns = (q.p + 1.0) * 0.5;
  const glm::dvec3 to_seam = glm::abs(turns - glm::round(turns)) * 2.0;
  q.add_error(4.0 * float_unit * (glm::abs(q.p) + 1.0));
  q.p -= 2.0 * glm::floor(turns);
  return {true, glm::all(glm::greaterThan(to_seam, q.error()))};
}

/// Largest difference between neighbouring texels of a bitmap along each axis; it goes on at its opposite side; values
/// 0..1.
glm::dvec3 measure(const voml::Bitmap& bitmap) {
  const std::size_t n = bitmap.n;
  glm::ivec3 slope(0);
  const auto differ = [&](std::size_t a, std::size_t b) {
    const glm::ivec4 d = glm::abs(glm::ivec4(bitmap.texels[a]) - glm::ivec4(bitmap.texels[b]));
    return std::max({d.x, d.y, d.z, d.w});
  };
  for (std::size_t z = 0, i = 0; z < n; ++z) {
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t x = 0; x < n; ++x, ++i) {
        slope.x = std::max(slope.x, differ(i, (z * n + y) * n + (x + 1) % n));
        slope.y = std::max(slope.y, differ(i, (z * n + (y + 1) % n) * n + x));
        slope.z = std::max(slope.z, differ(i, ((z + 1) % n * n + y) * n + x));
      }
    }
  }
  return glm::dvec3(slope) / 255.0;
}

}  // namespace

struct Reference::Impl {
  const Module& module;
  Options options;
  std::vector<voml::Grid> stored;  // of each grid, unless the format keeps all values
  std::vector<GridBounds> bounds_of_grids;
  std::vector<glm::dvec3> bitmap_slopes;
  double bitmap_atlas_texels = 0.0;                        // no side of the bitmaps' atlas is longer
  std::vector<LocalBox> boxes;                             // of each SDF
  std::vector<std::optional<Lookup>> seeds;                // of each SDF
  std::vector<std::vector<std::optional<Lookup>>> groups;  // of each region and group

  Impl(const Module& m, Options o) : module(m), options(o) {
    if (options.format != TexelFormat::r32f) {
      const std::vector<double> scales = texel_scales(module, options.format, options.filter);
      for (std::size_t i = 0; i < scales.size(); ++i) {
        stored.push_back(as_stored(module.grids[i], options.format, scales[i]));
      }
    }
    for (std::uint32_t i = 0; i < module.grids.size(); ++i) bounds_of_grids.push_back(grid_bounds(grid_of({i})));
    for (const voml::Bitmap& bitmap : module.bitmaps) {
      bitmap_slopes.push_back(measure(bitmap));
      bitmap_atlas_texels += bitmap.n + 2.0;
    }
    for (const Sdf& sdf : module.sdfs) {
      boxes.push_back(local_box(sdf, module));
      seeds.emplace_back();
      if (indexed(sdf.local_from_object.size())) seeds.back() = build_lookup(placed_boxes(sdf, module), glm::uvec3(0));
    }
    for (const Region& region : module.regions) {
      groups.emplace_back();
      for (const CandidateGroup& group : region.groups) {
        groups.back().emplace_back();
        if (!indexed(group.candidates.size())) continue;
        groups.back().back() = build_lookup(placed_boxes(group, module), glm::uvec3(0), lookup_frame_error(group));
      }
    }
  }

  const voml::Grid& grid_of(Id<voml::Grid> id) const { return at(stored.empty() ? module.grids : stored, id); }

  bool indexed(std::size_t count) const { return options.use_index && count >= shortest_indexed_list; }

  /// Calls visit(index) for each entry that the lookup lists at p (all `count` without one) until it returns false.
  template <class Visit>
  static void for_each(const std::optional<Lookup>& lookup, std::size_t count, const glm::dvec3& p, Visit&& visit) {
    if (lookup) {
      for (const std::uint32_t i : lookup->at(p)) {
        if (!visit(i)) return;
      }
    } else {
      for (std::uint32_t i = 0; i < count; ++i) {
        if (!visit(i)) return;
      }
    }
  }

  /// f(q) <= iso at a local point inside its box.
  Below below_iso(const Sdf& sdf, const Approximate& q, double time_ms) const {
    if (const auto* id = std::get_if<Id<Function>>(&sdf.source)) {
      return function_below(at(module.functions, *id).snippet, q, sdf.iso, time_ms);
    }
    return grid_below(std::get<Id<voml::Grid>>(sdf.source), q, sdf.iso);
  }

  Below grid_below(Id<voml::Grid> id, const Approximate& q, double iso) const {
    const voml::Grid& grid = grid_of(id);
    const bool tricubic = options.filter == Filter::tricubic;
    const double value = tricubic ? sample_tricubic(grid, q.p) : sample(grid, q.p);
    const GridBounds& bounds = bounds_of_grids[id.index];
    const double error = glm::dot(sample_error(grid, q.error()), bounds.slope) * (tricubic ? tricubic_slope : 1.0) +
                         filter_error(bounds, iso, options.format, options.filter);
    return {{value <= iso, std::abs(value - iso) > error}, value};
  }

  /// Certain if an interval that encloses every float32 evaluation near q lies on one side of iso.
  static Below function_below(const snippet::Snippet& f, const Approximate& q, double iso, double time_ms) {
    const snippet::Value value = f.evaluate(q.p, time_ms);
    const bool below = value.finished && value.f <= iso;
    const snippet::Interval bounds =
        f.evaluate({q.p - q.error(), q.p + q.error()}, {time_ms, time_ms}, snippet::Rounding::float32);
    const double slack = float_unit * std::abs(iso);
    const bool one_side = below ? bounds.hi <= iso - slack : bounds.lo > iso + slack;
    return {{below, value.finished && !bounds.maybe_nan && one_side}, value.f};
  }

  /// Below iso at one placement: its box holds the point, and the source is negative there.
  Tested placed_negative(std::size_t sdf_index, const Affine& affine, const Approximate& p, double time_ms,
                         AskedPlacement* asked) const {
    const Sdf& sdf = module.sdfs[sdf_index];
    Approximate q = apply(affine, p);
    bool certain = true;
    if (sdf.placement == voml::Placement::tiled) certain = wrap(q).certain;
    const Tested held = in_box(q, boxes[sdf_index].lo, boxes[sdf_index].hi);
    if (asked) {
      asked->local = q.p;
      asked->held = held.yes;
    }
    if (!held.yes && held.certain) return {false, certain};
    const Below below = below_iso(sdf, q, time_ms);
    if (asked) asked->value = below.value;
    if (!held.yes) return {false, certain && below.certain && !below.yes};
    // A point in the box by a hair is certain all the same if the source is surely positive.
    return {below.yes, certain && below.certain && (held.certain || !below.yes)};
  }

  static std::optional<AskedCell> asked_cell(const std::optional<Lookup>& lookup, const glm::dvec3& p) {
    if (!lookup) return std::nullopt;
    return AskedCell{lookup->cell_of(p), lookup->size, static_cast<std::uint32_t>(lookup->at(p).size())};
  }

  Tested negative(Id<Sdf> id, const Approximate& p, double time_ms, AskedDecision* asked) const {
    const Sdf& sdf = at(module.sdfs, id);
    if (asked) asked->cell = asked_cell(seeds[id.index], p.p);
    bool any = false, any_certain = false, all_certain = true;
    for_each(seeds[id.index], sdf.local_from_object.size(), p.p, [&](std::uint32_t i) {
      AskedPlacement* const one = asked ? &asked->placements.emplace_back() : nullptr;
      const Tested placed = placed_negative(id.index, sdf.local_from_object[i], p, time_ms, one);
      if (one) {
        one->placement = i;
        one->negative = placed.yes;
        one->certain = placed.certain;
      }
      any = any || placed.yes;
      any_certain = any_certain || (placed.yes && placed.certain);
      all_certain = all_certain && placed.certain;
      return !any_certain;
    });
    return {any, any_certain || all_certain};
  }

  Id<Region> region_at(Id<Object> object, const Approximate& p, double time_ms, bool& certain, Visit* visit) const {
    Id<Node> node = at(module.objects, object).root;
    while (const auto* decision = std::get_if<Decision>(&at(module.nodes, node).content)) {
      AskedDecision* const asked = visit ? &visit->decisions.emplace_back() : nullptr;
      const Tested side = negative(decision->sdf, p, time_ms, asked);
      if (asked) {
        asked->sdf = decision->sdf;
        asked->negative = side.yes;
        asked->certain = side.certain;
      }
      certain = certain && side.certain;
      node = side.yes ? decision->negative : decision->positive;
    }
    return std::get<Id<Region>>(at(module.nodes, node).content);
  }

  /// Evaluates an object at a point of its cube. True if it is not empty there; then `out` has the answer. What is
  /// asked is told to `visits`, if that is given.
  bool evaluate(Id<Object> object, const Approximate& p, double time_ms, ReferenceAnswer& out,
                std::vector<Visit>* visits) const {
    Visit* const visit = visits ? &visits->emplace_back() : nullptr;
    const Id<Region> id = region_at(object, p, time_ms, out.certain, visit);
    const Region& region = at(module.regions, id);
    if (visit) {
      visit->object = object;
      visit->p = p.p;
      visit->region = id;
    }
    const bool answers = evaluate_region(id, region, p, time_ms, out, visit);
    if (visit) visit->answers = answers;
    return answers;
  }

  bool evaluate_region(Id<Region> id, const Region& region, const Approximate& p, double time_ms, ReferenceAnswer& out,
                       Visit* visit) const {
    out.path.push_back({id.index, 0});
    for (std::size_t g = 0; g < region.groups.size(); ++g) {
      AskedGroup* const asked = visit ? &visit->groups.emplace_back() : nullptr;
      if (ask_group(region.groups[g], groups[id.index][g], p, time_ms, out, asked)) return true;
    }
    if (region.number != 0) {
      out.path.back().candidate = 0;
      out.number = region.number;
      out.rgba = color(region, p, out.certain);
      return true;
    }
    out.path.pop_back();
    return false;
  }

  bool ask_group(const CandidateGroup& group, const std::optional<Lookup>& lookup, const Approximate& p, double time_ms,
                 ReferenceAnswer& out, AskedGroup* asked) const {
    Approximate in_frame = p;
    if (group.box_from_object) {
      in_frame = apply(*group.box_from_object, p);
      const Tested held = in_cube(in_frame);
      out.certain = out.certain && held.certain;
      if (asked) {
        asked->in_box = in_frame.p;
        asked->held = held.yes;
        asked->certain = held.certain;
      }
      if (!held.yes) return false;
    }
    if (asked) asked->cell = asked_cell(lookup, in_frame.p);
    const std::size_t level = out.path.size() - 1;
    bool found = false;
    for_each(lookup, group.candidates.size(), in_frame.p, [&](std::uint32_t i) {
      out.path[level].candidate = group.first_number + i;
      AskedCandidate* const one = asked ? &asked->candidates.emplace_back() : nullptr;
      if (one) one->number = group.first_number + i;
      found = ask(group.candidates[i], p, time_ms, out, one);
      return !found;
    });
    return found;
  }

  bool ask(const Candidate& candidate, const Approximate& p, double time_ms, ReferenceAnswer& out,
           AskedCandidate* asked) const {
    Approximate q = apply(candidate.local_from_parent, p);
    const Tested held = candidate.tiled ? wrap(q) : in_cube(q);
    out.certain = out.certain && held.certain;
    if (asked) {
      asked->object = candidate.object;
      asked->local = q.p;
      asked->held = held.yes;
      asked->certain = held.certain;
    }
    return held.yes && evaluate(candidate.object, q, time_ms, out, asked ? &asked->visit : nullptr);
  }

  glm::dvec4 color(const Region& region, const Approximate& p, bool& certain) const {
    if (region.kind != voml::RegionKind::bitmap) return {region.rgb, region.opacity};
    const voml::Bitmap& bitmap = at(module.bitmaps, region.bitmap);
    const Approximate q = apply(region.texture_from_object, p);
    const glm::dvec3 wrapped_error = q.error() + 4.0 * float_unit * (glm::abs(q.p) + 1.0);
    const glm::dvec3 texel_error = wrapped_error * (0.5 * bitmap.n) + 6.0 * float_unit * bitmap_atlas_texels;
    certain = certain && glm::dot(texel_error, bitmap_slopes[region.bitmap.index]) < color_slack;
    const glm::dvec4 texel = wrapped_texel(bitmap, q.p);
    return {glm::dvec3(texel), texel.a * region.opacity};
  }

  /// Trilinear with wrap-around; the cube [-1,1) of q is the bitmap once.
  static glm::dvec4 wrapped_texel(const voml::Bitmap& bitmap, const glm::dvec3& q) {
    const double n = bitmap.n;
    const glm::dvec3 u = (q + 1.0) * 0.5;
    const glm::dvec3 c = (u - glm::floor(u)) * n - 0.5;
    const glm::dvec3 base = glm::floor(c);
    const glm::dvec3 w = c - base;
    const auto texel = [&](int dx, int dy, int dz) {
      const glm::ivec3 i = (glm::ivec3(base) + glm::ivec3(dx, dy, dz) + glm::ivec3(bitmap.n)) % glm::ivec3(bitmap.n);
      return glm::dvec4(bitmap.texels[(std::size_t(i.z) * bitmap.n + i.y) * bitmap.n + i.x]) / 255.0;
    };
    const glm::dvec4 v00 = glm::mix(texel(0, 0, 0), texel(1, 0, 0), w.x);
    const glm::dvec4 v10 = glm::mix(texel(0, 1, 0), texel(1, 1, 0), w.x);
    const glm::dvec4 v01 = glm::mix(texel(0, 0, 1), texel(1, 0, 1), w.x);
    const glm::dvec4 v11 = glm::mix(texel(0, 1, 1), texel(1, 1, 1), w.x);
    return glm::mix(glm::mix(v00, v10, w.y), glm::mix(v01, v11, w.y), w.z);
  }
};

Reference::Reference(const Module& module) : Reference(module, Options{}) {}
Reference::Reference(const Module& module, Options options) : impl_(std::make_unique<Impl>(module, options)) {}
Reference::Reference(Reference&&) noexcept = default;
Reference::~Reference() = default;

namespace {

template <class Evaluate>
ReferenceAnswer evaluate_root(const glm::dvec3& p, const Evaluate& evaluate) {
  ReferenceAnswer answer;
  const Approximate root = rounded(p);
  const Tested held = in_cube(root);
  answer.certain = held.certain;
  if (held.yes) evaluate(root, answer);
  return answer;
}

}  // namespace

ReferenceAnswer Reference::evaluate(const glm::dvec3& p, double time_ms) const {
  return evaluate_root(p, [&](const Approximate& root, ReferenceAnswer& answer) {
    impl_->evaluate(impl_->module.root, root, time_ms, answer, nullptr);
  });
}

ReferenceAnswer Reference::evaluate(const glm::dvec3& p, double time_ms, std::vector<Visit>& visits) const {
  return evaluate_root(p, [&](const Approximate& root, ReferenceAnswer& answer) {
    impl_->evaluate(impl_->module.root, root, time_ms, answer, &visits);
  });
}

}  // namespace dmvv::compiler
