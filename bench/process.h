// Other programs, run to their end.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace dmvv::bench {

/// The variables of this process, "NAME=VALUE" each.
std::vector<std::string> environment_variables();

/// Runs words[0], a path, with the other words as its arguments. It has nothing to read; what it prints is dropped, its
/// stderr goes into the file `log`. Returns whether its exit code was 0. Errors (environment): it cannot be started.
Result<bool> run_program(std::vector<std::string> words, std::vector<std::string> variables, const std::string& log);

}  // namespace dmvv::bench
