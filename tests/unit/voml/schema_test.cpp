// spec/voml.rng and the parser say the same: which elements and attributes there are, where, and which are needed.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "voml/attributes.h"
#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

namespace fs = std::filesystem;
const fs::path source_folder = DMVV_SOURCE_DIR;
const fs::path schema_file = source_folder / "spec/voml.rng";

/// What the schema is there to see in one document. The rest is about names, values in their ranges, GLSL, other files.
const std::set<std::string_view> structural{"E0002",  // not XML
                                            "E0101", "E0102", "E0105", "E0106",
                                            "E0108", "E0109", "E0111", "W0101",   // elements
                                            "W0102", "W0105",                     //
                                            "E0201", "E0202", "W0103", "W0106",   // attributes
                                            "E0203", "E0204", "E0208", "E0209"};  // form of values

/// Fixtures that the schema refuses all the same, or lets pass.
const std::map<std::string, std::string> exceptions{
    {"E0003_latin1.voml", "no XML reader takes bytes that the declared encoding does not have"},
    {"E0010_unknown.voml", "nor an encoding that it does not know"},
    {"E0104_without_consequences.voml", "of a name defined twice, what follows from it is not reported"},
    {"E0205_not_finite.voml", "'nan' and 'inf' have not the form of a number; 1e39, of the same code, has"},
    {"W0010_contradicted.voml", "a declaration that the bytes contradict is a warning only here"}};

std::vector<Tag> all_tags() {
  std::vector<Tag> tags;
  for (int i = 0; i < static_cast<int>(Tag::unknown); ++i) tags.push_back(static_cast<Tag>(i));
  return tags;
}

std::set<std::string> all_attributes() {
  std::set<std::string> names;
  for (const Tag tag : all_tags()) names.insert(attributes_of(tag).begin(), attributes_of(tag).end());
  return names;
}

/// Those of the files in `folder`, given by name, that xmllint finds valid. One process for all.
std::set<std::string> valid_files(const fs::path& folder, const std::vector<std::string>& names) {
  const fs::path report = fs::path(DMVV_BINARY_DIR) / "tests/schema_report.txt";
  std::string command =
      "cd '" + folder.string() + "' && '" DMVV_XMLLINT "' --noout --nonet --relaxng '" + schema_file.string() + "'";
  for (const std::string& name : names) command += " '" + name + "'";
  command += " >/dev/null 2>'" + report.string() + "'";
  [[maybe_unused]] const int status = std::system(command.c_str());  // not 0 where a file is invalid
  std::set<std::string> valid;
  std::size_t failed = 0;
  std::ifstream stream(report);
  const std::string_view good = " validates";
  for (std::string line; std::getline(stream, line);) {
    if (line.ends_with(good)) valid.insert(line.substr(0, line.size() - good.size()));
    if (line.ends_with(" fails to validate")) ++failed;
  }
  REQUIRE_MESSAGE(valid.size() + failed > 0, "xmllint gave no verdict; see " << report.string());
  return valid;
}

std::vector<std::string> scenes_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".voml") names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string text_of_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// ---- the parser against the schema, by documents that differ in one thing from a good one ----

