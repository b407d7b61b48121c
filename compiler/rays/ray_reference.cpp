#include "compiler/rays/ray_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "compiler/ir/opacity.h"
#include "compiler/layout/flatten.h"
#include "compiler/proofs/judge.h"

namespace dmvv::compiler {

namespace {

constexpr double finest = 0x1p-19;                 ///< root units: a segment that is no longer is not divided
constexpr double shortest_counted = 4.0 * finest;  ///< what shows on a shorter piece does not count
constexpr std::uint32_t most_inquiries = 1u << 18;
constexpr std::uint32_t samples_a_piece = 8, most_samples = 1u << 14;  ///< where nothing is proven
constexpr double integral_error = 1e-11;

using Path = std::vector<PathStep>;

/// A span of t on which one answer is proven, or nothing.
struct Piece {
  double t0, t1;
  bool proven;
  Path path;
};

/// The part of a ray that lies in the cube and is not cut away; nothing if t1 < t0.
struct SeenPart {
  double t0, t1;
};

/// Keeps what lies on the side of a plane where `gap` + t * `slope` is not positive.
void clip(double gap, double slope, SeenPart& span) {
  if (slope == 0.0) {
    if (gap > 0.0) span.t1 = -1.0;
  } else if (slope > 0.0) {
    span.t1 = std::min(span.t1, -gap / slope);
  } else {
    span.t0 = std::max(span.t0, -gap / slope);
  }
}

SeenPart seen_part(const Ray& ray, std::span<const Cut> cuts) {
  SeenPart span{0.0, std::numeric_limits<double>::infinity()};
  for (int axis = 0; axis < 3; ++axis) {
    clip(ray.origin[axis] - 1.0, ray.direction[axis], span);
    clip(-ray.origin[axis] - 1.0, -ray.direction[axis], span);
  }
  for (const Cut& cut : cuts) clip(glm::dot(cut.normal, ray.origin) - cut.d, glm::dot(cut.normal, ray.direction), span);
  return span;
}

/// The records of which a judge reads the lookups alone: there is no atlas.
Records lookups_of(const Module& module) {
  const auto empty = [](std::size_t count) {
    Atlas atlas;
    atlas.texture.extent = glm::uvec3(1);
    atlas.slots.resize(count);
    atlas.scales.resize(count, 1.0);
    return atlas;
  };
  return flatten(module, empty(module.grids.size()), empty(module.bitmaps.size()), IndexOptions{});
}

/// What rays of a module are followed by.
struct Scene {
  const Module& module;
  Reference points;
  Judge judge;
  std::vector<bool> opaque;  ///< of each region

  Scene(const Module& m, Reference::Options options)
      : module(m), points(m, options), judge(m, lookups_of(m), {options.format, options.filter}) {
    for (const Region& region : module.regions) opaque.push_back(is_opaque(module, region));
  }
  bool ends_on(const Path& path) const { return !path.empty() && opaque[path.back().region]; }
};

/// The candidate of a region that a path went on into.
const Candidate& candidate_of(const Region& region, std::uint32_t number) {
  const auto behind = std::ranges::upper_bound(region.groups, number, {}, &CandidateGroup::first_number);
  const CandidateGroup& group = *std::prev(behind);
  return group.candidates[number - group.first_number];
}

/// Answers along a span of t: proven ones, and gaps between them in which nothing is.
class Division {
 public:
  Division(const Scene& scene, const Ray& ray, double time_ms)
      : scene_(scene), ray_(ray), times_(scene.judge.times({time_ms, time_ms})), speed_(glm::length(ray.direction)) {}

  /// Up to the first opaque answer and what comes behind it.
  std::vector<Piece> run(const SeenPart& part) {
    divide(nullptr, part.t0, part.t1);
    return std::move(pieces_);
  }

