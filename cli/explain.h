// An explanation of a point, for people and for programs.
#pragma once

#include <string>

#include "compiler/reference/explanation.h"

namespace dmvv::cli {

/// An indented tree of what was asked, and how near the next other outcome is.
std::string explanation_text(const compiler::Module& module, const compiler::Explanation& explanation);

/// `"certain":true,"nearest":{...},"visit":{...}`: members of a JSON object, on one line.
std::string explanation_json(const compiler::Module& module, const compiler::Explanation& explanation);

}  // namespace dmvv::cli
