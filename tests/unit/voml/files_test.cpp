#include "base/files.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>

using namespace dmvv;
namespace fs = std::filesystem;

namespace {

/// A folder of its own, removed at the end.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("dmvv_files_test_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
};

bool ends_with(const std::string& text, std::string_view end) { return text.ends_with(end); }

}  // namespace

TEST_CASE("bytes written to disk are read back, and nothing else is left in the folder") {
  const Folder folder;
  const std::string bytes("a\0b\r\n\xff", 6);
  REQUIRE(write_file(folder / "x", "before").has_value());
  REQUIRE(write_file(folder / "x", bytes).has_value());
  CHECK(disk_files()(folder / "x", 6).value() == bytes);
  CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 1);
}

TEST_CASE("reading says why it cannot") {
  const Folder folder;
  REQUIRE(write_file(folder / "x", "12345").has_value());
  const ReadFile read = disk_files();
  const auto missing = read(folder / "y", 100);
  REQUIRE_FALSE(missing.has_value());
  CHECK(missing.error().fault == Fault::input);
  CHECK(missing.error().message == "cannot read '" + (folder / "y") + "': no such file");
  CHECK(ends_with(read(folder.path.string(), 100).error().message, ": it is a directory"));
  CHECK(ends_with(read(folder / "x", 4).error().message, ": it has 5 bytes, at most 4 are allowed"));
  CHECK(ends_with(read("/dev/null", 4).error().message, ": not a regular file"));
}

TEST_CASE("writing says why it cannot, and leaves what was there") {
  const Folder folder;
  const auto no_folder = write_file(folder / "lost/x", "1");
  REQUIRE_FALSE(no_folder.has_value());
  CHECK(no_folder.error().fault == Fault::input);
  CHECK(ends_with(no_folder.error().message, "lost' does not exist"));
  const auto directory = write_file(folder.path.string(), "1");
  REQUIRE_FALSE(directory.has_value());
  CHECK(ends_with(directory.error().message, ": it is a directory"));
  CHECK(fs::is_empty(folder.path));
}

TEST_CASE("files in memory behave like files on disk") {
  const ReadFile read = memory_files({{"a/b.txt", "123"}, {"./c.txt", "4"}});
  CHECK(read("a/b.txt", 3).value() == "123");
  CHECK(read("a/../c.txt", 3).value() == "4");
  CHECK(read("d", 3).error().message == "cannot read 'd': no such file");
  CHECK(read("a", 3).error().message == "cannot read 'a': it is a directory");
  CHECK(read("a/b.txt", 2).error().message == "cannot read 'a/b.txt': it has 3 bytes, at most 2 are allowed");
}

TEST_CASE("a file that is missing: the one that may be meant is offered, on disk and in memory") {
  const Folder folder;
  fs::create_directories(folder.path / "Sub");
  for (const char* name : {"skin.lxn", "Sub/grid.lxn"}) REQUIRE(write_file(folder / name, "1").has_value());
  const std::string root = folder.path.string();
  const ReadFile sources[] = {disk_files(), memory_files({{root + "/skin.lxn", "1"}, {root + "/Sub/grid.lxn", "1"}})};
  for (const ReadFile& read : sources) {
    const auto message = [&](const std::string& name) {
      const std::string path = root + "/" + name, whole = read(path, 9).error().message;
      REQUIRE(whole.starts_with("cannot read '" + path + "': no such file"));
      return whole.substr(("cannot read '" + path + "': no such file").size());
    };
    const auto meant = [&](const std::string& name) { return "; did you mean '" + root + "/" + name + "'?"; };
    CHECK(message("Skin.LXN") == meant("skin.lxn"));
    CHECK(message("sub/GRID.lxn") == meant("Sub/grid.lxn"));
    CHECK(message("skn.lxn") == meant("skin.lxn"));
    CHECK(message("skin.png") == "");
    CHECK(message("bone.lxn") == "");
    const std::string cause = "; '/' separates folders, not '\\'";
    CHECK(message("Sub\\grid.lxn") == cause + meant("Sub/grid.lxn"));
    CHECK(message("sub\\grid.lxn") == cause + meant("Sub/grid.lxn"));
    CHECK(message("C:\\scenes\\skin.lxn") == cause + meant("skin.lxn"));
    CHECK(message("a\\b\\bone.lxn") == cause + ": write '" + root + "/a/b/bone.lxn'");
  }
}
