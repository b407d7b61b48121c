// The environment's failures as values: missing files, no device, out of memory.
// The author's mistakes are diagnostics instead (diagnostics.h); bugs are assertions.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

namespace dmvv {

/// Whose fault a failure is; the command line turns it into its exit code.
enum class Fault {
  input,        ///< the file or value the user gave: exit code 1
  environment,  ///< the machine: no driver, no memory, no permission: exit code 2
};

/// One failure: what was attempted, what came back, and every reason known, in the order they apply.
struct Error {
  Fault fault = Fault::environment;
  std::string message;               ///< one sentence, lower case, no full stop
  std::vector<std::string> reasons;  ///< details and ways out, a line each
};

template <class T>
using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> fail(Fault fault, std::string message, std::vector<std::string> reasons = {}) {
  return tl::unexpected<Error>(Error{fault, std::move(message), std::move(reasons)});
}

}  // namespace dmvv