/// Every element at every place it can stand in, with every attribute.
const char* const good_scene = R"(<MVV>
<IMPORT file="other.voml"/>
<FUNCTIONS>float g(vec3 p) { return p.x; }</FUNCTIONS>
<OBJECT name="A">
  <FUNCTIONS>float h(vec3 p) { return p.x; }</FUNCTIONS>
  <SDF name="S" file="x.lxn" function="false" type="seeding" seedFile="s.txt" rotateFile="s.txt" scaleFile="s.txt"
       translate="0 0 0" rotate="0 0 0" scale="1 1 1" index="2 2 2" offset="0"/>
  <SDF name="T" function="true">return p.x;</SDF>
  <REGION name="C" type="color" rgb="0 0 1" translate="0 0 0" rotate="0 0 0" scale="1 1 1" opacity="1">
    <INDEX size="2 2 2" translate="0 0 0" rotate="0 0 0" scale="1 1 1">
      <EMBEDDED name="B" type="seeding" translate="0 0 0" rotate="0 0 0" scale="1 1 1" seedFile="s.txt"
                rotateFile="s.txt" scaleFile="s.txt"/>
    </INDEX>
    <EMBEDDED name="B" type="tiling"/>
  </REGION>
  <REGION name="M" type="bitmap" file="x.png"/>
  <REGION name="E" type="empty"/>
  <MAPPINGS name="A">
    <SDF name="S">
      <POSITIVE region="C"/>
      <NEGATIVE>
        <SDF name="U" function="1">return p.y;
          <NEGATIVE><REGION name="V" type="empty"><EMBEDDED name="B"/></REGION></NEGATIVE>
          <POSITIVE>
            <SDF name="W" file="x.lxn"><POSITIVE><REGION name="M"/></POSITIVE><NEGATIVE region="E"/></SDF>
          </POSITIVE>
        </SDF>
      </NEGATIVE>
    </SDF>
  </MAPPINGS>
</OBJECT>
<OBJECT name="B"><SDF name="S" file="x.lxn"/><REGION name="R" type="empty"/></OBJECT>
<OBJECT name="D"><MAPPINGS><REGION name="R" type="empty"/></MAPPINGS></OBJECT>
</MVV>)";
/// The same with nothing that can be left out.
const char* const lean_scene = R"(<MVV>
<OBJECT name="A">
  <SDF name="S" type="seeding" seedFile="s.txt" file="x.lxn"/>
  <SDF name="T" function="1">return p.x;</SDF>
  <REGION name="C" type="color" rgb="0 0 1">
    <INDEX size="2 2 2"/>
    <EMBEDDED name="B" seedFile="s.txt"/>
    <EMBEDDED name="B" type="seeding" seedFile="s.txt"/>
    <EMBEDDED name="B"/>
  </REGION>
  <MAPPINGS>
    <SDF name="S">
      <POSITIVE region="C"/>
      <NEGATIVE>
        <SDF name="U" file="x.lxn" type="seeding" seedFile="s.txt"><POSITIVE region="C"/><NEGATIVE region="C"/></SDF>
      </NEGATIVE>
    </SDF>
  </MAPPINGS>
</OBJECT>
<OBJECT name="B"><REGION name="R" type="empty"/></OBJECT>
</MVV>)";
const char* const other_scene = R"(<MVV><OBJECT name="O"><REGION name="R" type="empty"/></OBJECT></MVV>)";

/// Each element of VOML as it may be added to another: those of two meanings in both forms.
const std::vector<std::string> additions{"<MVV/>",
                                         "<IMPORT file='other.voml'/>",
                                         "<OBJECT name='N'><REGION name='R' type='empty'/></OBJECT>",
                                         "<SDF name='N' file='x.lxn'/>",
                                         "<SDF name='S'><POSITIVE region='E'/><NEGATIVE region='E'/></SDF>",
                                         "<REGION name='E'/>",
                                         "<REGION name='N' type='empty'/>",
                                         "<INDEX size='1 1 1'/>",
                                         "<EMBEDDED name='B'/>",
                                         "<MAPPINGS><REGION name='E'/></MAPPINGS>",
                                         "<POSITIVE region='E'/>",
                                         "<NEGATIVE region='E'/>",
                                         "<FUNCTIONS/>",
                                         "<WHAT/>"};

std::string plain_value(const std::string& attribute, Tag tag) {
  if (attribute == "type") return tag == Tag::region ? "empty" : "default";
  if (attribute == "function") return "true";
  if (attribute == "offset" || attribute == "opacity") return "1";
  const std::set<std::string> vectors{"translate", "rotate", "scale", "rgb", "size", "index"};
  return vectors.contains(attribute) ? "1 1 1" : "E";
}

