#include "compiler/ir/rounding.h"

#include <glm/common.hpp>

namespace dmvv::compiler {

glm::dvec3 float_error(const Affine& affine, const glm::dvec3& reach) {
  const glm::dvec3 rounding = 6.0 * float_unit * (abs_times(affine.linear, reach) + glm::abs(affine.translation));
  return rounding + float_denormal * (abs_times(affine.linear, glm::dvec3(1.0)) + 10.0);
}

}  // namespace dmvv::compiler
