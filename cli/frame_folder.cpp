#include "cli/frame_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "base/files.h"

namespace dmvv::cli {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

constexpr std::string_view manifest_name = "MANIFEST.json";
constexpr std::string_view partials_name = ".dmvv-partial";
constexpr std::uint64_t max_manifest_bytes = 1 << 16;
constexpr int max_manifest_depth = 8;
constexpr std::size_t max_differences = 8;

/// The manifest that is there; discarded if it is none.
json parse_manifest(const std::string& text) {
  const auto shallow = [](int depth, json::parse_event_t, json&) { return depth <= max_manifest_depth; };
  return json::parse(text, shallow, false);
}

std::string text_of(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

/// Adds what `there` says otherwise than `asked`, member by member down to the second level.
void add_differences(const json& there, const json& asked, const std::string& prefix, std::vector<std::string>& lines) {
  for (const auto& [key, value] : asked.items()) {
    if (prefix.empty() && key == "scene") continue;  // a file's name may change
    const json other = there.contains(key) ? there[key] : json();
    if (value.is_object() && other.is_object() && prefix.empty()) {
      add_differences(other, value, key + ".", lines);
    } else if (other != value && lines.size() < max_differences) {
      lines.push_back(fmt::format("{}{}: {} there, {} asked for", prefix, key, text_of(other), text_of(value)));
    }
  }
}

Error failed(std::string_view what, const std::string& path, const std::string& why) {
  return {Fault::environment, fmt::format("cannot {} '{}': {}", what, path, why), {}};
}

std::string last_reason() { return std::generic_category().message(errno); }

}  // namespace

/// An advisory lock on the folder: runs that fill it share it, one that tidies up has it alone. On file systems without
/// such locks nobody is ever alone, and nothing is tidied.
class FrameFolder::Lock {
 public:
  explicit Lock(const std::string& folder) : fd_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock() {
    if (fd_ >= 0) close(fd_);
  }

  bool take_alone() { return flock(fd_, LOCK_EX | LOCK_NB) == 0; }
  void share() { flock(fd_, LOCK_SH); }

 private:
  int fd_;
};

FrameFolder::FrameFolder(FrameNames names, glm::uvec2 size_px, json manifest)
    : names_(std::move(names)), size_px_(size_px), manifest_(std::move(manifest)) {}

FrameFolder::~FrameFolder() {
  if (partials_.empty()) return;
  std::error_code ignored;
  fs::remove_all(partials_, ignored);
  fs::remove(file(partials_name), ignored);  // only if no other run has a folder in it
}

std::string FrameFolder::file(std::string_view name) const { return (fs::path(names_.folder()) / name).string(); }
std::string FrameFolder::path(std::uint32_t frame) const { return file(names_.name(frame)); }
std::string FrameFolder::partial(std::string_view name) const { return (fs::path(partials_) / name).string(); }

Result<void> FrameFolder::check() const {
  const std::vector<std::string> ways{"choose another name in another folder, or remove those frames with --restart"};
  const std::string path = file(manifest_name);
  std::error_code error;
  if (!fs::exists(path, error)) {
    for (const auto& entry : fs::directory_iterator(names_.folder(), error)) {
      if (!names_.frame_of(entry.path().filename().string())) continue;
      return fail(Fault::input,
                  fmt::format("'{}' exists, and no {} says how it was made", entry.path().string(), manifest_name),
                  ways);
    }
    return {};
  }
  const auto text = disk_files()(path, max_manifest_bytes);
  if (!text) return tl::unexpected(text.error());
  const json there = parse_manifest(*text);
  if (!there.is_object()) return fail(Fault::input, fmt::format("'{}' is not a manifest of frames", path), ways);
  std::vector<std::string> lines;
  add_differences(there, manifest_, "", lines);
  if (lines.empty()) return {};
  lines.insert(lines.end(), ways.begin(), ways.end());
  return fail(Fault::input, fmt::format("the frames that '{}' describes are others than those asked for", path), lines);
}

void FrameFolder::remove_frames() const {
  // Those of the names asked for, and those of the manifest that is there.
  std::vector<FrameNames> patterns{names_};
  const auto text = disk_files()(file(manifest_name), max_manifest_bytes);
  const json there = text ? parse_manifest(*text) : json();
  if (there.is_object() && there.contains("names") && there["names"].is_string()) {
    const auto pattern = there["names"].get<std::string>();
    auto old = FrameNames::parse(file(pattern));
    if (old && old->pattern() == pattern) patterns.push_back(std::move(*old));
  }
  std::error_code ignored;
  std::vector<fs::path> frames;
  for (const auto& entry : fs::directory_iterator(names_.folder(), ignored)) {
    for (const FrameNames& names : patterns) {
      if (names.frame_of(entry.path().filename().string())) frames.push_back(entry.path());
    }
  }
  for (const fs::path& frame : frames) fs::remove(frame, ignored);
  fs::remove(file(manifest_name), ignored);
}

void FrameFolder::remove_partials() const {
  std::error_code ignored;
  fs::remove_all(file(partials_name), ignored);
}

Result<void> FrameFolder::begin(bool restart) {
  std::error_code error;
  fs::create_directory(names_.folder(), error);
  if (error) return tl::unexpected(failed("make the folder", names_.folder(), error.message()));
  lock_ = std::make_unique<Lock>(names_.folder());
  const bool alone = lock_->take_alone();
  if (restart && !alone) {
    return fail(Fault::input, fmt::format("cannot restart: another run is filling '{}'", names_.folder()),
                {"wait for it, or stop it"});
  }
  if (alone) remove_partials();
  if (restart) remove_frames();
  if (!alone) lock_->share();  // waits until a run that is alone is done with tidying
  if (auto fine = check(); !fine) return fine;

  fs::create_directory(file(partials_name), error);
  std::string own = file(partials_name) + "/XXXXXX";
  if (!mkdtemp(own.data())) return tl::unexpected(failed("make a folder in", file(partials_name), last_reason()));
  partials_ = own;
  if (!fs::exists(file(manifest_name), error)) {
    const std::string text = manifest_.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
    if (auto written = write_file(partial(manifest_name), text); !written) return written;
    if (auto moved = publish(manifest_name, file(manifest_name)); !moved) return moved;
  }
  if (alone) lock_->share();
  return {};
}

std::vector<std::uint32_t> FrameFolder::missing(FrameRange range) const {
  std::vector<std::uint32_t> result;
  for (std::uint32_t frame = range.first; frame <= range.last; ++frame) {
    if (!is_whole_frame(path(frame), size_px_)) result.push_back(frame);
  }
  return result;
}

Result<void> FrameFolder::publish(std::string_view name, const std::string& target) const {
  std::error_code error;
  fs::rename(partial(name), target, error);
  if (error) return tl::unexpected(failed("write", target, error.message()));
  return {};
}

bool FrameFolder::remove() {
  if (!lock_->take_alone()) return false;
  remove_frames();
  remove_partials();
  partials_.clear();
  std::error_code ignored;
  fs::remove(names_.folder(), ignored);  // only if it is empty
  return true;
}

}  // namespace dmvv::cli