std::vector<pugi::xml_node> elements_of(pugi::xml_document& document) {
  std::vector<pugi::xml_node> result;
  for (const auto& found : document.select_nodes("//*")) result.push_back(found.node());
  return result;
}

struct Variant {
  std::string what;
  std::string text;
};

std::vector<Variant> variants(const char* scene) {
  std::vector<Variant> result;
  pugi::xml_document original;
  REQUIRE(original.load_string(scene));
  const std::size_t count = elements_of(original).size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto vary = [&](const std::string& what, const std::function<void(pugi::xml_node)>& change) {
      pugi::xml_document copy;
      copy.reset(original);
      const pugi::xml_node element = elements_of(copy)[i];
      const std::string place = element.path() + " " + element.attribute("name").value();
      change(element);
      std::ostringstream text;
      copy.save(text);
      result.push_back({place + ": " + what, text.str()});
    };
    const pugi::xml_node element = elements_of(original)[i];
    vary("text added", [](pugi::xml_node e) { e.append_child(pugi::node_pcdata).set_value("words"); });
    for (const pugi::xml_attribute attribute : element.attributes()) {
      const std::string name = attribute.name();
      vary("without " + name, [&](pugi::xml_node e) { e.remove_attribute(name.c_str()); });
      vary("blank " + name, [&](pugi::xml_node e) { e.attribute(name.c_str()).set_value(" "); });
    }
    std::set<std::string> names = all_attributes();
    names.insert("what");
    for (const std::string& name : names) {
      if (element.attribute(name.c_str())) continue;
      const std::string value = plain_value(name, tag_of(element.name()));
      vary("with " + name, [&](pugi::xml_node e) { e.append_attribute(name.c_str()).set_value(value.c_str()); });
    }
    for (const std::string& addition : additions) {
      vary("with " + addition, [&](pugi::xml_node e) { e.append_buffer(addition.data(), addition.size()); });
    }
    if (i == 0) continue;  // a document has one outermost element
    vary("left out", [](pugi::xml_node e) { e.parent().remove_child(e); });
    vary("twice", [](pugi::xml_node e) { e.parent().insert_copy_after(e, e); });
  }
  return result;
}

const std::string name_defined_twice = "E0104 ";

/// The structural codes that the parser reports, and that of a name defined twice.
std::string structural_codes(const std::string& scene) {
  Diagnostics diagnostics;
  read_scene("scene.voml", memory_files({{"scene.voml", scene}, {"other.voml", other_scene}}), {}, diagnostics);
  std::string codes;
  for (const Diagnostic& d : diagnostics.all()) {
    const std::string number(info(d.code).number);
    if (structural.contains(number) || number + ' ' == name_defined_twice) codes += number + ' ';
  }
  return codes;
}

// ---- the schema as text ----

constexpr const char* documentation = "a:documentation";

/// The attributes in a pattern, through references, but not those of elements in it.
void collect_attributes(pugi::xml_node pattern, const pugi::xml_node& grammar, std::set<std::string>& names) {
  for (const pugi::xml_node child : pattern.children()) {
    const std::string kind = child.name();
    if (kind == "attribute") names.insert(child.attribute("name").value());
    if (kind == "ref") {
      const auto define = grammar.find_child_by_attribute("define", "name", child.attribute("name").value());
      REQUIRE(define);
      collect_attributes(define, grammar, names);
    }
    if (kind != "attribute" && kind != "element") collect_attributes(child, grammar, names);
  }
}

}  // namespace

