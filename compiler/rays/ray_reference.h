// The ground truth for rays, in double on the CPU: which regions a ray meets, exactly where, and what is seen.
//
//   ray, cuts --clipped to cube and cuts--> span of t --halved until proven--> answers with gaps around boundaries
//       --bisected in the gaps--> segments --absorbed and emitted, front to back--> colour
#pragma once

#include <memory>
#include <span>

#include "compiler/ir/module.h"
#include "compiler/rays/ray.h"
#include "compiler/reference/reference.h"

namespace dmvv::compiler {

/// Follows rays one by one. Thread-safe after construction.
class RayReference {
 public:
  /// Keeps a reference to `module`, which must outlive it. Cost: that of Reference, and a copy of the module, which is
  /// proven from (proofs/judge.h).
  explicit RayReference(const Module& module, Reference::Options options = {});
  RayReference(RayReference&&) noexcept;
  ~RayReference();

  /// What the ray meets at a time, up to and including the first opaque region.
  ///
  /// Boundaries are those of Reference::evaluate, to the last bits of t that its rounding leaves. Beyond their errors
  /// the answers are proven. Nearer to them, points 2^-22 root units apart are evaluated, and an answer that shows at
  /// none of them is missed.
  ///
  /// Colours: regions with an opacity below `least_opaque` have the extinction -ln(1 - opacity) a unit of their object
  /// and emit their colour; integrals are exact for constant regions, and good to 1e-10 for bitmaps.
  ///
  /// Cost: some 60 inquiries (1 to 50 us each) a boundary.
  RayAnswer along(const Ray& ray, std::span<const Cut> cuts = {}, double time_ms = 0.0) const;

  /// The points that it evaluates.
  const Reference& points() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dmvv::compiler
