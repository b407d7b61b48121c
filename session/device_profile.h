// A device's profile says what it can, and what arithmetic, fetches and branches cost on it: measured with a handful of
// small programs.
#pragma once

#include "compiler/compile.h"
#include "runtime/runtime.h"

namespace dmvv::session {

/// The costs that `calibrate` kept for this device and driver in the device's cache; those of its kind if there are
/// none. They choose between forms of code whose answers are the same. Cost: reading one file.
compiler::DeviceCosts costs_of(const runtime::Device& device);

/// Tells the options all that a program for this device must know of it: its limits, its costs, and that its records
/// are read from texels if it is a CPU (bench/NOTES.md).
void fit_to(const runtime::Device& device, compiler::CompileOptions& options);

/// Measures a device's costs and keeps them in its cache, unless they are there already; does nothing without a cache.
/// A device that cannot be measured (a driver that fails, no time stamps) goes on counting as one of its kind. Cost:
/// once a device and driver, some 0.4 s on lavapipe, most of it the driver's compiler.
void calibrate(runtime::Device& device);

}  // namespace dmvv::session