TEST_CASE("the schema has the elements and attributes of the parser, and explains each") {
  pugi::xml_document schema;
  REQUIRE(schema.load_file(schema_file.c_str()));
  const pugi::xml_node grammar = schema.child("grammar");
  std::map<std::string, std::set<std::string>> found;
  for (const auto& match : grammar.select_nodes("//element")) {
    const pugi::xml_node element = match.node();
    collect_attributes(element, grammar, found[element.attribute("name").value()]);
  }
  std::map<std::string, std::set<std::string>> expected;
  for (const Tag tag : all_tags()) {
    expected[std::string(name_of(tag))] = {attributes_of(tag).begin(), attributes_of(tag).end()};
  }
  for (const auto& entry : expected) {  // clang 14 captures no structured binding
    const std::string& element = entry.first;
    CAPTURE(element);
    CHECK(found.contains(element));
    for (const std::string& name : entry.second) CHECK_MESSAGE(found[element].contains(name), name << " is missing");
    for (const std::string& name : found[element]) CHECK_MESSAGE(entry.second.contains(name), name << " is unknown");
  }
  CHECK(found.size() == expected.size());
  for (const auto& match : grammar.select_nodes("//element | //attribute")) {
    const pugi::xml_node node = match.node();
    CHECK_MESSAGE(!node.child(documentation).text().empty(), node.attribute("name").value() << " is not explained");
  }
}

TEST_CASE("the parser and the schema judge alike: places, needed attributes, what excludes what") {
  const fs::path folder = fs::path(DMVV_BINARY_DIR) / "tests/schema_scenes";
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::vector<Variant> all = variants(good_scene);
  std::ranges::move(variants(lean_scene), std::back_inserter(all));
  all.push_back({"the lean scene", lean_scene});
  all.push_back({"the good scene", good_scene});
  std::vector<std::string> names;
  for (std::size_t i = 0; i < all.size(); ++i) {
    names.push_back(std::to_string(i) + ".voml");
    std::ofstream(folder / names.back(), std::ios::binary) << all[i].text;
  }
  const std::set<std::string> valid = valid_files(folder, names);
  CHECK(valid.contains(names.back()));
  CHECK(valid.contains(names[names.size() - 2]));
  std::size_t refused = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string codes = structural_codes(all[i].text);
    refused += codes.empty() ? 0 : 1;
    if (codes == name_defined_twice)
      continue;  // what may be wrong with the structure as well is not reported beside it
    CHECK_MESSAGE(valid.contains(names[i]) == codes.empty(),
                  all[i].what << " (" << names[i] << "): the parser says '" << codes << "'");
  }
  CHECK(refused > all.size() / 2);  // most changes harm, and some do not
  CHECK(refused < all.size());
  fs::remove_all(folder);
}

TEST_CASE("all examples are valid") {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(source_folder / "examples")) {
    if (!entry.is_directory()) continue;
    const std::vector<std::string> names = scenes_in(entry.path());
    if (names.empty()) continue;
    const std::set<std::string> valid = valid_files(entry.path(), names);
    for (const std::string& name : names) CHECK_MESSAGE(valid.contains(name), name);
    count += names.size();
  }
  CHECK(count >= 7);
}

TEST_CASE("of the fixtures of diagnostics, those with structural mistakes are invalid, the others valid") {
  const fs::path folder = source_folder / "tests/diagnostics";
  const std::vector<std::string> names = scenes_in(folder);
  const std::set<std::string> valid = valid_files(folder, names);
  std::set<std::string> unused;
  for (const auto& [name, reason] : exceptions) unused.insert(name);
  for (const std::string& name : names) {
    bool fine = true;
    std::istringstream lines(text_of_file(folder / name));
    for (std::string line; std::getline(lines, line);) {  // "NAME:2:4: error[E0102]: ..."
      const std::size_t code = line.find('[');
      const bool expected = line.find(name + ":") != std::string::npos && code != std::string::npos;
      if (expected && structural.contains(std::string_view(line).substr(code + 1, 5))) fine = false;
    }
    if (exceptions.contains(name)) {
      unused.erase(name);
      CHECK_MESSAGE(valid.contains(name) != fine, name << " is no exception any more");
    } else {
      CHECK_MESSAGE(valid.contains(name) == fine, name << (fine ? " should be valid" : " should be invalid"));
    }
  }
  CHECK_MESSAGE(unused.empty(), "an exception that is no fixture");
}
