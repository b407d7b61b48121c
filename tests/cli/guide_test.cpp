// spec/guide.md, followed to the letter in a new folder: files written, changes made, commands run, their output
// compared, pictures too. And the commands of README.md.
//
// DMVV_GUIDE_FILES=spec/guide build/tests/guide_test writes the pictures and files that the guide shows anew.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <span>
#include <sstream>

#include "tests/cli/program.h"
#include "voml/assets/image_file.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

namespace fs = std::filesystem;
const fs::path spec = fs::path(DMVV_SOURCE_DIR) / "spec";

/// A fenced block: ```LANGUAGE ARGUMENT
struct Block {
  std::string language;  ///< xml: a file, diff: a change of one, console: commands and what they print
  std::string argument;  ///< the file's name
  std::vector<std::string> lines;
  std::size_t line = 0;  ///< in the guide
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<Block> blocks_of(const std::string& guide) {
  std::vector<Block> blocks;
  bool inside = false;
  const std::vector<std::string> lines = lines_of(guide);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].starts_with("```")) {
      inside = !inside;
      if (!inside) continue;
      Block& block = blocks.emplace_back();
      std::istringstream words(lines[i].substr(3));
      words >> block.language >> block.argument;
      block.line = i + 1;
    } else if (inside) {
      blocks.back().lines.push_back(lines[i]);
    }
  }
  REQUIRE(!inside);
  return blocks;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

/// A change: lines with '-' and ' ' must stand in the file, once and together; those with '+' and ' ' take their place.
void apply(const Block& block, const Folder& folder) {
  std::vector<std::string> before, after;
  for (const std::string& line : block.lines) {
    const char mark = line.empty() ? ' ' : line[0];
    const std::string rest = line.empty() ? "" : line.substr(1);
    REQUIRE_MESSAGE((mark == ' ' || mark == '+' || mark == '-'), line);
    if (mark != '+') before.push_back(rest);
    if (mark != '-') after.push_back(rest);
  }
  std::string text = '\n' + folder.read(block.argument);
  const std::string old = '\n' + joined(before);
  const std::size_t at = text.find(old);
  REQUIRE_MESSAGE(at != std::string::npos, "the lines to change are not in " << block.argument);
  REQUIRE_MESSAGE(text.find(old, at + 1) == std::string::npos, "the lines to change stand there twice");
  text.replace(at, old.size(), '\n' + joined(after));
  folder.write(block.argument, text.substr(1));
}

/// "..." stands for anything in a line.
bool matches_line(std::string_view expected, std::string_view actual) {
  const std::size_t gap = expected.find("...");
  if (gap == std::string_view::npos) return expected == actual;
  if (!actual.starts_with(expected.substr(0, gap))) return false;
  for (std::size_t i = gap; i <= actual.size(); ++i) {
    if (matches_line(expected.substr(gap + 3), actual.substr(i))) return true;
  }
  return false;
}

/// A line of "..." alone stands for any number of lines.
bool matches(std::span<const std::string> expected, std::span<const std::string> actual) {
  if (expected.empty()) return actual.empty();
  if (expected[0] != "...") {
    return !actual.empty() && matches_line(expected[0], actual[0]) && matches(expected.subspan(1), actual.subspan(1));
  }
  for (std::size_t i = 0; i <= actual.size(); ++i) {
    if (matches(expected.subspan(1), actual.subspan(i))) return true;
  }
  return false;
}

Run run_in_shell(const std::string& command, const Folder& folder) {
  const Folder outside;
  const std::string script = outside.write("script", command + '\n');
  const std::string whole = "cd '" + folder.file("") + "' && PATH='" + fs::path(DMVV_PROGRAM).parent_path().string() +
                            "':\"$PATH\" sh '" + script + "' >'" + outside.file("out") + "' 2>&1 </dev/null";
  const int status = std::system(whole.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, outside.read("out"), ""};
}

