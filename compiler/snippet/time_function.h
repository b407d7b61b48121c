// What depends on time alone, computed once a frame.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "compiler/snippet/snippet.h"

namespace dmvv::compiler {

/// A snippet's share of the buffer `time_values`: values [first, first + snippet.time_value_count()).
struct TimeFunction {
  snippet::Snippet snippet;
  std::size_t first;
};

/// The contents of the buffer at binding DMVV_BIND_TIME for a frame: whatever depends on time alone, computed in double
/// and rounded once (spec/time.md). Empty in a static scene. Cost: the time part of each snippet, once a frame.
std::vector<float> time_values(std::span<const TimeFunction> functions, double time_ms);

}  // namespace dmvv::compiler
