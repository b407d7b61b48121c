#include "base/files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <sstream>
#include <system_error>
#include <vector>

#include "base/diagnostics.h"
#include "base/text.h"

namespace dmvv {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

auto cannot(std::string_view what, Fault fault, const std::string& path, std::string_view why) {
  return fail(fault, fmt::format("cannot {} '{}': {}", what, path, why));
}

std::string reason(int error_number) { return std::generic_category().message(error_number); }

// ---- what may be meant by the name of a file that is not there ----

/// The names in a folder, "" being the current one; nothing if there is no such folder.
using ListFolder = std::function<std::vector<std::string>(const std::string& folder)>;

std::vector<std::string> list_folder(const std::string& folder) {
  constexpr std::size_t most = 20000;
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder.empty() ? "." : folder, error), end; !error && at != end; at.increment(error)) {
    names.push_back(at->path().filename().string());
    if (names.size() == most) break;
  }
  std::ranges::sort(names);  // folders have no order
  return names;
}

/// The name among `names` that is `name` but for the case of its letters, or for a typo before its ending.
std::optional<std::string> similar_name(const std::string& name, const std::vector<std::string>& names) {
  if (std::ranges::find(names, name) != names.end()) return name;
  for (const std::string& other : names) {
    if (same_word(name, other)) return other;
  }
  const std::string stem = fs::path(name).stem().string(), ending = fs::path(name).extension().string();
  constexpr std::size_t shortest = 3;  // of a stem: others are near to everything
  if (stem.size() < shortest) return std::nullopt;
  std::vector<std::string_view> stems;
  std::vector<const std::string*> whole;
  for (const std::string& other : names) {
    const std::string_view view = other;
    if (view.size() < ending.size() || !same_word(view.substr(view.size() - ending.size()), ending)) continue;
    stems.push_back(view.substr(0, view.size() - ending.size()));
    whole.push_back(&other);
  }
  const auto near = nearest_name(stem, stems);
  if (!near) return std::nullopt;
  return *whole[static_cast<std::size_t>(std::ranges::find(stems, *near) - stems.begin())];
}

/// The path to something that exists and that `path` may mean.
std::optional<std::string> similar_path(const std::string& path, const ListFolder& list) {
  fs::path found;
  for (const fs::path& part : fs::path(path)) {
    if (part == "." || part == ".." || part.has_root_directory()) {
      found /= part;
      continue;
    }
    const auto name = similar_name(part.string(), list(found.generic_string()));
    if (!name) return std::nullopt;
    found /= *name;
  }
  return found.empty() ? std::nullopt : std::optional(found.generic_string());
}

/// What to say of a file that is not there.
std::string no_such_file(const std::string& path, const ListFolder& list) {
  std::string slashed = path;
  std::ranges::replace(slashed, '\\', '/');
  if (slashed == path) {
    const auto meant = similar_path(path, list);
    return meant && *meant != path ? fmt::format("no such file; did you mean '{}'?", *meant) : "no such file";
  }
  // A path of Windows: folders as they are, or, of a drive, the file beside the one that names it.
  auto meant = similar_path(slashed, list);
  const std::size_t folder = path.find_last_of('/', path.find('\\'));
  const std::string beside = path.substr(0, folder == std::string::npos ? 0 : folder + 1);
  if (!meant) meant = similar_path(beside + fs::path(slashed).filename().string(), list);
  constexpr std::string_view cause = "no such file; '/' separates folders, not '\\'";
  return meant ? fmt::format("{}; did you mean '{}'?", cause, *meant) : fmt::format("{}: write '{}'", cause, slashed);
}

Result<std::string> read_whole(const std::string& path, std::uint64_t max_bytes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    return cannot("read", Fault::input, path, no_such_file(path, list_folder));
  }
  if (fs::is_directory(status)) return cannot("read", Fault::input, path, "it is a directory");
  if (status.type() == fs::file_type::none) return cannot("read", Fault::input, path, error.message());
  if (!fs::is_regular_file(status)) return cannot("read", Fault::input, path, "not a regular file");
  const std::uint64_t size = fs::file_size(path, error);
  if (error) return cannot("read", Fault::input, path, error.message());
  if (size > max_bytes) {
    return cannot("read", Fault::input, path, fmt::format("it has {} bytes, at most {} are allowed", size, max_bytes));
  }
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) return cannot("read", Fault::input, path, reason(errno));
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
    return cannot("read", Fault::input, path, std::ferror(file.get()) ? reason(errno) : "it shrank while being read");
  }
  return bytes;
}