void run(const Block& block, const Folder& folder) {
  for (std::size_t i = 0; i < block.lines.size();) {
    REQUIRE(block.lines[i].starts_with("$ "));
    const std::string command = block.lines[i].substr(2);
    std::size_t end = i + 1;
    while (end < block.lines.size() && !block.lines[end].starts_with("$ ")) ++end;
    const std::vector<std::string> expected(block.lines.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                            block.lines.begin() + static_cast<std::ptrdiff_t>(end));
    const Run run = run_in_shell(command, folder);
    CAPTURE(command);
    CHECK_MESSAGE(matches(expected, lines_of(run.out)), "it should print\n"
                                                            << joined(expected) << "but prints\n"
                                                            << run.out);
    const bool counts_errors =
        !expected.empty() && (expected.back().ends_with(" error") || expected.back().ends_with(" errors"));
    CHECK(run.exit_code == (counts_errors ? 1 : 0));
    i = end;
  }
}

/// Two pictures of the same, as far as drivers agree.
void check_alike(const std::string& made, const std::string& shown) {
  const auto a = decode_image(made, "made.png", 1u << 24), b = decode_image(shown, "shown.png", 1u << 24);
  REQUIRE((a && b));
  REQUIRE(a->samples.size() == b->samples.size());
  CHECK(a->width == b->width);
  std::size_t different = 0;
  for (std::size_t i = 0; i < a->samples.size(); ++i) {
    different += std::abs(int{a->samples[i]} - int{b->samples[i]}) > 16 ? 1 : 0;
  }
  CHECK_MESSAGE(different <= a->samples.size() / 200, different << " of " << a->samples.size() << " samples differ");
}

/// The files of the folder guide/ that the guide links.
std::set<std::string> shown_files(const std::string& guide) {
  std::set<std::string> names;
  const std::string link = "](guide/";
  for (std::size_t at = guide.find(link); at != std::string::npos; at = guide.find(link, at + 1)) {
    names.insert(guide.substr(at + link.size(), guide.find(')', at + 2) - at - link.size()));
  }
  return names;
}

}  // namespace

TEST_CASE("the guide works as it is written, and shows what comes of it") {
  const std::string guide = read_file((spec / "guide.md").string());
  const Folder folder;
  std::size_t commands = 0;
  for (const Block& block : blocks_of(guide)) {
    INFO("spec/guide.md, line " << block.line);
    if (block.language == "xml") {
      folder.write(block.argument, joined(block.lines));
    } else if (block.language == "diff") {
      apply(block, folder);
    } else {
      REQUIRE(block.language == "console");
      run(block, folder);
      ++commands;
    }
  }
  CHECK(commands >= 10);
  const std::set<std::string> shown = shown_files(guide);
  CHECK(shown.size() >= 5);
  for (const std::string& name : shown) {
    CAPTURE(name);
    if (const char* const target = std::getenv("DMVV_GUIDE_FILES")) {
      fs::copy_file(folder.file(name), fs::path(target) / name, fs::copy_options::overwrite_existing);
    }
    const std::string file = (spec / "guide" / name).string();
    CHECK(fs::file_size(file) <= 200'000);
    if (name.ends_with(".png")) {
      check_alike(folder.read(name), read_file(file));
    } else {
      CHECK(folder.read(name) == read_file(file));
    }
  }
  for (const auto& entry : fs::directory_iterator(spec / "guide")) {
    CHECK_MESSAGE(shown.contains(entry.path().filename().string()), entry.path().string() << " is not shown");
  }
}

TEST_CASE("every link of the guide leads to a file") {
  const std::string guide = read_file((spec / "guide.md").string());
  std::size_t count = 0;
  for (std::size_t at = guide.find("]("); at != std::string::npos; at = guide.find("](", at + 1), ++count) {
    const std::string target = guide.substr(at + 2, guide.find(')', at) - at - 2);
    CHECK_MESSAGE(fs::exists(spec / target.substr(0, target.find('#'))), target);
  }
  CHECK(count > 5);
}

TEST_CASE("the commands of README.md print what it says") {
  const Folder folder;
  for (const char* const part : {"orange.voml", "orange.ply", "bmp", "sdf", "seeds"}) {
    fs::copy(fs::path(DMVV_BINARY_DIR) / "examples/orange" / part, folder.file(part), fs::copy_options::recursive);
  }
  std::size_t count = 0;
  for (const Block& block : blocks_of(read_file(DMVV_SOURCE_DIR "/README.md"))) {
    if (block.language != "console") continue;
    INFO("README.md, line " << block.line);
    run(block, folder);
    ++count;
  }
  CHECK(count == 1);
}
