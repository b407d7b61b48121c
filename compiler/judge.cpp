// One box, all ways through the scene that it leaves open.
#include "compiler/judge.h"

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <limits>
#include <optional>
#include <span>

#include "compiler/grid_range.h"
#include "compiler/reference.h"
#include "compiler/rounding.h"
#include "compiler/texels.h"

namespace dmvv::compiler {

namespace {

constexpr std::uint32_t most_cells = 64;  // of a lookup grid, that a box may touch
constexpr double infinity = std::numeric_limits<double>::infinity();

enum class Side { negative, positive, open };
enum class Held { inside, outside, partly };
enum class Answers { always, never, sometimes };  ///< an object, at the points of a box

glm::dvec3 abs_times(const glm::dmat3& m, const glm::dvec3& v) {
  return glm::abs(m[0]) * v.x + glm::abs(m[1]) * v.y + glm::abs(m[2]) * v.z;
}

/// The points of the box as they arrive in some frame.
struct Spot {
  Affine frame_from_root;
  ErrorBound error;
  glm::dvec3 center, half;  ///< their bounds in the frame, the device's errors included

  void set_bounds(const snippet::Box& root) {
    center = frame_from_root(0.5 * (root.lo + root.hi));
    half = abs_times(frame_from_root.linear, 0.5 * (root.hi - root.lo)) + error.component;
  }
};

Held held_by(const Spot& q, const glm::dvec3& lo, const glm::dvec3& hi) {
  const glm::dvec3 half = q.half + float_unit * glm::max(glm::abs(lo), glm::abs(hi));  // the bounds are rounded as well
  const glm::dvec3 least = q.center - half, most = q.center + half;
  if (glm::any(glm::lessThan(most, lo)) || glm::any(glm::greaterThan(least, hi))) return Held::outside;
  const bool inside = glm::all(glm::greaterThan(least, lo)) && glm::all(glm::lessThan(most, hi));
  return inside ? Held::inside : Held::partly;
}

Held held_by_cube(const Spot& q) { return held_by(q, glm::dvec3(-1.0), glm::dvec3(1.0)); }

}  // namespace

struct Judge::Impl {
  Module module;
  Records records;
  Options options;
  std::vector<GridRange> ranges;  ///< of each grid
  std::vector<LocalBox> boxes;    ///< of each SDF
  std::vector<bool> animated;     ///< each function
  bool any_animated = false;
  Times always;

  Impl(Module m, Records r, const Options& o) : module(std::move(m)), records(std::move(r)), options(o) {
    if (options.format != TexelFormat::r32f) {
      const std::vector<double> scales = texel_scales(module, options.format, options.filter);
      for (std::size_t i = 0; i < scales.size(); ++i) {
        module.grids[i] = as_stored(module.grids[i], options.format, scales[i]);
      }
    }
    for (const voml::Grid& grid : module.grids) ranges.emplace_back(grid);
    for (const Sdf& sdf : module.sdfs) boxes.push_back(local_box(sdf, module));
    for (const Function& function : module.functions) {
      animated.push_back(function.snippet.uses_time());
      any_animated = any_animated || animated.back();
    }
    always = prepare(module, {-infinity, infinity});
  }
};

namespace {

/// The judgement of one box.
class Case {
 public:
  Case(const Judge::Impl& judge, std::span<const snippet::BoxFunction> functions, const snippet::Box& box)
      : judge_(judge), module_(judge.module), functions_(functions), box_(box) {}

  Verdict run() {
    Spot root{};
    root.set_bounds(box_);
    if (evaluate(module_.root, root) != Answers::always) add_outcome({}, {});
    Verdict verdict;
    verdict.decided = !given_up_ && !conflict_;
    verdict.moves = given_up_ ? judge_.any_animated : conflict_ && moves_;
    if (verdict.decided) {
      verdict.region = outcome_->region;
      verdict.texture_from_root = outcome_->texture_from_root;
    }
    return verdict;
  }

 private:
  struct Outcome {
    Id<Region> region;
    Affine texture_from_root;
    friend bool operator==(const Outcome&, const Outcome&) = default;
  };

  void add_outcome(Id<Region> region, const Affine& texture_from_root) {
    const Outcome outcome{region, texture_from_root};
    conflict_ = conflict_ || (outcome_ && *outcome_ != outcome);
    if (!outcome_) outcome_ = outcome;
  }

  /// Nothing that follows can change what is said.
  bool is_over() const { return given_up_ || (conflict_ && (moves_ || !judge_.any_animated)); }

  void test() { given_up_ = given_up_ || ++tests_ > Judge::most_tests; }

  Spot enter(const Affine& step, const Spot& from) {
    test();
    Spot q{step * from.frame_from_root, carry(step, from.error, float_error(step, glm::abs(from.center) + from.half)), {}, {}};
    q.set_bounds(box_);
    return q;
  }

