#include "runtime/gpu/disk_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "base/content_hash.h"

namespace dmvv::runtime {
namespace {

namespace fs = std::filesystem;

// ---- an entry as bytes: header, key, value ----

struct Header {
  char magic[8];
  std::uint64_t key_bytes;
  std::uint64_t value_bytes;
  char checksum[32];  ///< of key and value
};
static_assert(sizeof(Header) == 56);
constexpr char magic[8] = {'d', 'm', 'v', 'v', 'c', 'c', '0', '1'};
constexpr std::uint64_t most_entry_bytes = std::uint64_t{256} << 20;

std::string checksum(std::string_view key, std::string_view value) {
  ContentHash hash;
  hash.add(key);
  hash.add(value);
  return hash.digits();
}

std::string to_bytes(std::string_view key, std::string_view value) {
  Header header{};
  std::memcpy(header.magic, magic, sizeof magic);
  header.key_bytes = key.size();
  header.value_bytes = value.size();
  checksum(key, value).copy(header.checksum, sizeof header.checksum);
  std::string bytes(sizeof header, '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes.append(key).append(value);
}

/// The value, if `bytes` are a whole entry of this key.
std::optional<std::string> value_of(std::string_view bytes, std::string_view key) {
  Header header;
  if (bytes.size() < sizeof header) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof header);
  bytes.remove_prefix(sizeof header);
  if (std::memcmp(header.magic, magic, sizeof magic) != 0) return std::nullopt;
  if (header.key_bytes != key.size() || !bytes.starts_with(key)) return std::nullopt;
  const std::string_view value = bytes.substr(key.size());
  if (header.value_bytes != value.size()) return std::nullopt;
  if (checksum(key, value) != std::string_view(header.checksum, sizeof header.checksum)) return std::nullopt;
  return std::string(value);
}

fs::path path_of(const std::string& folder, std::string_view key) {
  ContentHash hash;
  hash.add(key);
  return fs::path(folder) / (hash.digits() + ".entry");
}

// ---- files ----

/// Empty if there is no such file, it cannot be read, or it is larger than any entry.
std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (!file || error || size > most_entry_bytes) return {};
  std::string bytes(size, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(file, bytes.data(), bytes.size());
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// The file comes to be whole or not at all.
void write_file(const fs::path& path, std::string_view bytes) {
  static std::atomic<unsigned> serial = 0;
  const std::string temporary = fmt::format("{}.tmp-{}-{}", path.string(), getpid(), serial++);
  const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return;
  const bool written = write_all(file, bytes);
  const bool closed = close(file) == 0;
  if (!written || !closed || rename(temporary.c_str(), path.c_str()) != 0) unlink(temporary.c_str());
}

/// Its parents are the user's; only the last folder is ours.
void make_folder(const fs::path& folder) {
  std::error_code ignored;
  fs::create_directories(folder.parent_path(), ignored);
  mkdir(folder.c_str(), 0700);
}

/// Notes that a file was used, at most once an hour.
void touch(const fs::path& path) {
  std::error_code ignored;
  const auto now = fs::file_time_type::clock::now();
  if (now - fs::last_write_time(path, ignored) > std::chrono::hours(1)) fs::last_write_time(path, now, ignored);
}

}  // namespace

DiskCache::DiskCache(std::string folder, std::uint64_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes) {}

DiskCache::~DiskCache() {
  if (!has_kept_) return;
  try {
    trim();
  } catch (const std::exception&) {  // no memory: the next process trims
  }
}

std::string DiskCache::user_folder() {
  const char* const xdg = std::getenv("XDG_CACHE_HOME");
  if (xdg != nullptr && xdg[0] == '/') return (fs::path(xdg) / "dmvv").string();
  const char* const home = std::getenv("HOME");
  return home != nullptr && home[0] == '/' ? (fs::path(home) / ".cache" / "dmvv").string() : std::string();
}

std::optional<std::string> DiskCache::find(std::string_view key) const {
  const fs::path path = path_of(folder_, key);
  auto value = value_of(read_file(path), key);
  if (value) touch(path);
  return value;
}

void DiskCache::keep(std::string_view key, std::string_view value) const {
  if (sizeof(Header) + key.size() + value.size() > std::min(most_entry_bytes, most_bytes_)) return;
  make_folder(folder_);
  write_file(path_of(folder_, key), to_bytes(key, value));
  has_kept_ = true;
}

void DiskCache::trim() const {
  struct File {
    fs::path path;
    fs::file_time_type used;
    std::uint64_t bytes;
  };
  std::vector<File> files;
  std::uint64_t bytes = 0;
  std::error_code error;
  for (fs::directory_iterator i(folder_, error), end; !error && i != end; i.increment(error)) {
    std::error_code gone;
    const auto used = i->last_write_time(gone);
    const std::uint64_t size = gone ? 0 : i->file_size(gone);
    if (gone) continue;
    files.push_back({i->path(), used, size});
    bytes += size;
  }
  if (bytes <= most_bytes_) return;
  std::ranges::sort(files, {}, [](const File& file) { return std::pair(file.used, file.path); });
  for (const File& file : files) {
    if (bytes <= most_bytes_) break;
    if (fs::remove(file.path, error)) bytes -= file.bytes;
  }
}

compiler::CodeCache code_cache(std::shared_ptr<const DiskCache> cache) {
  if (!cache) return {};
  return {.find = [cache](std::string_view key) -> std::optional<std::vector<std::uint32_t>> {
            const auto bytes = cache->find(key);
            if (!bytes || bytes->size() % 4 != 0) return std::nullopt;
            std::vector<std::uint32_t> words(bytes->size() / 4);
            std::memcpy(words.data(), bytes->data(), bytes->size());
            return words;
          },
          .keep =
              [cache](std::string_view key, std::span<const std::uint32_t> spirv) {
                cache->keep(key, {reinterpret_cast<const char*>(spirv.data()), spirv.size_bytes()});
              }};
}

}  // namespace dmvv::runtime
