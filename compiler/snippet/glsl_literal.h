// Numbers as GLSL writes them.
#pragma once

#include <string>

namespace dmvv::compiler {

/// A float32 as a GLSL literal that reads back as the same value.
std::string glsl_float(float value);

}  // namespace dmvv::compiler
