// What was compiled, kept in a folder between runs.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "compiler/spirv/code_cache.h"

namespace dmvv::runtime {

/// A folder of entries, a file each, named by the hash of the entry's key. A file holds key and value with a checksum,
/// so that a damaged, cut off or foreign file counts as not there and two keys of the same hash are told apart. Files
/// come into being whole (a temporary name, renamed), so that any number of processes may use, clear or delete the
/// folder at any moment. What cannot be read or written is not kept: a cache never fails.
class DiskCache {
 public:
  static constexpr std::uint64_t default_bytes = std::uint64_t{256} << 20;

  /// `folder` is made when something is first kept, readable for its owner only.
  explicit DiskCache(std::string folder, std::uint64_t most_bytes = default_bytes);
  /// If anything was kept: the files that have not been used for longest are removed until `most_bytes` are left.
  ~DiskCache();
  DiskCache(const DiskCache&) = delete;
  DiskCache& operator=(const DiskCache&) = delete;

  /// The user's cache folder for dmvv: $XDG_CACHE_HOME/dmvv, or ~/.cache/dmvv; empty if neither is set
  /// (XDG Base Directory Specification 0.8).
  static std::string user_folder();

  /// Thread-safe. Cost: reading one file.
  std::optional<std::string> find(std::string_view key) const;
  /// Thread-safe. Cost: writing one file.
  void keep(std::string_view key, std::string_view value) const;

 private:
  void trim() const;

  std::string folder_;
  std::uint64_t most_bytes_;
  mutable std::atomic<bool> has_kept_ = false;
};

/// The compiler's view of a cache, which it keeps alive; null: no cache.
compiler::CodeCache code_cache(std::shared_ptr<const DiskCache> cache);

}  // namespace dmvv::runtime
