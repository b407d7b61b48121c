// Inside compiler: what lint says of the source of one SDF, wherever it is used.
#pragma once

#include "base/diagnostics.h"
#include "compiler/ir/module.h"
#include "compiler/reference/lint_samples.h"

namespace dmvv::compiler {

/// Looks at the sources of a module's SDFs, one after the other, and reports W0402, W0404 and W0406 (lint.h).
class SourceLint {
 public:
  SourceLint(const Module& module, SampledFunctions& samples, Diagnostics& diagnostics)
      : module_(module), samples_(samples), diagnostics_(diagnostics), measured_(module.functions.size()) {}

  void check(const Sdf& sdf);

 private:
  /// The largest gradient found.
  struct Steepest {
    double norm = 0.0;
    glm::dvec3 p{0.0};
    double t_ms = 0.0;
  };

  void check_function(const Sdf& sdf, Id<Function> id);
  void check_grid(const Sdf& sdf, const voml::Grid& grid);
  Steepest steepest_gradient(const snippet::Snippet& snippet) const;
  void report_gradient(const Sdf& sdf, const Steepest& steepest, bool uses_time);
  bool report_missing_surface(const Sdf& sdf, Id<Function> id, double steepest);
  void report_one_side(const Sdf& sdf, const Extremes& extremes, bool is_inside, bool uses_time, bool is_grid);
  void check_rounding(const Sdf& sdf, const snippet::Snippet& snippet);

  const Module& module_;
  SampledFunctions& samples_;
  Diagnostics& diagnostics_;
  std::vector<bool> measured_;  ///< functions whose gradient and rounding were looked at
};

}  // namespace dmvv::compiler
