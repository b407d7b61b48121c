// Reads every fixture of this folder and compares what is reported with what the fixture says.
//
// A fixture is a scene X.voml, named after the code it shows. Its comments say the rest:
//   <!-- expect            the messages in order, each `file:line:col: severity[code]: message`, or `note: ...` below
//   it
//   <!-- file NAME         a text file the scene may open
//   <!-- options           words: strict, everything, root=NAME
// Binary files (below) and scenes too odd or too large for an editor are made here.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "base/limits.h"
#include "compiler/snippet/snippet.h"
#include "tests/support/scene_text.h"
#include "tests/unit/voml/test_files.h"
#include "voml/format.h"
#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

namespace fs = std::filesystem;
const fs::path folder = fs::path(DMVV_SOURCE_DIR) / "tests/diagnostics";

struct Fixture {
  std::string name;  ///< of the scene file
  std::map<std::string, std::string> files;
  ReadOptions options;
  bool strict = false;
  std::string expected;
};

std::map<std::string, std::string> binary_files() {
  return {
      {"plane.lxn", tests::lxn()},
      {"magic.lxn", tests::lxn_with(0, 0x20504d42)},  // "BMP "
      {"short.lxn", tests::lxn().substr(0, 100)},
      {"plane_2d.lxn", tests::lxn_with(8, 2)},
      {"two_channels.lxn", tests::lxn_with(12, 2)},
      {"no_size.lxn", tests::lxn_with(20, 0)},
      {"too_long.lxn", tests::lxn_with(16, 3)},
      {"overflow.lxn", tests::lxn_with(16, std::numeric_limits<std::int32_t>::max())},
      {"reversed.lxn", tests::lxn_with(64, 1.5f)},
      {"nan.lxn", tests::lxn_with(128 + 4 * 5, std::numeric_limits<float>::quiet_NaN())},
      {"mode.lxn", tests::lxn_with(56, 7)},
      {"texture.png", tests::picture(2, 4)},
      {"square.png", tests::picture(4, 4)},
      {"cut.png", tests::picture(2, 4).substr(0, 40)},
      {"noise.png", "this is no picture"},
  };
}

/// The text of each comment that begins with `word`, without that word.
std::vector<std::string> comments(const std::string& text, const std::string& word) {
  std::vector<std::string> result;
  const std::string begin = "<!-- " + word;
  for (std::size_t i = text.find(begin); i != std::string::npos; i = text.find(begin, i + 1)) {
    const std::size_t from = i + begin.size();
    result.push_back(text.substr(from, text.find("-->", from) - from));
  }
  return result;
}

std::string trimmed_lines(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == std::string::npos) continue;
    result += line.substr(first, line.find_last_not_of(" \t\r") + 1 - first) + "\n";
  }
  return result;
}

Fixture load_fixture(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  Fixture fixture{path.filename().string(), binary_files(), {}, false, {}};
  fixture.files[fixture.name] = text;
  for (const std::string& file : comments(text, "file ")) {
    const std::size_t end = file.find('\n');
    fixture.files[file.substr(0, end)] = file.substr(end + 1);
  }
  for (const std::string& expected : comments(text, "expect")) fixture.expected += trimmed_lines(expected);
  for (const std::string& options : comments(text, "options")) {
    std::istringstream words(options);
    for (std::string word; words >> word;) {
      if (word == "strict") fixture.strict = true;
      if (word == "everything") fixture.options.load_everything = true;
      if (word.starts_with("root=")) fixture.options.root = word.substr(5);
    }
  }
  return fixture;
}

/// The rendered diagnostics without source lines, carets and the count.
std::string without_snippets(const std::string& rendered) {
  std::istringstream lines(rendered);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t bar = line.find(" | ");
    const bool snippet =
        bar != std::string::npos && line.substr(0, bar).find_first_not_of(" 0123456789") == std::string::npos;
    if (!snippet) result += line + "\n";
  }
  return result.substr(0, result.rfind('\n', result.size() - 2) + 1);
}

/// What reading says of a scene, without places: its content and the messages in any order.
std::string reading(const Fixture& fixture) {
  Diagnostics diagnostics(fixture.strict);
  const auto scene = read_scene(fixture.name, memory_files(fixture.files), fixture.options, diagnostics);
  std::multiset<std::string> messages;
  for (const Diagnostic& d : diagnostics.all()) messages.insert(d.message);
  std::string result = scene ? tests::to_text(*scene) : "no scene\n";
  for (const std::string& message : messages) result += message + '\n';
  return result;
}

struct Outcome {
  std::string messages;
  std::set<std::string> codes;
  bool scene = false;
  bool errors = false;
};

Outcome run(const Fixture& fixture) {
  Diagnostics diagnostics(fixture.strict);
  Outcome outcome;
  const auto scene = read_scene(fixture.name, memory_files(fixture.files), fixture.options, diagnostics);
  outcome.scene = scene.has_value();
  if (scene) {
    for (const Function& function : scene->functions) {
      outcome.scene &= compiler::snippet::compile_snippet(function, diagnostics).has_value();
    }
  }
  outcome.messages = without_snippets(diagnostics.render());
  outcome.errors = diagnostics.has_errors();
  for (const Diagnostic& d : diagnostics.all()) outcome.codes.insert(std::string(info(d.code).number));
  return outcome;
}

std::vector<Fixture> written_fixtures() {
  std::vector<Fixture> result;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".voml") result.push_back(load_fixture(entry.path()));
  }
  std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return result;
}

