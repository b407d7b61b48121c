// What is proven of whole boxes: by intervals over boxes for snippets, by exact ranges for grids, by conservative boxes
// for placements. The proof holds for every float32 evaluation of a device, not only for the scene in reals.
#pragma once

#include <memory>
#include <vector>

#include "compiler/grids/storage.h"
#include "compiler/ir/legend.h"
#include "compiler/ir/module.h"
#include "compiler/layout/flatten.h"
#include "compiler/snippet/snippet.h"

namespace dmvv::compiler {

/// What is known of all points of a box at all times of a span.
struct Verdict {
  bool decided = false;        ///< all give the same answer, `region`
  bool moves = false;          ///< not decided, and some answer may depend on the time
  Id<Region> region;           ///< invalid: empty
  Affine texture_from_root;    ///< decided for a region with a bitmap: of every point, wrapped as the bitmap is
  std::vector<PathStep> path;  ///< decided for a segment: the way to the region; empty where nothing is
  friend bool operator==(const Verdict&, const Verdict&) = default;
};

/// The points from `a` to `b`, both included, root coordinates.
struct Segment {
  glm::dvec3 a, b;
};

/// Judges boxes and segments of a module. Thread-safe after construction.
class Judge {
 public:
  /// How the device that is judged for stores and filters grids (compile.h).
  struct Options {
    TexelFormat format = TexelFormat::r32f;
    Filter filter = Filter::hardware;
  };

  /// All snippets over a span of time: made once, used for many boxes.
  class Times {
   public:
    const snippet::Interval& span_ms() const { return span_ms_; }

   private:
    friend class Judge;
    friend class Inquiry;
    snippet::Interval span_ms_;
    std::vector<snippet::BoxFunction> functions_;
  };

  /// `records` are those of flatten() for this module; their lists are searched. Cost: a pass over the grids.
  Judge(Module module, Records records, const Options& options);
  ~Judge();

  bool is_animated() const;
  const Module& module() const;
  const Records& records() const;

  Times times(const snippet::Interval& span_ms) const;
  /// For ever: `longest_ms` back and ahead. (Of infinity, sines would be NaN.)
  const Times& always() const;

  struct Impl;

 private:
  friend class Inquiry;
  static Times prepare(const Module& module, const snippet::Interval& span_ms);

  std::unique_ptr<const Impl> impl_;
};

/// What a judge finds of one box. What it settles, it keeps for the boxes within.
class Inquiry {
 public:
  /// The box in root coordinates: of the device's points in the standard cube those that lie in it to the bit. All
  /// arguments outlive the inquiry.
  Inquiry(const Judge& judge, const Judge::Times& times, const snippet::Box& box);
  /// An inquiry about a smaller box inside that of `wider`. It reuses what `wider` has decided, which is asked first,
  /// and tests only what is open there. Not thread-safe.
  Inquiry(Inquiry& wider, const snippet::Box& box);
  /// The same for the points of a segment, and a smaller one inside it. Bounds are those of the segment in each frame,
  /// which is turned with it. A segment is decided only if all its points answer by the same path.
  Inquiry(const Judge& judge, const Judge::Times& times, const Segment& segment);
  Inquiry(Inquiry& wider, const Segment& segment);
  ~Inquiry();

  /// Where it would take long the box is given up: not decided. Cost: that of the tests on the ways that are open, at
  /// most `most_tests`, and as many for each of the wider boxes.
  Verdict verdict();
  static constexpr std::uint32_t most_tests = 256;  ///< a test asks one source or one placement

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dmvv::compiler
