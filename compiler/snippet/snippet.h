// A snippet of GLSL, understood: compiled by glslang, read back as a small program, evaluated on the CPU over doubles,
// intervals and dual numbers, and written out again as GLSL.
//
//   body text + what it may call --glslang--> SPIR-V --spirv-opt, read--> Program --> double | interval | dual | GLSL
//
// Whatever evaluates a snippet evaluates the same Program: names, helper functions and legacy spellings are gone by
// then.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/spirv/code_cache.h"
#include "voml/scene.h"

namespace dmvv::compiler::snippet {

/// A closed interval of reals, and whether a NaN is possible as well. Unknown is (-inf, inf) with NaN.
struct Interval {
  double lo;
  double hi;
  bool maybe_nan = false;
  friend bool operator==(const Interval&, const Interval&) = default;
};

/// What interval results must enclose.
enum class Rounding : std::uint8_t {
  real,  ///< the real-valued function (and its double evaluation): bounds rounded outward in double
  /// Also every float32 evaluation on a device: each operation widened by its permitted error, time values (see below)
  /// by the rounding of each; t itself never reaches a device, so it is not rounded.
  float32,
};

struct Box {
  glm::dvec3 lo;
  glm::dvec3 hi;
};

struct Dual {
  double value;
  glm::dvec3 gradient;  ///< by p
  double rate;          ///< by t, a millisecond
};

/// How much a function may change, and how far off its float32 evaluation may be.
struct Steepness {
  double slope = 0.0;  ///< |f(p) - f(q)| <= slope * |p - q|; infinity: nothing is known
  double error = 0.0;  ///< |f as a device computes it - f|, the point and the time values being exact
};

/// The result of a point evaluation.
struct Value {
  double f;
  bool finished;  ///< false: a loop did not end within the step budget; f is NaN
};

struct Program;
struct TimeSplit;

/// An immutable snippet `float f(vec3 p, float t)`; cheap to copy, thread-safe.
class Snippet {
 public:
  /// Instructions one evaluation may execute before it counts as a loop that does not end.
  static constexpr std::uint64_t step_budget = 1u << 20;

  /// Cost: that of split_time (time_values.h), once.
  explicit Snippet(std::shared_ptr<const Program> program);

  bool uses_time() const;
  std::size_t instruction_count() const;

  /// Conditions nested in each other in its GLSL, early exits counted (program.h). At most most_nested.
  std::uint32_t nesting() const;
  /// lavapipe ignores conditions that stand inside more than 80 others; a walker around the snippet needs some.
  static constexpr std::uint32_t most_nested = 48;

  /// In double. Cost: some 10 ns an instruction.
  Value evaluate(const glm::dvec3& p, double t_ms) const;

  /// In float32, operation by operation, as a device may compute it that fuses nothing. NaN if it does not end.
  float evaluate_single(const glm::vec3& p, float t_ms) const;

  /// Encloses f over the box and the span of time. Branches whose condition is not decided are joined; a loop that is
  /// not decided within the budget, or an instruction that is not understood, gives the unknown interval: never wrong.
  Interval evaluate(const Box& p, const Interval& t_ms, Rounding rounding) const;

  /// Bounds how steep f is over a box, at any time of a span: one bound for the whole, cheap (some 0.1 us an
  /// instruction) and coarse.
  Steepness steepness(const Box& p, const Interval& t_ms) const;

  /// Value and derivatives by forward differentiation. At kinks one of the one-sided derivatives.
  Dual differentiate(const glm::dvec3& p, double t_ms) const;

  /// What depends on t alone, computed in double and rounded once: an hour is 3,600,000 ms, where float32 steps by
  /// 0.25 ms, so t itself never reaches a shader.
  std::vector<float> time_values(double t_ms) const;
  std::size_t time_value_count() const;

  /// The snippet as GLSL: `float NAME(vec3 p) { ... }`. Value k of time_values is read as `time_values[FIRST + k]`.
  /// Self-contained but for `time_values`; names inside cannot clash. Equal programs give equal text but for NAME and
  /// FIRST.
  std::string glsl(std::string_view name, std::size_t first_time_value) const;

  /// The program in two parts (time_values.h).
  const TimeSplit& time_split() const;

 private:
  friend class BoxFunction;

  std::shared_ptr<const Program> program_;
  std::shared_ptr<const TimeSplit> split_;
};

/// A snippet over a span of time, prepared for many boxes. Immutable; cheap to copy, thread-safe.
class BoxFunction {
 public:
  /// Cost: the time part of the snippet, once.
  BoxFunction(const Snippet& snippet, const Interval& t_ms);

  /// As Snippet::evaluate with Rounding::float32.
  Interval operator()(const Box& p) const;

 private:
  struct Prepared;
  std::shared_ptr<const Prepared> prepared_;
};

/// Compiles a function of a scene together with the FUNCTIONS blocks it may use and the library it includes.
///
/// Errors, at their place in the VOML file (voml::Function::pieces): E0401 a syntax or type error of GLSL, E0402 an
/// unknown function or name (with a suggestion), E0403 a path without return, or a wrong return type, E0404 something
/// that a distance function cannot use (samplers, derivatives, images, barriers, discard, gl_ variables) with the
/// reason, E0405 recursion, E0406 a loop that does not end (with the point and time at which it ran away; probed at
/// fixed points of the cube and times), E0407 conditions nested deeper than Snippet::most_nested.
/// Warnings: W0401 NaN or infinite at a probed point (the witness).
/// Cost: some milliseconds, most of it glslang; a snippet that `cache` knows does without glslang.
std::optional<Snippet> compile_snippet(const voml::Function& function, Diagnostics& diagnostics,
                                       const CodeCache& cache = {});

}  // namespace dmvv::compiler::snippet
