// One box, all ways through the scene that it leaves open. The ways are kept as a tree of arrivals: a box within asks
// the arrival of the wider box first, and tests only what is open there.
#include "compiler/proofs/judge.h"

#include <algorithm>
#include <cmath>
#include <forward_list>
#include <glm/vector_relational.hpp>
#include <limits>
#include <optional>
#include <span>

#include "compiler/grids/grid_range.h"
#include "compiler/grids/sample.h"
#include "compiler/grids/storage.h"
#include "compiler/grids/texels.h"
#include "compiler/ir/placements.h"
#include "compiler/ir/rounding.h"
#include "compiler/snippet/time_range.h"

namespace dmvv::compiler {

namespace {

constexpr std::uint32_t most_cells = 64;  // of a lookup grid, that a box may touch
constexpr double infinity = std::numeric_limits<double>::infinity();

enum class Side { negative, positive, open };
enum class Held { inside, outside, partly };
enum class Answers { always, never, sometimes };  ///< an object, at the points of a box

/// Where points of root coordinates arrive, and how far off a device's may be.
struct Frame {
  Affine from_root;
  ErrorBound error;
};

/// Bounds of a box's points in a frame, the device's errors included.
struct Spot {
  glm::dvec3 center, half;
};

/// The points that are asked about: a box, or a segment.
struct Points {
  glm::dvec3 middle, half;  ///< of a segment half the way along it
  bool is_segment;

  Points(const snippet::Box& box) : middle(0.5 * (box.lo + box.hi)), half(0.5 * (box.hi - box.lo)), is_segment(false) {}
  Points(const Segment& s) : middle(0.5 * (s.a + s.b)), half(0.5 * (s.b - s.a)), is_segment(true) {}
};

Spot spot_in(const Frame& frame, const Points& points) {
  const glm::dmat3& linear = frame.from_root.linear;
  const glm::dvec3 half = points.is_segment ? glm::abs(linear * points.half) : abs_times(linear, points.half);
  return {frame.from_root(points.middle), half + frame.error.component};
}

Held held_by(const Spot& q, const glm::dvec3& lo, const glm::dvec3& hi) {
  const glm::dvec3 half = q.half + float_unit * glm::max(glm::abs(lo), glm::abs(hi));  // the bounds are rounded as well
  const glm::dvec3 least = q.center - half, most = q.center + half;
  if (glm::any(glm::lessThan(most, lo)) || glm::any(glm::greaterThan(least, hi))) return Held::outside;
  const bool inside = glm::all(glm::greaterThan(least, lo)) && glm::all(glm::lessThan(most, hi));
  return inside ? Held::inside : Held::partly;
}

Held held_by_cube(const Spot& q) { return held_by(q, glm::dvec3(-1.0), glm::dvec3(1.0)); }

/// The frame of a placement in a frame in which the points are at `spot`.
Frame enter(const Affine& step, const Frame& from, const Spot& spot) {
  return {step * from.from_root, carry(step, from.error, float_error(step, glm::abs(spot.center) + spot.half))};
}

/// Wraps a frame so that the spot lies in [-1,1)^3. None if it meets a seam.
std::optional<Frame> wrap(const Frame& frame, Spot& spot) {
  const glm::dvec3 added = 4.0 * float_unit * (glm::abs(spot.center) + spot.half + 1.0);
  const glm::dvec3 turns = 2.0 * glm::floor((spot.center + 1.0) * 0.5);
  spot.half += added;
  spot.center -= turns;
  if (held_by_cube(spot) != Held::inside) return std::nullopt;
  Frame wrapped = frame;
  wrapped.from_root.translation -= turns;
  wrapped.error.component += added;
  wrapped.error.length += glm::length(added);
  return wrapped;
}

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
    always = prepare(module, {-longest_ms, longest_ms});
  }

  bool is_animated(const Sdf& sdf) const {
    const auto* function = std::get_if<Id<Function>>(&sdf.source);
    return function != nullptr && animated[function->index];
  }