std::string repeated(std::string_view text, std::size_t count) {
  std::string result;
  result.reserve(text.size() * count);
  for (std::size_t i = 0; i < count; ++i) result += text;
  return result;
}

/// Scenes that cannot be written by hand; named like the others.
std::vector<Fixture> generated_fixtures() {
  const auto fixture = [](const std::string& name, std::string scene, const std::string& message) {
    Fixture result{name, binary_files(), {}, false, name + message + "\n"};
    result.files[name] = std::move(scene);
    return result;
  };
  std::vector<Fixture> result;
  result.push_back(fixture("E0003_zero_byte.voml", std::string("<MVV>\n<OBJECT\0/></MVV>", 22),
                           ":2:8: error[E0003]: there is a zero byte; this is no text file"));
  result.push_back(fixture("E0003_utf16.voml", std::string("\xff\xfe<\0M\0V\0\n\0V\0\x20\xdc>\0", 16),
                           ":2:2: error[E0003]: the bytes 20 dc mean nothing in UTF-16LE"));
  result.push_back(fixture("E0004_deep.voml", "<MVV>" + repeated("\n<a>", 4096) + repeated("</a>", 4096) + "</MVV>",
                           ":4097:2: error[E0004]: this element is nested 4097 deep, at most 4096 is allowed"));
  result.push_back(fixture("E0005_many.voml", "<MVV>\n" + repeated("<a/>", max_elements) + "</MVV>",
                           fmt::format(":2:{}: error[E0005]: the scene has more than 1048576 elements up to here",
                                       4 * (max_elements - 1) + 2)));
  std::string returns;
  for (int i = 0; i < 60; ++i) returns += fmt::format("if (p.x < {0}.5 * p.y) return {0}.0;\n", i);
  result.push_back(
      fixture("E0407_returns.voml",
              "<MVV><OBJECT name='A'><SDF name='S' function='true'><![CDATA[\n" + returns +
                  "return p.z;]]></SDF><REGION name='R' type='empty'/></OBJECT></MVV>",
              ":2:1: error[E0407]: conditions are nested 60 deep, early returns counted; drivers follow 48 "
              "with certainty: search by halves, or choose with ?: or min and max"));
  result.push_back(fixture("E0522_seeds.voml",
                           "<MVV><OBJECT name='A'><REGION name='R' type='empty'>\n"
                           "<EMBEDDED name='B' seedFile='many.txt'/></REGION></OBJECT>\n"
                           "<OBJECT name='B'><REGION name='R' type='empty'/></OBJECT></MVV>",
                           ""));
  result.back().options.root = "A";
  result.back().files["many.txt"] = repeated("0\n", max_seeds + 1);
  result.back().expected =
      "many.txt:16777217:1: error[E0522]: this is line 16777217 of numbers, at most 16777216 are allowed\n";
  return result;
}

std::vector<Fixture> all_fixtures() {
  std::vector<Fixture> result = written_fixtures();
  for (Fixture& fixture : generated_fixtures()) result.push_back(std::move(fixture));
  return result;
}

/// Codes of other stages, which a scene's text alone cannot show; their own unit tests cover them.
bool covered_elsewhere(std::string_view number) {
  return (number >= "W0402" && number <= "W0406") || number == "E0430" || number.starts_with("E03") ||
         number.starts_with("W03") || number.starts_with("E055") || number.starts_with("E056") ||
         number.starts_with("W055") || number.starts_with("W058") || number.starts_with("W06");
}

}  // namespace

TEST_CASE("every fixture reports what it says, and nothing else") {
  for (const Fixture& fixture : all_fixtures()) {
    CAPTURE(fixture.name);
    const Outcome outcome = run(fixture);
    CHECK(outcome.messages == fixture.expected);
    CHECK(outcome.scene == !outcome.errors);
    const std::string code = fixture.name.substr(0, fixture.name.find('_'));
    CHECK_MESSAGE(outcome.codes.contains(code), "a fixture shows the code it is named after");
  }
}

TEST_CASE("every code of the table has a fixture") {
  std::set<std::string> shown;
  for (const Fixture& fixture : written_fixtures()) shown.insert(fixture.name.substr(0, fixture.name.find('_')));
  for (const Fixture& fixture : generated_fixtures()) shown.insert(fixture.name.substr(0, fixture.name.find('_')));
  for (const CodeInfo& code : all_codes()) {
    if (covered_elsewhere(code.number)) continue;
    CHECK_MESSAGE(shown.contains(std::string(code.number)), code.number << " " << code.name << " has no fixture");
  }
}

TEST_CASE("a canonical layout changes nothing that reading sees, and what is refused is what is malformed") {
  const std::set<std::string> malformed{"E0002", "E0003", "E0004", "E0005", "E0010", "E0101"};
  std::size_t count = 0;
  for (Fixture& fixture : all_fixtures()) {
    CAPTURE(fixture.name);
    std::string& text = fixture.files[fixture.name];
    Diagnostics diagnostics;
    const auto formatted = format_document(diagnostics.add_source(fixture.name, text), diagnostics);
    CHECK(formatted.has_value() != malformed.contains(fixture.name.substr(0, 5)));
    if (!formatted) continue;
    if (fixture.name.starts_with("W0010")) continue;  // a layout is UTF-8, and says so
    ++count;
    const std::string before = reading(fixture);
    text = *formatted;
    CHECK(reading(fixture) == before);
    Diagnostics again;
    CHECK(format_document(again.add_source(fixture.name, text), again) == formatted);
  }
  CHECK(count > 40);
}
