// A fault made small and told.
#pragma once

#include "tests/random/check.h"
#include "tests/random/shrink.h"

namespace dmvv::tests::random_scenes {

/// The smallest scene found with the same kind of fault, and that fault, at one point of as few digits as it takes.
struct Shrunk {
  Scene scene;
  Fault fault;
};
Shrunk shrink_fault(runtime::Device& device, Scene scene, std::uint64_t seed, const Fault& fault,
                    const CheckOptions& options);

/// The VOML text, its files in a line each, and the fault.
std::string describe(const Shrunk& shrunk);

}  // namespace dmvv::tests::random_scenes
