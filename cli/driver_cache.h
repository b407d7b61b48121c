// The driver's own shader cache is chosen by the process' environment, so only the program can switch it off.
#pragma once

namespace dmvv::cli {

/// From now on drivers that are loaded find an empty cache, a new one with each call, in a folder that goes with the
/// process. Drivers read this when an instance is made; Vulkan has no call for it. Not while other threads run.
void empty_driver_cache();

}  // namespace dmvv::cli