std::string normal(const std::string& path) { return fs::path(path).lexically_normal().generic_string(); }

/// The names in a folder of a map of paths: what stands behind `prefix` up to the next '/'.
std::vector<std::string> names_below(const std::map<std::string, std::string>& files, const std::string& prefix) {
  std::vector<std::string> names;
  for (auto at = files.lower_bound(prefix); at != files.end() && at->first.starts_with(prefix); ++at) {
    const std::string name = at->first.substr(prefix.size(), at->first.find('/', prefix.size()) - prefix.size());
    if (names.empty() || names.back() != name) names.push_back(name);
  }
  return names;
}

bool write_and_close(File file, std::string_view bytes) {
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  return std::fclose(file.release()) == 0 && written;
}

}  // namespace

ReadFile disk_files() {
  return [](const std::string& path, std::uint64_t max_bytes) -> Result<std::string> {
    try {
      return read_whole(path, max_bytes);
    } catch (const std::bad_alloc&) {
      return cannot("read", Fault::environment, path, "not enough memory");
    } catch (const std::exception& e) {
      return cannot("read", Fault::environment, path, e.what());
    }
  };
}

ReadFile memory_files(std::map<std::string, std::string> files) {
  std::map<std::string, std::string> by_path;
  for (auto& [path, bytes] : files) by_path[normal(path)] = std::move(bytes);
  return [by_path = std::move(by_path)](const std::string& path, std::uint64_t max_bytes) -> Result<std::string> {
    const std::string name = normal(path);
    const auto found = by_path.find(name);
    if (found == by_path.end()) {
      const auto below = by_path.lower_bound(name + "/");
      const bool directory = below != by_path.end() && below->first.starts_with(name + "/");
      const auto list = [&](const std::string& folder) {
        const std::string prefix = folder.empty() ? "" : normal(folder);
        return names_below(by_path, prefix.empty() || prefix.ends_with('/') ? prefix : prefix + "/");
      };
      return cannot("read", Fault::input, path, directory ? "it is a directory" : no_such_file(path, list));
    }
    const std::uint64_t size = found->second.size();
    if (size > max_bytes) {
      return cannot("read", Fault::input, path,
                    fmt::format("it has {} bytes, at most {} are allowed", size, max_bytes));
    }
    return found->second;
  };
}

Result<void> write_file(const std::string& path, std::string_view bytes) {
  try {
    const fs::path target(path);
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
      return cannot("write", Fault::input, path, fmt::format("the folder '{}' does not exist", folder.string()));
    }
    if (path.empty() || fs::is_directory(target, error)) {
      return cannot("write", Fault::input, path, path.empty() ? "the name is empty" : "it is a directory");
    }
    const std::string temporary = fmt::format("{}.{}.tmp", path, ::getpid());
    File file(std::fopen(temporary.c_str(), "wb"));
    if (!file) return cannot("write", Fault::environment, path, reason(errno));
    if (!write_and_close(std::move(file), bytes)) {
      const int number = errno;
      std::remove(temporary.c_str());
      return cannot("write", Fault::environment, path, reason(number));
    }
    if (std::rename(temporary.c_str(), path.c_str()) != 0) {
      const int number = errno;
      std::remove(temporary.c_str());
      return cannot("write", Fault::environment, path, reason(number));
    }
    return {};
  } catch (const std::exception& e) {
    return cannot("write", Fault::environment, path, e.what());
  }
}

TemporaryFolder::TemporaryFolder() {
  std::error_code ignored;
  std::string name = (std::filesystem::temp_directory_path(ignored) / "dmvv-XXXXXX").string();
  if (mkdtemp(name.data()) != nullptr) path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

std::optional<std::string> find_program(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string program = (std::filesystem::path(folder.empty() ? "." : folder) / name).string();
    std::error_code ignored;
    if (std::filesystem::is_regular_file(program, ignored) && access(program.c_str(), X_OK) == 0) return program;
  }
  return std::nullopt;
}

}  // namespace dmvv