 private:
  void divide(Inquiry* wider, double t0, double t1) {
    if (is_over_) return;
    const Segment segment{ray_.origin + t0 * ray_.direction, ray_.origin + t1 * ray_.direction};
    Inquiry inquiry = wider != nullptr ? Inquiry(*wider, segment) : Inquiry(scene_.judge, times_, segment);
    Verdict verdict = inquiry.verdict();
    const double middle = 0.5 * (t0 + t1);
    const bool is_whole =
        (t1 - t0) * speed_ <= finest || ++inquiries_ >= most_inquiries || !(middle > t0 && middle < t1);
    if (verdict.decided || is_whole) return add({t0, t1, verdict.decided, std::move(verdict.path)});
    divide(&inquiry, t0, middle);
    divide(&inquiry, middle, t1);
  }

  /// Joins pieces of one answer, and pieces of a gap.
  void add(Piece piece) {
    const bool joins = !pieces_.empty() && pieces_.back().proven == piece.proven &&
                       (!piece.proven || pieces_.back().path == piece.path);
    is_over_ = piece.proven && !joins && is_behind_opaque_;
    is_behind_opaque_ = is_behind_opaque_ || (piece.proven && scene_.ends_on(piece.path));
    if (joins)
      pieces_.back().t1 = piece.t1;
    else
      pieces_.push_back(std::move(piece));
  }

  const Scene& scene_;
  const Ray& ray_;
  Judge::Times times_;
  double speed_;
  std::uint32_t inquiries_ = 0;
  bool is_behind_opaque_ = false, is_over_ = false;
  std::vector<Piece> pieces_;
};

/// Pieces -> segments: the boundaries in gaps are bisected between points.
class Boundaries {
 public:
  Boundaries(const Scene& scene, const Ray& ray, double time_ms)
      : scene_(scene), ray_(ray), time_ms_(time_ms), speed_(glm::length(ray.direction)) {}

  /// Segments that are empty are left out; `certain` is false if one of those is not proven either.
  std::vector<RaySegment> run(const std::vector<Piece>& pieces, bool& certain) {
    for (std::size_t i = 0; i < pieces.size() && !is_over(); ++i) {
      const Piece* const before = i == 0 ? nullptr : &pieces[i - 1];
      const Piece* const behind = i + 1 == pieces.size() ? nullptr : &pieces[i + 1];
      if (pieces[i].proven)
        go_on(pieces[i].t0, 0.0, pieces[i].path);
      else
        resolve(pieces[i], before, behind);
    }
    if (!pieces.empty() && !is_over()) end(pieces.back().t1, 0.0);
    certain = certain_;
    return std::move(segments_);
  }

 private:
  bool is_over() const { return segments_.size() > 0 && !is_open_ && scene_.ends_on(segments_.back().path); }

  Path path_at(double t) const { return scene_.points.evaluate(ray_.origin + t * ray_.direction, time_ms_).path; }

  /// From t on the path is this one; no device finds that farther than `error` from t.
  void go_on(double t, double error, const Path& path) {
    if (is_open_ && segments_.back().path == path) return;
    end(t, error);
    if (path.empty() || is_over()) return;
    segments_.push_back({.t0 = t, .t1 = t, .path = path, .t0_error = error});
    is_open_ = true;
  }
  void end(double t, double error) {
    if (!is_open_) return;
    segments_.back().t1 = t;
    segments_.back().t1_error = error;
    is_open_ = false;
  }
  void doubt() {
    certain_ = false;
    if (!segments_.empty()) segments_.back().certain = false;
  }

