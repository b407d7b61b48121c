// Files that a command writes: checked before the work, written all or not at all.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace dmvv::cli {

/// A set of files. Each is written under a temporary name beside its own; `commit` renames them all.
/// What was not committed is removed when the set goes out of scope.
class Outputs {
 public:
  Outputs() = default;
  Outputs(const Outputs&) = delete;
  Outputs& operator=(const Outputs&) = delete;
  ~Outputs();

  /// Announces a file, and refuses what would fail after the work: another ending than `endings` (any if there are
  /// none), a folder that does not exist or cannot be written, a directory of that name, a file announced before.
  /// Ends the command with exit code 1.
  void announce(const std::string& path, const std::vector<std::string_view>& endings = {});

  /// Calls `write` with the temporary name, which has the ending of `path`; a failure ends the command.
  void write(const std::string& path, const std::function<Result<void>(const std::string& temporary)>& write);

  /// Writes these bytes.
  void write_bytes(const std::string& path, std::string_view bytes);

  void commit();

 private:
  struct Written {
    std::string temporary;
    std::string path;
  };
  std::vector<std::string> announced_;
  std::vector<Written> written_;
};

/// "a/b.exr", ".json" -> "a/b.json"
std::string with_ending(const std::string& path, std::string_view ending);

}  // namespace dmvv::cli
