// Tables of spec/ and of the program say the same: codes, elements, attributes, places.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "base/diagnostics.h"
#include "voml/attributes.h"
#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

/// A row of the table of elements in spec/voml.md.
struct ElementRow {
  std::vector<std::string> elements;
  std::vector<std::string> parents;
  std::vector<std::string> attributes;
  std::set<std::string> needed;
};

/// "`A`, **b**, c" -> A, b, c
std::vector<std::string> words_of(const std::string& cell, std::set<std::string>* bold = nullptr) {
  std::vector<std::string> words;
  std::istringstream stream(cell);
  for (std::string word; std::getline(stream, word, ',');) {
    const bool is_bold = word.find("**") != std::string::npos;
    std::erase_if(word, [](char c) { return c == '`' || c == '*'; });
    word = trim(word);
    if (word.empty()) continue;
    words.push_back(word);
    if (bold && is_bold) bold->insert(word);
  }
  return words;
}

std::vector<ElementRow> element_table() {
  std::ifstream stream(DMVV_SOURCE_DIR "/spec/voml.md");
  std::vector<ElementRow> rows;
  std::string line;
  while (std::getline(stream, line) && !line.starts_with("| element |")) {
  }
  std::getline(stream, line);
  while (std::getline(stream, line) && line.starts_with("|")) {
    std::vector<std::string> cells;
    std::istringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(cell);
    REQUIRE(cells.size() == 3);
    ElementRow& entry = rows.emplace_back();
    entry.elements = words_of(cells[0]);
    entry.parents = words_of(cells[1]);
    entry.attributes = words_of(cells[2], &entry.needed);
  }
  return rows;
}

/// The codes of mistakes in a document of these parts.
std::set<std::string> codes_in(const std::string& scene) {
  Diagnostics diagnostics;
  read_scene("scene.voml",
             memory_files({{"scene.voml", scene},
                           {"o.voml", "<MVV><OBJECT name='O'><REGION name='R' type='empty'/></OBJECT></MVV>"}}),
             {}, diagnostics);
  std::set<std::string> codes;
  for (const Diagnostic& d : diagnostics.all()) codes.insert(std::string(info(d.code).number));
  return codes;
}

/// An element with what it needs, and a scene in which it stands where it may, as "...%...".
const std::map<std::string, std::string> samples{
    {"MVV", "<MVV/>"},
    {"IMPORT", "<IMPORT file='o.voml'/>"},
    {"FUNCTIONS", "<FUNCTIONS/>"},
    {"OBJECT", "<OBJECT name='B'><REGION name='R' type='empty'/></OBJECT>"},
    {"SDF", "<SDF name='T' file='x.lxn'/>"},
    {"REGION", "<REGION name='E' type='empty'/>"},
    {"INDEX", "<INDEX size='1 1 1'/>"},
    {"EMBEDDED", "<EMBEDDED name='B'/>"},
    {"MAPPINGS", "<MAPPINGS><REGION name='R'/></MAPPINGS>"},
    {"POSITIVE", "<POSITIVE region='R'/>"},
    {"NEGATIVE", "<NEGATIVE region='R'/>"}};
