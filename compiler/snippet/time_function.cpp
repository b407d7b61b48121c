#include "compiler/snippet/time_function.h"

namespace dmvv::compiler {

std::vector<float> time_values(std::span<const TimeFunction> functions, double time_ms) {
  std::vector<float> values;
  for (const TimeFunction& function : functions) {
    const std::vector<float> own = function.snippet.time_values(time_ms);
    values.insert(values.end(), own.begin(), own.end());
  }
  return values;
}

}  // namespace dmvv::compiler
