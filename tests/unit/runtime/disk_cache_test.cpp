// The cache of compiled code: what was kept comes back exactly, or not at all.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include "runtime/gpu/disk_cache.h"

using dmvv::runtime::code_cache;
using dmvv::runtime::DiskCache;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / ("dmvv_cache_" + std::to_string(getpid()));
  Folder() { fs::remove_all(path); }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  std::string cache() const { return (path / "of" / "mine").string(); }
};

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

}  // namespace

TEST_CASE("what is kept is found, by its key alone") {
  const Folder folder;
  const DiskCache cache(folder.cache());
  CHECK_FALSE(cache.find("key"));
  cache.keep("key", std::string("a\0b", 3));
  cache.keep("", "");
  CHECK(cache.find("key") == std::string("a\0b", 3));
  CHECK(cache.find("") == "");
  CHECK_FALSE(cache.find("ke"));
  cache.keep("key", "new");
  CHECK(DiskCache(folder.cache()).find("key") == "new");
  struct stat status {};
  REQUIRE(stat(folder.cache().c_str(), &status) == 0);
  CHECK((status.st_mode & 077) == 0);  // its owner's alone
}

TEST_CASE("a damaged entry is none: every bit flipped, every length cut") {
  const Folder folder;
  const DiskCache cache(folder.cache());
  cache.keep("the key", "the value");
  const fs::path file = files_in(folder.cache()).at(0);
  const std::string whole = read(file);
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    write(file, damaged);
    CAPTURE(bit);
    CHECK_FALSE(cache.find("the key"));
  }
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write(file, whole.substr(0, length));
    CHECK_FALSE(cache.find("the key"));
  }
  write(file, whole + "x");
  CHECK_FALSE(cache.find("the key"));
  cache.keep("the key", "the value");
  CHECK(read(file) == whole);
}

TEST_CASE("an entry under another key's name is not taken for it") {
  const Folder folder;
  const DiskCache cache(folder.cache());
  cache.keep("one", "1");
  const fs::path one = files_in(folder.cache()).at(0);
  cache.keep("two", "2");
  for (const fs::path& file : files_in(folder.cache())) {
    if (file != one) fs::copy_file(file, one, fs::copy_options::overwrite_existing);
  }
  CHECK_FALSE(cache.find("one"));
  CHECK(cache.find("two") == "2");
}

TEST_CASE("a cache that cannot be written, or that vanishes, is no error") {
  const Folder folder;
  write(fs::temp_directory_path() / ("dmvv_cache_" + std::to_string(getpid())), "a file where the folder should be");
  const DiskCache blocked(folder.cache());
  blocked.keep("key", "value");
  CHECK_FALSE(blocked.find("key"));
  fs::remove(folder.path);
  const DiskCache cache(folder.cache());
  cache.keep("key", "value");
  fs::remove_all(folder.path);
  CHECK_FALSE(cache.find("key"));
  cache.keep("key", "value");
  CHECK(cache.find("key") == "value");
}

TEST_CASE("the oldest entries go first when there is too much") {
  const Folder folder;
  {
    const DiskCache cache(folder.cache(), 4000);
    for (const char* key : {"a", "b", "c"}) {
      cache.keep(key, std::string(1500, 'x'));
      for (const fs::path& file : files_in(folder.cache())) {  // each a day older than what comes after it
        fs::last_write_time(file, fs::last_write_time(file) - std::chrono::hours(24));
      }
    }
    CHECK(cache.find("a"));  // used: now the youngest
  }
  const DiskCache cache(folder.cache(), 4000);
  CHECK(cache.find("a"));
  CHECK_FALSE(cache.find("b"));
  CHECK(cache.find("c"));
}

TEST_CASE("many at once: each finds a whole value or none") {
  const Folder folder;
  const DiskCache cache(folder.cache());
  const std::string values[] = {std::string(100000, 'p'), std::string(70000, 'q')};
  bool torn = false;
  {
    std::jthread writer([&] {
      for (int i = 0; i < 200; ++i) DiskCache(folder.cache()).keep("key", values[i % 2]);
    });
    std::jthread remover([&] {
      std::error_code ignored;  // the writer may put a file into a folder that is being removed
      for (int i = 0; i < 50; ++i) fs::remove_all(folder.path, ignored);
    });
    for (int i = 0; i < 200; ++i) {
      const auto found = cache.find("key");
      torn |= found && *found != values[0] && *found != values[1];
    }
  }
  CHECK_FALSE(torn);
}

TEST_CASE("the compiler's view: words, and nothing without a cache") {
  const Folder folder;
  const auto view = code_cache(std::make_shared<const DiskCache>(folder.cache()));
  const std::vector<std::uint32_t> words{0x07230203, 42};
  view.keep("shader", words);
  CHECK(view.find("shader") == words);
  DiskCache(folder.cache()).keep("shader", "abc");
  CHECK_FALSE(view.find("shader"));
  CHECK_FALSE(code_cache(nullptr).find);
}

TEST_CASE("the user's folder follows the XDG Base Directory Specification") {
  const auto value = [](const char* name) {
    const char* const text = std::getenv(name);
    return text ? std::optional<std::string>(text) : std::nullopt;
  };
  const auto xdg = value("XDG_CACHE_HOME"), home = value("HOME");
  setenv("HOME", "/home/me", 1);
  setenv("XDG_CACHE_HOME", "/var/tmp/c", 1);
  CHECK(DiskCache::user_folder() == "/var/tmp/c/dmvv");
  setenv("XDG_CACHE_HOME", "relative", 1);  // to be ignored
  CHECK(DiskCache::user_folder() == "/home/me/.cache/dmvv");
  unsetenv("XDG_CACHE_HOME");
  CHECK(DiskCache::user_folder() == "/home/me/.cache/dmvv");
  unsetenv("HOME");
  CHECK(DiskCache::user_folder().empty());
  if (xdg) setenv("XDG_CACHE_HOME", xdg->c_str(), 1);
  if (home) setenv("HOME", home->c_str(), 1);
}
