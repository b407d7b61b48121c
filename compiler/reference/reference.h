// The ground truth: evaluates a Module at points in double precision, on the CPU.
#pragma once

#include <memory>

#include "compiler/grids/storage.h"
#include "compiler/ir/legend.h"
#include "compiler/ir/module.h"

namespace dmvv::compiler {

/// A point's answer, and whether float32 arithmetic must come to the same.
struct ReferenceAnswer : PointAnswer {
  /// True if every decision on the way (distances, boxes, cubes, tile borders) is farther from its threshold than the
  /// error bound of float32 evaluation (spec/accuracy.md): a shader must then give the same region and path, and a
  /// colour within 1e-3.
  bool certain = true;
};

struct Visit;  // explanation.h

/// Evaluates points one by one. Thread-safe after construction.
class Reference {
 public:
  struct Options {
    bool use_index = true;  ///< lookup grids for long lists of seeds and candidates; never changes an answer
    /// Samples are read as this format stores them. What normalised formats store depends on all users of a grid: give
    /// the module after run_passes, as `compile` stores it.
    TexelFormat format = TexelFormat::r32f;
    Filter filter = Filter::hardware;  ///< trilinear, or tricubic
  };

  /// Keeps a reference to `module`, which must outlive it. Cost: building the lookup grids.
  explicit Reference(const Module& module);
  Reference(const Module& module, Options options);
  Reference(Reference&&) noexcept;
  ~Reference();

  /// The scene at `p`, root coordinates, at a time since the animation's start. Allocation-free but for the path.
  ReferenceAnswer evaluate(const glm::dvec3& p, double time_ms = 0.0) const;

  /// The same, and what was asked on the way, without distances: one visit, or none where the root's cube does not hold
  /// the point. For explain().
  ReferenceAnswer evaluate(const glm::dvec3& p, double time_ms, std::vector<Visit>& visits) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dmvv::compiler
