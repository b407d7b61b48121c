// Holds the code to the structure that rooms.txt names: includes point one way, libraries stay in their rooms.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path source_folder = DMVV_SOURCE_DIR;

struct Rooms {
  std::vector<std::string> names;  ///< in the order of the table
  std::map<std::string, std::vector<std::string>> may_include;
  std::map<std::string, std::vector<std::string>> users;  ///< of the headers that begin like this: "<vulkan/"
};

Rooms read_rooms(std::istream& table) {
  Rooms rooms;
  for (std::string line; std::getline(table, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t colon = line.find(':');
    const std::string name = line.substr(0, colon);
    std::istringstream rest(line.substr(colon + 1));
    std::vector<std::string> words{std::istream_iterator<std::string>(rest), {}};
    if (name[0] == '<') {
      rooms.users[name] = std::move(words);
    } else {
      rooms.names.push_back(name);
      rooms.may_include[name] = std::move(words);
    }
  }
  return rooms;
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The room with the longest name that the file's begins with; empty if there is none.
std::string room_of(const Rooms& rooms, const std::string& file) {
  std::string longest;
  for (const std::string& name : rooms.names) {
    const bool holds = file == name || file.rfind(name + "/", 0) == 0;
    if (holds && name.size() > longest.size()) longest = name;
  }
  return longest;
}

struct Include {
  int line;
  std::string header;  ///< with its quotes or brackets
};

std::vector<Include> includes_of(std::istream& text) {
  std::vector<Include> includes;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    if (line.rfind("#include ", 0) == 0) includes.push_back({number, line.substr(9)});
  }
  return includes;
}

/// Why a file of `room` may not include this; empty if it may.
std::string fault_of(const Rooms& rooms, const std::string& room, const std::string& header) {
  if (header[0] == '<') {
    for (const auto& [begin, users] : rooms.users) {
      if (header.rfind(begin, 0) == 0 && !contains(users, room)) return "is for other rooms only";
    }
    return {};
  }
  const std::string path = header.substr(1, header.find('"', 1) - 1);
  if (path.find('/') == std::string::npos || path.rfind("spirv/", 0) == 0) return {};  // generated beside the sources
  const std::string target = room_of(rooms, path);
  if (target.empty()) return "is in no room";
  const bool may = target == room || contains(rooms.may_include.at(room), target);
  return may ? std::string() : "is in the room " + target + ", which " + room + " may not include";
}

/// All sources in the folders of rooms, sorted.
std::vector<std::string> sources(const Rooms& rooms) {
  std::vector<std::string> files;
  for (const std::string& room : rooms.names) {
    if (room.find('/') != std::string::npos) continue;  // within another one
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source_folder / room)) {
      const std::string ending = entry.path().extension().string();
      if (ending == ".h" || ending == ".cpp")
        files.push_back(fs::relative(entry.path(), source_folder).generic_string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

Rooms rooms_of_the_project() {
  std::ifstream table(source_folder / "tests/structure/rooms.txt");
  return read_rooms(table);
}

}  // namespace

TEST_CASE("the table of rooms has no circle: each includes earlier ones only") {
  const Rooms rooms = rooms_of_the_project();
  REQUIRE(rooms.names.size() > 20);
  for (const std::string& room : rooms.names) {
    const auto own = std::find(rooms.names.begin(), rooms.names.end(), room);
    for (const std::string& other : rooms.may_include.at(room)) {
      INFO(room, " -> ", other);
      CHECK(std::find(rooms.names.begin(), own, other) != own);
    }
  }
}

TEST_CASE("includes follow the table") {
  const Rooms rooms = rooms_of_the_project();
  const std::vector<std::string> files = sources(rooms);
  REQUIRE(files.size() > 300);
  for (const std::string& file : files) {
    const std::string room = room_of(rooms, file);
    std::ifstream text(source_folder / file);
    for (const Include& include : includes_of(text)) {
      const std::string fault = fault_of(rooms, room, include.header);
      CHECK_MESSAGE(fault.empty(), file, ":", include.line, ": ", include.header, " ", fault);
    }
  }
}

TEST_CASE("a source includes its own header first, so that every header stands alone") {
  for (const std::string& file : sources(rooms_of_the_project())) {
    fs::path header = fs::path(file).replace_extension(".h");
    if (!file.ends_with(".cpp") || !fs::exists(source_folder / header)) continue;
    std::ifstream text(source_folder / file);
    const std::vector<Include> includes = includes_of(text);
    REQUIRE_MESSAGE(!includes.empty(), file);
    CHECK_MESSAGE(includes.front().header == '"' + header.generic_string() + '"', file);
  }
}

TEST_CASE("the check itself finds what is wrong") {
  std::istringstream table("low:\nhigh: low\n<library/: low\n");
  const Rooms rooms = read_rooms(table);
  CHECK(fault_of(rooms, "high", "\"low/a.h\"").empty());
  CHECK(fault_of(rooms, "low", "\"low/b.h\"").empty());
  CHECK_FALSE(fault_of(rooms, "low", "\"high/a.h\"").empty());
  CHECK_FALSE(fault_of(rooms, "low", "\"nowhere/a.h\"").empty());
  CHECK(fault_of(rooms, "low", "<library/a.h>").empty());
  CHECK_FALSE(fault_of(rooms, "high", "<library/a.h>").empty());
  CHECK(fault_of(rooms, "high", "<vector>").empty());
}