  /// Wraps into [-1,1)^3. False if the box meets a seam.
  static bool wrap(Spot& q) {
    const glm::dvec3 added = 4.0 * float_unit * (glm::abs(q.center) + q.half + 1.0);
    q.half += added;
    q.error.component += added;
    q.error.length += glm::length(added);
    const glm::dvec3 turns = glm::floor((q.center + 1.0) * 0.5);
    q.center -= 2.0 * turns;
    q.frame_from_root.translation -= 2.0 * turns;
    return held_by_cube(q) == Held::inside;
  }

  // ---- lists ----

  /// What a lookup lists for the cells that a box touches, ascending; none if it touches too many.
  std::optional<std::vector<std::uint32_t>> listed(const gpu::LookupRecord& lookup, const Spot& q) {
    const glm::dvec3 lo(lookup.lo), per_unit(lookup.cells_per_unit);
    const glm::dvec3 last = glm::dvec3(lookup.size_x, lookup.size_y, lookup.size_z) - 1.0;
    const auto cell = [&](const glm::dvec3& p) { return glm::uvec3(glm::clamp(glm::floor((p - lo) * per_unit), glm::dvec3(0.0), last)); };
    const glm::uvec3 first = cell(q.center - q.half), end = cell(q.center + q.half) + 1u;
    const glm::u64vec3 width(end - first);
    if (width.x * width.y * width.z > most_cells) return std::nullopt;
    std::vector<std::uint32_t> all;
    for (std::uint32_t z = first.z; z < end.z; ++z) {
      for (std::uint32_t y = first.y; y < end.y; ++y) {
        for (std::uint32_t x = first.x; x < end.x; ++x) {
          const std::size_t c = lookup.first_cell + (std::size_t{z} * lookup.size_y + y) * lookup.size_x + x;
          const auto lists = judge_.records.lists.begin();
          all.insert(all.end(), lists + judge_.records.cells[c], lists + judge_.records.cells[c + 1]);
        }
      }
    }
    if (width != glm::u64vec3(1)) {
      std::sort(all.begin(), all.end());
      all.erase(std::unique(all.begin(), all.end()), all.end());
    }
    return all;
  }

  // ---- decisions ----

  bool is_animated(const Sdf& sdf) const {
    const auto* function = std::get_if<Id<Function>>(&sdf.source);
    return function != nullptr && judge_.animated[function->index];
  }

  Side decide(Id<Sdf> id, const Spot& p) {
    const Sdf& sdf = at(module_.sdfs, id);
    const Side side = sdf.placement == voml::Placement::seeded ? decide_seeded(id, sdf, p) : decide_placed(id, sdf, p);
    moves_ = moves_ || (side == Side::open && is_animated(sdf));
    return side;
  }

  Side decide_placed(Id<Sdf> id, const Sdf& sdf, const Spot& p) {
    Spot q = enter(sdf.local_from_object.front(), p);
    if (sdf.placement == voml::Placement::tiled && !wrap(q)) return Side::open;
    return decide_source(id, sdf, q);
  }

  Side decide_seeded(Id<Sdf> id, const Sdf& sdf, const Spot& p) {
    const auto seeds = listed(judge_.records.sdfs[id.index].lookup, p);
    if (!seeds) {
      given_up_ = true;
      return Side::open;
    }
    Side all = Side::positive;
    for (const std::uint32_t i : *seeds) {
      if (given_up_) break;
      const Side one = decide_source(id, sdf, enter(sdf.local_from_object[i], p));
      if (one == Side::negative) return one;
      if (one == Side::open) all = one;
    }
    return all;
  }

  Side decide_source(Id<Sdf> id, const Sdf& sdf, const Spot& q) {
    const LocalBox& domain = judge_.boxes[id.index];
    const Held held = held_by(q, domain.lo, domain.hi);
    if (held == Held::outside) return Side::positive;
    const Range value = range_of(sdf, q, domain);
    if (value.lo > sdf.iso) return Side::positive;
    return held == Held::inside && value.hi <= sdf.iso ? Side::negative : Side::open;
  }

  /// Of f over the part of the box in the domain, its errors included; a value that may be NaN is above any iso.
  Range range_of(const Sdf& sdf, const Spot& q, const LocalBox& domain) const {
    const glm::dvec3 rounding = float_unit * glm::max(glm::abs(domain.lo), glm::abs(domain.hi));
    const glm::dvec3 lo = glm::max(q.center - q.half, domain.lo - rounding);
    const glm::dvec3 hi = glm::min(q.center + q.half, domain.hi + rounding);
    if (const auto* id = std::get_if<Id<Function>>(&sdf.source)) {
      const snippet::Interval f = functions_[id->index]({glm::min(lo, hi), glm::max(lo, hi)});
      const double slack = float_unit * std::abs(sdf.iso);
      return {f.lo - slack, f.maybe_nan ? infinity : f.hi + slack};
    }
    return range_of_grid(std::get<Id<voml::Grid>>(sdf.source), sdf.iso, lo, hi);
  }