  void resolve(const Piece& gap, const Piece* before, const Piece* behind) {
    const Path first = before != nullptr ? before->path : path_at(gap.t0);
    const Path last = behind != nullptr ? behind->path : path_at(gap.t1);
    const double length = (gap.t1 - gap.t0) * speed_;
    const double wanted = std::max(8.0, samples_a_piece * length / finest);
    const auto count = static_cast<std::uint32_t>(std::min(wanted, double{most_samples}));
    changes_.clear();
    double t = gap.t0;
    Path path = first;
    for (std::uint32_t i = 1; i <= count; ++i) {
      const double next = i == count ? gap.t1 : gap.t0 + (gap.t1 - gap.t0) * i / count;
      Path there = i == count ? last : path_at(next);
      find_changes(t, path, next, there);
      t = next;
      path = std::move(there);
    }
    // Where a ray begins or ends there is nothing on the other side: a boundary may stand there without a change.
    const bool at_an_end = before == nullptr || behind == nullptr;
    const bool one_change = changes_.size() == 1 || (changes_.empty() && (at_an_end || length <= shortest_counted));
    const bool certain = wanted <= most_samples && one_change;
    if (!certain) doubt();
    if (before == nullptr) go_on(gap.t0, gap.t1 - gap.t0, first);
    for (const auto& [at, changed] : changes_) go_on(at, std::max(at - gap.t0, gap.t1 - at), changed);
    if (!certain) doubt();
  }

  /// Notes each t in (t0, t1] from which on the path is another one, found to the last bit.
  void find_changes(double t0, const Path& path0, double t1, const Path& path1) {
    while (path0 != path1) {
      double lo = t0, hi = t1;
      Path changed = path1;
      for (double middle = 0.5 * (lo + hi); middle > lo && middle < hi; middle = 0.5 * (lo + hi)) {
        Path there = path_at(middle);
        if (there == path0) {
          lo = middle;
        } else {
          hi = middle;
          changed = std::move(there);
        }
      }
      changes_.emplace_back(hi, changed);
      if (changed == path1) return;
      return find_changes(hi, changes_.back().second, t1, path1);
    }
  }

  const Scene& scene_;
  const Ray& ray_;
  double time_ms_, speed_;
  bool certain_ = true;
  bool is_open_ = false;
  std::vector<RaySegment> segments_;
  std::vector<std::pair<double, Path>> changes_;
};

/// Segments -> colour, front to back.
class Seeing {
 public:
  Seeing(const Scene& scene, const Ray& ray, double time_ms) : scene_(scene), ray_(ray), time_ms_(time_ms) {}

  glm::dvec4 run(const std::vector<RaySegment>& segments) {
    for (const RaySegment& segment : segments) see(segment);
    const double alpha = 1.0 - transmitted_;
    return alpha > 0.0 ? glm::dvec4(premultiplied_ / alpha, alpha) : glm::dvec4(0.0);
  }

 private:
  void see(const RaySegment& segment) {
    const Region& region = scene_.module.regions[segment.path.back().region];
    const double scale = local_speed(segment.path);
    if (scene_.ends_on(segment.path)) {
      const double inside = segment.t0 + 1e-9 * (segment.t1 - segment.t0);
      const bool is_plain = region.kind != voml::RegionKind::bitmap;
      add({is_plain ? region.rgb : glm::dvec3(color_at(inside)), 0.0});
    } else if (region.kind != voml::RegionKind::bitmap) {
      const double left = std::pow(1.0 - region.opacity, scale * (segment.t1 - segment.t0));
      add({region.rgb * (1.0 - left), left});
    } else {
      add(integral(segment.t0, segment.t1, scale, gauss(segment.t0, segment.t1, scale), 0));
    }
  }

  /// What a piece emits, and what it leaves of the light from behind it.
  struct Passed {
    glm::dvec3 emitted;
    double left;
  };
  void add(const Passed& piece) {
    premultiplied_ += transmitted_ * piece.emitted;
    transmitted_ *= piece.left;
  }
  static Passed behind_each_other(const Passed& a, const Passed& b) {
    return {a.emitted + a.left * b.emitted, a.left * b.left};
  }

  glm::dvec4 color_at(double t) const {
    return scene_.points.evaluate(ray_.origin + t * ray_.direction, time_ms_).rgba;
  }

  /// Units of the region's object that the ray goes in one unit of t.
  double local_speed(const Path& path) const {
    glm::dvec3 direction = ray_.direction;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const Region& region = scene_.module.regions[path[i].region];
      direction = candidate_of(region, path[i].candidate).local_from_parent.linear * direction;
    }
    return glm::length(direction);
  }

