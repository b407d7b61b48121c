// Where a scene's bytes come from: the disk, or memory in tests and in programs that have no files.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "base/result.h"

namespace dmvv {

/// Reads a whole file. Paths use '/'; relative ones have been joined to the folder of the file that names them.
/// Errors: Fault::input with the reason (no such file, a directory, not a regular file, longer than `max_bytes`). Of a
/// file that is missing the message offers the one that may be meant: by '/' for a backslash, letters of another case,
/// a misspelling.
using ReadFile = std::function<Result<std::string>(const std::string& path, std::uint64_t max_bytes)>;

/// Reads from disk.
ReadFile disk_files();

/// Reads from a map path -> bytes.
ReadFile memory_files(std::map<std::string, std::string> files);

/// Writes all bytes to `path` by way of a temporary name beside it, so that a failure leaves nothing half-written.
/// Errors: Fault::input if the folder does not exist or the path is a directory, Fault::environment otherwise.
Result<void> write_file(const std::string& path, std::string_view bytes);

/// A new folder, which goes with its content when this does.
class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  /// Empty if it could not be made.
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The executable of this name in the folders of $PATH.
std::optional<std::string> find_program(const std::string& name);

}  // namespace dmvv