const std::map<std::string, std::string> places{
    {"MVV", "<MVV>%</MVV>"},
    {"IMPORT", "<MVV><IMPORT file='o.voml'>%</IMPORT></MVV>"},
    {"FUNCTIONS", "<MVV><FUNCTIONS>%</FUNCTIONS></MVV>"},
    {"OBJECT", "<MVV><OBJECT name='A'>%</OBJECT></MVV>"},
    {"SDF", "<MVV><OBJECT name='A'><SDF name='S' file='x.lxn'>%</SDF></OBJECT></MVV>"},
    {"SDF within MAPPINGS", "<MVV><OBJECT name='A'><MAPPINGS><SDF name='S'>%</SDF></MAPPINGS></OBJECT></MVV>"},
    {"REGION", "<MVV><OBJECT name='A'><REGION name='R' type='empty'>%</REGION></OBJECT></MVV>"},
    {"INDEX",
     "<MVV><OBJECT name='A'><REGION name='R' type='empty'><INDEX size='1 1 1'>%</INDEX></REGION></OBJECT></MVV>"},
    {"EMBEDDED",
     "<MVV><OBJECT name='A'><REGION name='R' type='empty'><EMBEDDED name='B'>%</EMBEDDED></REGION></OBJECT></MVV>"},
    {"MAPPINGS", "<MVV><OBJECT name='A'><MAPPINGS>%</MAPPINGS></OBJECT></MVV>"},
    {"POSITIVE",
     "<MVV><OBJECT name='A'><MAPPINGS><SDF name='S'><POSITIVE>%</POSITIVE></SDF></MAPPINGS></OBJECT></MVV>"},
    {"NEGATIVE",
     "<MVV><OBJECT name='A'><MAPPINGS><SDF name='S'><NEGATIVE>%</NEGATIVE></SDF></MAPPINGS></OBJECT></MVV>"}};

std::string put_into(const std::string& place, const std::string& element) {
  std::string scene = places.at(place);
  return scene.replace(scene.find('%'), 1, element);
}

}  // namespace

TEST_CASE("spec/voml.md: the table of elements has the parser's elements and attributes, in their canonical order") {
  std::set<std::string> found;
  for (const ElementRow& row : element_table()) {
    for (const std::string& element : row.elements) {
      CAPTURE(element);
      const Tag tag = tag_of(element);
      REQUIRE(tag != Tag::unknown);
      CHECK(element == name_of(tag));
      CHECK(found.insert(element).second);
      const auto own = attributes_of(tag);
      CHECK(row.attributes == std::vector<std::string>(own.begin(), own.end()));
    }
  }
  CHECK(found.size() == static_cast<std::size_t>(Tag::unknown));
}

TEST_CASE("spec/voml.md: each element stands where the table says, and nowhere else") {
  for (const ElementRow& row : element_table()) {
    for (const std::string& element : row.elements) {
      for (const auto& entry : places) {
        const bool may = std::ranges::find(row.parents, entry.first) != row.parents.end();
        const std::set<std::string> codes = codes_in(put_into(entry.first, samples.at(element)));
        CHECK_MESSAGE(codes.contains("E0102") != may, element << " in " << entry.first);
      }
    }
  }
}

TEST_CASE("spec/voml.md: the attributes in bold are needed, the others are not") {
  for (const ElementRow& row : element_table()) {
    for (const std::string& element : row.elements) {
      const std::string& whole = samples.at(element);
      const std::string& place = row.parents.empty() ? "" : row.parents.front();
      if (place.empty()) continue;
      CHECK_MESSAGE(!codes_in(put_into(place, whole)).contains("E0201"), element);
      std::set<std::string> needed;
      for (const std::string& attribute : row.attributes) {
        const std::size_t at = whole.find(' ' + attribute + "='");
        if (at == std::string::npos || at > whole.find('>')) continue;  // not given, not needed
        std::string without = whole;
        without.erase(at, whole.find('\'', whole.find('\'', at) + 1) + 1 - at);
        if (codes_in(put_into(place, without)).contains("E0201")) needed.insert(attribute);
      }
      if (element == "SDF") CHECK(needed.erase("file") == 1);  // or function="true"
      CHECK_MESSAGE(needed == row.needed, element);
    }
  }
}

TEST_CASE("spec/diagnostics.md lists every code with its explanation, in order") {
  std::ifstream stream(DMVV_SOURCE_DIR "/spec/diagnostics.md");
  const std::string spec{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t table = spec.find("| code | name | what it says |\n|---|---|---|\n");
  REQUIRE(table != std::string::npos);
  std::string expected = "| code | name | what it says |\n|---|---|---|\n";
  for (const CodeInfo& code : all_codes())
    expected += fmt::format("| {} | `{}` | {} |\n", code.number, code.name, code.explanation);
  const std::string found = spec.substr(table, expected.size());
  CHECK_MESSAGE(found == expected, "the table should read:\n" << expected);
}