  /// Halves a piece until its halves come to the same.
  Passed integral(double t0, double t1, double scale, const Passed& whole, int depth) const {
    constexpr int deepest = 40;
    const double middle = 0.5 * (t0 + t1);
    const Passed a = gauss(t0, middle, scale), b = gauss(middle, t1, scale), both = behind_each_other(a, b);
    const double apart = std::max(glm::length(both.emitted - whole.emitted), std::abs(both.left - whole.left));
    if (apart <= integral_error || depth == deepest || !(middle > t0 && middle < t1)) return both;
    return behind_each_other(integral(t0, middle, scale, a, depth + 1), integral(middle, t1, scale, b, depth + 1));
  }

  /// Gauss-Legendre with three points for the optical depth up to each of three points, and for what is emitted there.
  Passed gauss(double t0, double t1, double scale) const {
    constexpr double node = 0.7745966692414834;  // sqrt(3/5)
    constexpr double weights[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    // Integrals of the Lagrange polynomials of the nodes from 0 to each node, over [0, 1] (Butcher 1964).
    constexpr double root15 = 3.872983346207417;
    constexpr double up_to[3][3] = {{5.0 / 36.0, 2.0 / 9.0 - root15 / 15.0, 5.0 / 36.0 - root15 / 30.0},
                                    {5.0 / 36.0 + root15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - root15 / 24.0},
                                    {5.0 / 36.0 + root15 / 30.0, 2.0 / 9.0 + root15 / 15.0, 5.0 / 36.0}};
    const double h = t1 - t0;
    glm::dvec3 rgb[3];
    double extinction[3], depth = 0.0;  // a unit of t; over all of the piece
    for (int i = 0; i < 3; ++i) {
      const glm::dvec4 rgba = color_at(t0 + h * (0.5 + 0.5 * node * (i - 1)));
      rgb[i] = glm::dvec3(rgba);
      extinction[i] = -scale * std::log1p(-std::min(rgba.a, least_opaque));
      depth += weights[i] * h * extinction[i];
    }
    Passed piece{glm::dvec3(0.0), std::exp(-depth)};
    double emitted = 0.0;
    for (int i = 0; i < 3; ++i) {
      double before = 0.0;
      for (int j = 0; j < 3; ++j) before += up_to[i][j] * h * extinction[j];
      const double weight = weights[i] * h * extinction[i] * std::exp(-before);
      piece.emitted += weight * rgb[i];
      emitted += weight;
    }
    // What is absorbed is emitted, exactly.
    if (emitted > 0.0) piece.emitted *= (1.0 - piece.left) / emitted;
    return piece;
  }

  const Scene& scene_;
  const Ray& ray_;
  double time_ms_;
  double transmitted_ = 1.0;
  glm::dvec3 premultiplied_{0.0};
};

}  // namespace

struct RayReference::Impl {
  Scene scene;
  Impl(const Module& module, Reference::Options options) : scene(module, options) {}
};

RayReference::RayReference(const Module& module, Reference::Options options)
    : impl_(std::make_unique<Impl>(module, options)) {}
RayReference::RayReference(RayReference&&) noexcept = default;
RayReference::~RayReference() = default;

const Reference& RayReference::points() const { return impl_->scene.points; }

RayAnswer RayReference::along(const Ray& ray, std::span<const Cut> cuts, double time_ms) const {
  RayAnswer answer;
  const SeenPart part = seen_part(ray, cuts);
  if (!(part.t0 < part.t1)) return answer;
  const std::vector<Piece> pieces = Division(impl_->scene, ray, time_ms).run(part);
  answer.segments = Boundaries(impl_->scene, ray, time_ms).run(pieces, answer.certain);
  answer.rgba = Seeing(impl_->scene, ray, time_ms).run(answer.segments);
  if (!answer.segments.empty()) answer.depth = answer.segments.front().t0;
  return answer;
}

}  // namespace dmvv::compiler
