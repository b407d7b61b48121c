// Inside compiler/snippet: what glslang says -> what an author understands.
#pragma once

#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "compiler/snippet/glslang_front.h"

namespace dmvv::compiler::snippet {

/// Where an error stands.
struct ErrorPlace {
  std::string_view word;  ///< the token there, as the author wrote it
  bool in_body = false;   ///< in the body of the distance function, not in FUNCTIONS
  bool at_end = false;    ///< behind the last token of the text
};

struct Explanation {
  Code code;  ///< E0401, E0402 or E0403
  std::string sentence;
};

/// Unknown names and calls without a matching function need to know the scene; their sentences are without a way out.
Explanation explain(const LogEntry& entry, const ErrorPlace& place);

/// "in highp 3-component vector of float" -> "vec3".
std::string short_type(std::string_view type);

}  // namespace dmvv::compiler::snippet