  /// The entries, ascending and without repeats, of all cells that the box touches, restricted to [begin, begin +
  /// count) and counted from `begin`. Nothing if the box touches too many cells or they list too much.
  std::optional<std::vector<std::uint32_t>> listed(const gpu::LookupRecord& lookup, const Spot& q, std::uint32_t begin,
                                                   std::size_t count) const;
  /// On which side of an SDF's surface the points of the spot lie.
  Side side_of(Id<Sdf> id, const Spot& q, std::span<const snippet::BoxFunction> functions) const;

 private:
  Range range_of_grid(Id<voml::Grid> id, double iso, const glm::dvec3& lo, const glm::dvec3& hi) const;
};

std::optional<std::vector<std::uint32_t>> Judge::Impl::listed(const gpu::LookupRecord& lookup, const Spot& q,
                                                              std::uint32_t begin, std::size_t count) const {
  const glm::dvec3 lo(lookup.lo), per_unit(lookup.cells_per_unit);
  const glm::dvec3 last = glm::dvec3(lookup.size_x, lookup.size_y, lookup.size_z) - 1.0;
  const auto cell = [&](const glm::dvec3& p) {
    return glm::uvec3(glm::clamp(glm::floor((p - lo) * per_unit), glm::dvec3(0.0), last));
  };
  const glm::uvec3 first = cell(q.center - q.half), end = cell(q.center + q.half) + 1u;
  const glm::u64vec3 width(end - first);
  if (width.x * width.y * width.z > most_cells) return std::nullopt;
  std::vector<std::uint32_t> all;
  for (std::uint32_t z = first.z; z < end.z; ++z) {
    for (std::uint32_t y = first.y; y < end.y; ++y) {
      for (std::uint32_t x = first.x; x < end.x; ++x) {
        const std::size_t c = lookup.first_cell + (std::size_t{z} * lookup.size_y + y) * lookup.size_x + x;
        for (std::size_t i = records.cells[c]; i < records.cells[c + 1]; ++i) {
          const std::uint32_t number = records.lists[i] - begin;  // of those before it a large one
          if (number < count) all.push_back(number);
        }
      }
    }
  }
  if (width != glm::u64vec3(1)) {
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
  return all.size() <= Inquiry::most_tests ? std::optional(std::move(all)) : std::nullopt;
}

Side Judge::Impl::side_of(Id<Sdf> id, const Spot& q, std::span<const snippet::BoxFunction> functions) const {
  const Sdf& sdf = at(module.sdfs, id);
  const LocalBox& domain = boxes[id.index];
  const Held held = held_by(q, domain.lo, domain.hi);
  if (held == Held::outside) return Side::positive;
  const glm::dvec3 rounding = float_unit * glm::max(glm::abs(domain.lo), glm::abs(domain.hi));
  const glm::dvec3 lo = glm::max(q.center - q.half, domain.lo - rounding);
  const glm::dvec3 hi = glm::min(q.center + q.half, domain.hi + rounding);
  Range value;
  if (const auto* function = std::get_if<Id<Function>>(&sdf.source)) {
    const snippet::Interval f = functions[function->index]({glm::min(lo, hi), glm::max(lo, hi)});
    const double slack = float_unit * std::abs(sdf.iso);
    value = {f.lo - slack, f.maybe_nan ? infinity : f.hi + slack};  // NaN is above any iso
  } else {
    value = range_of_grid(std::get<Id<voml::Grid>>(sdf.source), sdf.iso, lo, hi);
  }
  if (value.lo > sdf.iso) return Side::positive;
  return held == Held::inside && value.hi <= sdf.iso ? Side::negative : Side::open;
}

Range Judge::Impl::range_of_grid(Id<voml::Grid> id, double iso, const glm::dvec3& lo, const glm::dvec3& hi) const {
  const voml::Grid& grid = at(module.grids, id);
  const GridRange& range = ranges[id.index];
  const glm::dvec3 samples_per_unit = glm::dvec3(grid.size) / (grid.box_hi - grid.box_lo);
  const glm::dvec3 error = sample_error(grid, glm::dvec3(0.0));
  const glm::dvec3 a = (lo - grid.box_lo) * samples_per_unit - 0.5 - error;
  const glm::dvec3 b = (hi - grid.box_lo) * samples_per_unit - 0.5 + error;
  const double slack = filter_error(range.bounds(), iso, options.format, options.filter);
  if (options.filter == Filter::tricubic) {
    const double middle = sample_tricubic(grid, 0.5 * (lo + hi));
    const double reach = tricubic_slope * glm::dot(0.5 * (b - a), range.bounds().slope) + slack;
    return {middle - reach, middle + reach};
  }
  const Range exact = range.over(a, b);
  return {exact.lo - slack, exact.hi + slack};
}

// ---- inquiries ----

namespace {

/// An SDF over a box.
struct AskedSdf {
  Id<Sdf> sdf;
  Side side;
  bool has_all;                    ///< `open` has every placement that is open
  std::vector<const Frame*> open;  ///< placements whose sources are open
};

struct Arrival;

struct CandidateInquiry {
  std::uint32_t index;  ///< in the group
  const Frame* frame;   ///< of the local points; if tiled, before they are wrapped
  Held held;            ///< tiled: inside, or partly where the box meets a seam
  std::unique_ptr<Arrival> arrival;
};

/// A group over a box: what may hold a point of it.
struct GroupInquiry {
  const CandidateGroup* group;
  Held held;      ///< by the group's own box
  bool too_many;  ///< then there are no candidates, and nothing is known
  std::vector<CandidateInquiry> candidates;
};

/// An object that some point of the box may come to, by one way.
struct Arrival {
  const Frame* frame;
  Spot spot;
  Arrival* wider;  ///< of the same object, by the same way, over the wider box; null if there is none
  std::vector<AskedSdf> sdfs = {};
  std::vector<GroupInquiry> groups = {};
};

}  // namespace

struct Inquiry::Impl {
  const Judge::Impl& judge;
  const Module& module;
  const Judge::Times& times;
  std::span<const snippet::BoxFunction> functions;
  Points points;
  Impl* wider = nullptr;
  std::forward_list<Frame> frames;
  Arrival root;

  // Of the verdict that is being found.
  struct Outcome {
    Id<Region> region;
    Affine texture_from_root;
    std::vector<PathStep> path;  ///< of segments
    friend bool operator==(const Outcome&, const Outcome&) = default;
  };
  std::vector<PathStep> path;      ///< to where the verdict stands now
  std::optional<Outcome> outcome;  ///< the first that was found
  bool conflict = false;           ///< there is another one
  bool moves = false;
  bool given_up = false;
  std::uint32_t tests = 0;

  Impl(const Judge::Impl& j, const Judge::Times& t, std::span<const snippet::BoxFunction> f, const Points& p)
      : judge(j), module(j.module), times(t), functions(f), points(p) {
    root.frame = &frames.emplace_front();
    root.spot = spot_in(*root.frame, points);
    root.wider = nullptr;
  }
  Impl(Impl& w, const Points& p)
      : judge(w.judge), module(w.module), times(w.times), functions(w.functions), points(p), wider(&w) {
    root.frame = w.root.frame;
    root.spot = spot_in(*root.frame, points);
    root.wider = &w.root;
  }

  Verdict run() {
    if (follow_object(module.root, root) != Answers::always) add_outcome({{}, {}, {}});
    Verdict verdict;
    verdict.decided = !given_up && !conflict;
    verdict.moves = given_up ? judge.any_animated : conflict && moves;
    if (verdict.decided) {
      verdict.region = outcome->region;
      verdict.path = std::move(outcome->path);
      verdict.texture_from_root = outcome->texture_from_root;
    }
    return verdict;
  }

  void add_outcome(const Outcome& found) {
    conflict = conflict || (outcome && *outcome != found);
    if (!outcome) outcome = found;
  }

  /// Nothing that follows can change what is said.
  bool is_over() const { return given_up || (conflict && (moves || !judge.any_animated)); }

  void count_test() { given_up = given_up || ++tests > most_tests; }

  // ---- SDFs ----

  const AskedSdf& ask(Id<Sdf> id, Arrival& arrival) {
    const auto known = std::ranges::find(arrival.sdfs, id, &AskedSdf::sdf);
    if (known != arrival.sdfs.end()) return *known;
    const AskedSdf* before = arrival.wider != nullptr ? &wider->ask(id, *arrival.wider) : nullptr;
    AskedSdf asked{id, Side::positive, true, {}};
    if (before != nullptr && before->side != Side::open) {
      asked.side = before->side;
    } else if (before != nullptr && before->has_all) {
      for (const Frame* frame : before->open) ask_source(*frame, asked);
    } else {
      ask_all_sources(arrival, asked);
    }
    return arrival.sdfs.emplace_back(std::move(asked));
  }

  void ask_all_sources(const Arrival& arrival, AskedSdf& asked) {
    const Sdf& sdf = at(module.sdfs, asked.sdf);
    if (sdf.placement != voml::Placement::seeded) {
      return ask_source(frames.emplace_front(enter(sdf.local_from_object.front(), *arrival.frame, arrival.spot)),
                        asked);
    }
    const auto seeds = judge.listed(judge.records.sdfs[asked.sdf.index].lookup, arrival.spot,
                                    judge.records.first_seed[asked.sdf.index], sdf.local_from_object.size());
    if (!seeds) {
      asked.side = Side::open;
      asked.has_all = false;
      return;
    }
    for (const std::uint32_t i : *seeds) {
      ask_source(frames.emplace_front(enter(sdf.local_from_object[i], *arrival.frame, arrival.spot)), asked);
    }
  }

  /// Takes one placement into account: any negative one decides, all positive ones do.
  void ask_source(const Frame& frame, AskedSdf& asked) {
    if (asked.side == Side::negative) return;
    count_test();
    Spot q = spot_in(frame, points);
    const bool is_tiled = at(module.sdfs, asked.sdf).placement == voml::Placement::tiled;
    const Side side = is_tiled && !wrap(frame, q) ? Side::open : judge.side_of(asked.sdf, q, functions);
    if (side != Side::positive) asked.side = side;
    if (side == Side::open) asked.open.push_back(&frame);
  }

  // ---- groups ----

  GroupInquiry& ask(const CandidateGroup& group, const gpu::GroupRecord& record, Arrival& arrival) {
    const auto known = std::ranges::find(arrival.groups, &group, &GroupInquiry::group);
    if (known != arrival.groups.end()) return *known;
    GroupInquiry* before = arrival.wider != nullptr ? &wider->ask(group, record, *arrival.wider) : nullptr;
    GroupInquiry asked{&group, Held::inside, false, {}};
    const Frame in_frame =
        group.box_from_object ? enter(*group.box_from_object, *arrival.frame, arrival.spot) : *arrival.frame;
    const Spot in_box = group.box_from_object ? spot_in(in_frame, points) : arrival.spot;
    if (group.box_from_object) asked.held = held_by_cube(in_box);
    if (asked.held == Held::outside) return arrival.groups.emplace_back(std::move(asked));
    if (before != nullptr && !before->too_many) {
      for (CandidateInquiry& candidate : before->candidates) {
        const bool is_tiled = group.candidates[candidate.index].tiled;  // perhaps not wrapped there
        ask_candidate(candidate.index, *candidate.frame, is_tiled ? nullptr : candidate.arrival.get(), asked);
      }
    } else if (const auto candidates = judge.listed(record.lookup, in_box, 0, group.candidates.size())) {
      for (const std::uint32_t i : *candidates) {
        const Affine& step = group.candidates[i].local_from_parent;
        ask_candidate(i, frames.emplace_front(enter(step, *arrival.frame, arrival.spot)), nullptr, asked);
      }
    } else {
      asked.too_many = true;
    }
    return arrival.groups.emplace_back(std::move(asked));
  }

  void ask_candidate(std::uint32_t index, const Frame& frame, Arrival* before, GroupInquiry& asked) {
    count_test();
    CandidateInquiry candidate{index, &frame, Held::inside, std::make_unique<Arrival>()};
    Arrival& arrival = *candidate.arrival;
    arrival.frame = &frame;
    arrival.spot = spot_in(frame, points);
    arrival.wider = before;
    if (asked.group->candidates[index].tiled) {
      const auto wrapped = wrap(frame, arrival.spot);
      candidate.held = wrapped ? Held::inside : Held::partly;
      if (wrapped) arrival.frame = &frames.emplace_front(*wrapped);
    } else {
      candidate.held = held_by_cube(arrival.spot);
    }
    if (candidate.held != Held::outside) asked.candidates.push_back(std::move(candidate));
  }

  // ---- the ways ----

  Answers follow_object(Id<Object> object, Arrival& arrival) {
    return follow(at(module.objects, object).root, arrival);
  }

  Answers follow(Id<Node> node, Arrival& arrival) {
    if (is_over()) return Answers::sometimes;
    if (const auto* region = std::get_if<Id<Region>>(&at(module.nodes, node).content)) return answer(*region, arrival);
    const auto& decision = std::get<Decision>(at(module.nodes, node).content);
    const AskedSdf& asked = ask(decision.sdf, arrival);  // until the next is asked
    const Side side = asked.side;
    given_up = given_up || !asked.has_all;
    if (side == Side::negative) return follow(decision.negative, arrival);
    if (side == Side::positive) return follow(decision.positive, arrival);
    moves = moves || judge.is_animated(at(module.sdfs, decision.sdf));
    const Answers negative = follow(decision.negative, arrival), positive = follow(decision.positive, arrival);
    return negative == positive ? negative : Answers::sometimes;
  }

  Answers answer(Id<Region> id, Arrival& arrival) {
    path.push_back({id.index, 0});
    const Answers answers = answer_by(id, arrival);
    path.pop_back();
    return answers;
  }

  Answers answer_by(Id<Region> id, Arrival& arrival) {
    const Region& region = at(module.regions, id);
    bool any = false;
    for (std::size_t g = 0; g < region.groups.size() && !is_over(); ++g) {
      const gpu::GroupRecord& record = judge.records.groups[judge.records.regions[id.index].first_group + g];
      const Answers group = answer(region.groups[g], record, arrival);
      if (group == Answers::always) return group;
      any = any || group == Answers::sometimes;
    }
    if (region.number == 0) return any ? Answers::sometimes : Answers::never;
    const bool is_bitmap = region.kind == voml::RegionKind::bitmap;
    path.back().candidate = 0;
    add_outcome({id, is_bitmap ? region.texture_from_object * arrival.frame->from_root : Affine{},
                 points.is_segment ? path : std::vector<PathStep>{}});
    return Answers::always;
  }

  Answers answer(const CandidateGroup& group, const gpu::GroupRecord& record, Arrival& arrival) {
    GroupInquiry& asked = ask(group, record, arrival);
    if (asked.held == Held::outside) return Answers::never;
    given_up = given_up || asked.too_many;
    bool any = false;
    for (std::size_t k = 0; k < asked.candidates.size() && !is_over(); ++k) {
      path.back().candidate = group.first_number + asked.candidates[k].index;
      const Answers one = answer(group.candidates[asked.candidates[k].index], asked.candidates[k]);
      if (one == Answers::always && asked.held == Held::inside) return one;
      any = any || one != Answers::never;
    }
    return any ? Answers::sometimes : Answers::never;
  }

  Answers answer(const Candidate& candidate, CandidateInquiry& asked) {
    if (candidate.tiled && asked.held == Held::partly) {
      given_up = true;
      return Answers::sometimes;
    }
    const Answers inside = follow_object(candidate.object, *asked.arrival);
    return asked.held == Held::partly && inside == Answers::always ? Answers::sometimes : inside;
  }
};

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

Inquiry::Inquiry(const Judge& judge, const Judge::Times& times, const snippet::Box& box)
    : impl_(std::make_unique<Impl>(*judge.impl_, times, times.functions_, box)) {}
Inquiry::Inquiry(Inquiry& wider, const snippet::Box& box) : impl_(std::make_unique<Impl>(*wider.impl_, box)) {}
Inquiry::Inquiry(const Judge& judge, const Judge::Times& times, const Segment& segment)
    : impl_(std::make_unique<Impl>(*judge.impl_, times, times.functions_, segment)) {}
Inquiry::Inquiry(Inquiry& wider, const Segment& segment) : impl_(std::make_unique<Impl>(*wider.impl_, segment)) {}
Inquiry::~Inquiry() = default;

Verdict Inquiry::verdict() { return impl_->run(); }

}  // namespace dmvv::compiler
