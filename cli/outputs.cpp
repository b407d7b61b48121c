#include "cli/outputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "base/files.h"
#include "base/text.h"
#include "cli/context.h"

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

std::string lower_case_ending(const fs::path& path) { return lower_case(path.extension().string()); }

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

}  // namespace

Outputs::~Outputs() {
  std::error_code ignored;
  for (const Written& file : written_) fs::remove(file.temporary, ignored);
}

void Outputs::announce(const std::string& path, const std::vector<std::string_view>& endings) {
  const auto refuse = [](std::string message, std::vector<std::string> reasons = {}) {
    fail_with({Fault::input, std::move(message), std::move(reasons)});
  };
  const fs::path target(path);
  const fs::path folder = folder_of(target);
  std::error_code error;
  if (path.empty()) refuse("the name of an output file is empty");
  if (endings.size() != 0 && std::ranges::find(endings, lower_case_ending(target)) == endings.end()) {
    refuse(fmt::format("cannot write '{}': its ending names no known format", path),
           {fmt::format("use {}", fmt::join(endings, ", "))});
  }
  if (!fs::exists(folder, error)) {
    refuse(fmt::format("cannot write '{}': the folder '{}' does not exist", path, folder.string()),
           {fmt::format("make it first: mkdir -p '{}'", folder.string())});
  }
  if (!fs::is_directory(folder, error)) {
    refuse(fmt::format("cannot write '{}': '{}' is not a folder", path, folder.string()));
  }
  if (fs::is_directory(target, error)) refuse(fmt::format("cannot write '{}': it is a directory", path));
  if (access(folder.c_str(), W_OK) != 0) {
    refuse(fmt::format("cannot write '{}': no permission to write into '{}'", path, folder.string()));
  }
  const std::string canonical = (fs::weakly_canonical(folder, error) / target.filename()).string();
  if (std::ranges::find(announced_, canonical) != announced_.end()) {
    refuse(fmt::format("'{}' is the name of two outputs", path));
  }
  announced_.push_back(canonical);
}

void Outputs::write(const std::string& path, const std::function<Result<void>(const std::string&)>& write) {
  const fs::path target(path);
  const std::string name = fmt::format(".{}.{}.part{}", target.stem().string(), getpid(), target.extension().string());
  const std::string temporary = (target.has_parent_path() ? target.parent_path() / name : fs::path(name)).string();
  written_.push_back({temporary, path});
  Result<void> result = write(temporary);
  if (result) return;
  replace_all(result.error().message, temporary, path);
  for (std::string& reason : result.error().reasons) replace_all(reason, temporary, path);
  fail_with(std::move(result.error()));
}

void Outputs::write_bytes(const std::string& path, std::string_view bytes) {
  write(path, [&](const std::string& temporary) { return write_file(temporary, bytes); });
}

void Outputs::commit() {
  for (std::size_t i = 0; i < written_.size(); ++i) {
    std::error_code error;
    fs::rename(written_[i].temporary, written_[i].path, error);
    if (!error) continue;
    std::error_code ignored;
    for (std::size_t done = 0; done < i; ++done) fs::remove(written_[done].path, ignored);
    fail_with({Fault::environment, fmt::format("cannot write '{}': {}", written_[i].path, error.message()), {}});
  }
  written_.clear();
}

std::string with_ending(const std::string& path, std::string_view ending) {
  return fs::path(path).replace_extension(ending).string();
}

}  // namespace dmvv::cli
