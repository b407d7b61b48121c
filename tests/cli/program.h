// Runs the program dmvv as a user would, in folders that vanish.
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>
#include <vector>

namespace dmvv::tests {

struct Run {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string out;
  std::string err;
};

/// Runs `dmvv` with these arguments; `input` is its standard input.
Run run_dmvv(const std::vector<std::string>& arguments, std::string_view input = "");

/// Starts `dmvv` and returns at once; its standard error goes to `err_path`. The caller waits for the process.
pid_t start_dmvv(const std::vector<std::string>& arguments, const std::string& err_path);

/// A folder of its own, removed with everything in it.
class Folder {
 public:
  Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();

  std::string file(std::string_view name) const { return path_ + '/' + std::string(name); }
  /// Writes a file and returns its path.
  std::string write(std::string_view name, std::string_view bytes) const;
  std::string read(std::string_view name) const;
  /// Every path below the folder, sorted: hidden and temporary files too.
  std::vector<std::string> listing() const;

 private:
  std::string path_;
};

std::string read_file(const std::string& path);

}  // namespace dmvv::tests