  Range range_of_grid(Id<voml::Grid> id, double iso, const glm::dvec3& lo, const glm::dvec3& hi) const {
    const voml::Grid& grid = at(module_.grids, id);
    const GridRange& range = judge_.ranges[id.index];
    const glm::dvec3 samples_per_unit = glm::dvec3(grid.size) / (grid.box_hi - grid.box_lo);
    const glm::dvec3 error = sample_error(grid, glm::dvec3(0.0));
    const glm::dvec3 a = (lo - grid.box_lo) * samples_per_unit - 0.5 - error;
    const glm::dvec3 b = (hi - grid.box_lo) * samples_per_unit - 0.5 + error;
    const double slack = filter_error(range.bounds(), iso, judge_.options.format, judge_.options.filter);
    if (judge_.options.filter == Filter::tricubic) {
      const double middle = sample_tricubic(grid, 0.5 * (lo + hi));
      const double reach = tricubic_slope * glm::dot(0.5 * (b - a), range.bounds().slope) + slack;
      return {middle - reach, middle + reach};
    }
    const Range exact = range.over(a, b);
    return {exact.lo - slack, exact.hi + slack};
  }

  // ---- objects ----

  Answers evaluate(Id<Object> object, const Spot& p) { return follow(at(module_.objects, object).root, p); }

  Answers follow(Id<Node> node, const Spot& p) {
    if (is_over()) return Answers::sometimes;
    if (const auto* region = std::get_if<Id<Region>>(&at(module_.nodes, node).content)) return answer(*region, p);
    const auto& decision = std::get<Decision>(at(module_.nodes, node).content);
    const Side side = decide(decision.sdf, p);
    if (side == Side::negative) return follow(decision.negative, p);
    if (side == Side::positive) return follow(decision.positive, p);
    const Answers negative = follow(decision.negative, p), positive = follow(decision.positive, p);
    return negative == positive ? negative : Answers::sometimes;
  }

  Answers answer(Id<Region> id, const Spot& p) {
    const Region& region = at(module_.regions, id);
    bool any = false;
    for (std::size_t g = 0; g < region.groups.size() && !is_over(); ++g) {
      const Answers group = ask(region.groups[g], judge_.records.groups[judge_.records.regions[id.index].first_group + g], p);
      if (group == Answers::always) return group;
      any = any || group == Answers::sometimes;
    }
    if (region.number == 0) return any ? Answers::sometimes : Answers::never;
    const bool is_bitmap = region.kind == voml::RegionKind::bitmap;
    add_outcome(id, is_bitmap ? region.texture_from_object * p.frame_from_root : Affine{});
    return Answers::always;
  }

  Answers ask(const CandidateGroup& group, const gpu::GroupRecord& record, const Spot& p) {
    const Spot in_frame = group.box_from_object ? enter(*group.box_from_object, p) : p;
    const Held asked = group.box_from_object ? held_by_cube(in_frame) : Held::inside;
    if (asked == Held::outside) return Answers::never;
    const auto candidates = listed(record.lookup, in_frame);
    given_up_ = given_up_ || !candidates;
    bool any = false;
    for (std::size_t k = 0; !is_over() && k < candidates->size(); ++k) {
      const Answers one = ask(group.candidates[(*candidates)[k]], p);
      if (one == Answers::always && asked == Held::inside) return one;
      any = any || one != Answers::never;
    }
    return any ? Answers::sometimes : Answers::never;
  }

  Answers ask(const Candidate& candidate, const Spot& p) {
    Spot q = enter(candidate.local_from_parent, p);
    if (candidate.tiled) {
      given_up_ = given_up_ || !wrap(q);
      return evaluate(candidate.object, q);
    }
    const Held held = held_by_cube(q);
    if (held == Held::outside) return Answers::never;
    const Answers inside = evaluate(candidate.object, q);
    return held == Held::partly && inside == Answers::always ? Answers::sometimes : inside;
  }

  const Judge::Impl& judge_;
  const Module& module_;
  std::span<const snippet::BoxFunction> functions_;
  const snippet::Box& box_;
  std::optional<Outcome> outcome_;  ///< the first that was found
  bool conflict_ = false;           ///< there is another one
  bool moves_ = false;
  bool given_up_ = false;
  std::uint32_t tests_ = 0;
};

}  // namespace

Judge::Judge(Module module, Records records, const Options& options)
    : impl_(std::make_unique<Impl>(std::move(module), std::move(records), options)) {}

Judge::~Judge() = default;

bool Judge::is_animated() const { return impl_->any_animated; }
const Module& Judge::module() const { return impl_->module; }
const Records& Judge::records() const { return impl_->records; }
const Judge::Times& Judge::always() const { return impl_->always; }

Judge::Times Judge::times(const snippet::Interval& span_ms) const { return prepare(impl_->module, span_ms); }

Judge::Times Judge::prepare(const Module& module, const snippet::Interval& span_ms) {
  Times times;
  times.span_ms_ = span_ms;
  for (const Function& function : module.functions) times.functions_.emplace_back(function.snippet, span_ms);
  return times;
}

Verdict Judge::over(const snippet::Box& box, const Times& times) const { return Case(*impl_, times.functions_, box).run(); }

}  // namespace dmvv::compiler
