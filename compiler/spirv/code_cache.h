// Where compiled code may be kept between runs. The compiler itself knows no files: whoever calls it brings the place
// (runtime/gpu/disk_cache.h has one).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dmvv::compiler {

/// Keys hold everything that the code depends on: the whole source text and what compiled it. Only code that was
/// compiled and checked is kept, and `find` must give back exactly what was kept under that key, or nothing. Both are
/// called from several threads.
struct CodeCache {
  std::function<std::optional<std::vector<std::uint32_t>>(std::string_view key)> find;  ///< may be empty: no cache
  std::function<void(std::string_view key, std::span<const std::uint32_t> spirv)> keep;
};

}  // namespace dmvv::compiler
