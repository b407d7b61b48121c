// A signed distance source of a scene as a function of space, at one moment: what is baked into a grid.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "compiler/ir/module.h"
#include "voml/assets/mesh.h"

namespace dmvv::authoring {

/// The SDF of this name that the tree of the module's root object uses; if it uses none, the one that all other objects
/// use. Errors (input): no object uses one (the nearest name is offered); several objects use different ones.
Result<Id<compiler::Sdf>> find_sdf(const compiler::Module& module, const std::string& name);

/// The value of an SDF in the frame of its object, its iso-value taken off: not above zero exactly where a decision on
/// the SDF goes to its negative side. Grids are sampled, snippets evaluated in double.
///
/// A placement's values are its source's, in the units of its own frame; of several the least counts. Where the box of
/// a placement ends within the object's cube, its negative side ends with it, so that there the value is
///   inside:  the greater of the source's and the distance to the box's nearest face, negative;
///   outside: that of the nearest face, not below zero, and the distance to it.
/// No jump is left at a box's faces, where the value would otherwise be infinite outside.
/// A value that is a NaN or +infinity becomes 4, -infinity -4: more than the cube's diagonal.
class Field {
 public:
  /// Keeps a reference to the module. Boxes farther than `reach` (object units) count as no nearer than that.
  Field(const compiler::Module& module, Id<compiler::Sdf> sdf, double time_ms, double reach);
  Field(Field&&) noexcept;
  ~Field();

  struct Value {
    double value;
    bool finite;  ///< whether the source gave a number within float32's range wherever it was asked
  };
  /// Thread-safe. In the object's standard cube, or a little outside it.
  Value evaluate(const glm::dvec3& p) const;
  double operator()(const glm::dvec3& p) const { return evaluate(p).value; }

  /// A box that holds all points of the object's cube at which the value is not above zero: proved, by interval
  /// arithmetic where the source is a snippet. Nothing if there are none.
  std::optional<voml::Bounds> inside() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dmvv::authoring
