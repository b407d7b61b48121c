// The canonical layout: what it looks like, that it stays as it is, and that it changes nothing but the layout.
#include "voml/format.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <pugixml.hpp>
#include <random>
#include <sstream>

#include "base/text.h"
#include "tests/support/scene_text.h"
#include "voml/attributes.h"
#include "voml/scene.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

namespace fs = std::filesystem;

std::string formatted(const std::string& text) {
  Diagnostics diagnostics;
  const auto result = format_document(diagnostics.add_source("scene.voml", text), diagnostics);
  INFO(diagnostics.render());
  REQUIRE(result.has_value());
  return *result;
}

std::string refusal(const std::string& text) {
  Diagnostics diagnostics;
  const auto result = format_document(diagnostics.add_source("scene.voml", text), diagnostics);
  CHECK(!result.has_value());
  return diagnostics.render().substr(0, diagnostics.render().find('\n'));
}

std::string file_text(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The lines without the blanks around them: what of a comment may not change.
std::string trimmed_lines(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) result += std::string(trim(line)) + '\n';
  return std::string(trim(result)) + '\n';
}

/// A document as another parser sees it: everything but blanks between elements, the order of attributes, and the case
/// of VOML's own words.
void describe(pugi::xml_node parent, std::string& out) {
  for (const pugi::xml_node node : parent.children()) {
    if (node.type() == pugi::node_element || node.type() == pugi::node_declaration) {
      const bool known = tag_of(node.name()) != Tag::unknown;
      out += (known ? upper_case(node.name()) : node.name()) + std::string("(");
      std::vector<std::string> attributes;
      for (const pugi::xml_attribute a : node.attributes()) {
        const auto own = attributes_of(tag_of(node.name()));
        const bool is_own = std::ranges::any_of(own, [&](auto name) { return same_word(name, a.name()); });
        attributes.push_back((is_own ? lower_case(a.name()) : a.name()) + std::string("=") + a.value());
      }
      std::ranges::stable_sort(attributes, {}, [](const std::string& a) { return a.substr(0, a.find('=')); });
      for (const std::string& a : attributes) out += a + '|';
      out += ")\n";
      describe(node, out);
      out += "end\n";
    } else if (node.type() == pugi::node_comment) {
      out += "comment " + trimmed_lines(node.value());
    } else {
      out += std::to_string(node.type()) + node.name() + '[' + node.value() + "]\n";
    }
  }
}
std::string described(const std::string& text) {
  pugi::xml_document document;
  REQUIRE(document.load_buffer(text.data(), text.size(), pugi::parse_full | pugi::parse_fragment));
  std::string out;
  describe(document, out);
  return out;
}

void check_keeps_everything(const std::string& text) {
  const std::string once = formatted(text);
  REQUIRE_MESSAGE(formatted(once) == once, "formatting twice differs, of\n" << text);
  REQUIRE_MESSAGE(described(once) == described(text), "formatted to\n" << once << "\nof\n" << text);
}

}  // namespace

TEST_CASE("one element a line, two blanks a level, attributes in order, empty elements short") {
  CHECK(formatted("<mvv><Object  name = 'A' ><Sdf file='x.lxn' offset=\"1\" NAME='S'></Sdf>\r\n\r\n\r\n\r\n<REGION "
                  "type='empty'\n"
                  "name='R'/></Object></mvv>") ==
        "<MVV>\n"
        "  <OBJECT name=\"A\">\n"
        "    <SDF name=\"S\" file=\"x.lxn\" offset=\"1\"/>\n"
        "\n"
        "    <REGION name=\"R\" type=\"empty\"/>\n"
        "  </OBJECT>\n"
        "</MVV>\n");
}

TEST_CASE("what stands on one line and fits stays so; what does not fit is broken") {
  const std::string fits = "<MVV>\n  <OBJECT name=\"A\"><REGION name=\"R\" type=\"empty\"/></OBJECT>\n</MVV>\n";
  CHECK(formatted(fits) == fits);
  const std::string name(100, 'N');
  CHECK(formatted("<MVV>\n<OBJECT name='" + name + "'><REGION name='R' type='empty'/></OBJECT></MVV>") ==
        "<MVV>\n  <OBJECT name=\"" + name + "\">\n    <REGION name=\"R\" type=\"empty\"/>\n  </OBJECT>\n</MVV>\n");
}

TEST_CASE("long tags are wrapped below their first attribute, at 120 columns") {
  const std::string a(50, 'a');
  CHECK(formatted("<MVV><OBJECT name='O'><REGION name='R' type='empty'>\n<EMBEDDED name='E' scale='1 1 1' seedFile='" +
                  a + "' rotateFile='" + a + "'/></REGION></OBJECT></MVV>") ==
        "<MVV>\n  <OBJECT name=\"O\">\n    <REGION name=\"R\" type=\"empty\">\n"
        "      <EMBEDDED name=\"E\" seedFile=\"" +
            a + "\"\n" + "                rotateFile=\"" + a +
            "\" scale=\"1 1 1\"/>\n"
            "    </REGION>\n  </OBJECT>\n</MVV>\n");
  // 120 columns fit, 121 do not.
  for (const std::size_t more : {0u, 1u}) {
    const std::string value(120 - std::string_view("  <OBJECT name=\"\" x=\"1\"/>").size() + more, 'v');
    const std::string out = formatted("<MVV>\n<OBJECT name='" + value + "'\nx='1'/></MVV>");
    CHECK(out == "<MVV>\n  <OBJECT name=\"" + value + "\"" + (more ? "\n          " : " ") + "x=\"1\"/>\n</MVV>\n");
  }
}

TEST_CASE("GLSL stays byte for byte, as text and as CDATA, with entities") {
  const std::string text =
      "<MVV>\n  <OBJECT name=\"A\">\n    <SDF name=\"S\" function=\"true\"> if (p.x &lt; 1.0)\n\t return 2.0;   \n\n"
      " return p.x;</SDF>\n    <SDF name=\"T\" function=\"true\"><![CDATA[\n x < 1  \n   ]]></SDF>\n"
      "  </OBJECT>\n</MVV>\n";
  CHECK(formatted(text) == text);
  CHECK(formatted("<MVV><FUNCTIONS>\n\n <![CDATA[ a\n ]]>  <![CDATA[b]]>\n </FUNCTIONS></MVV>") ==
        "<MVV>\n  <FUNCTIONS><![CDATA[ a\n ]]>  <![CDATA[b]]></FUNCTIONS>\n</MVV>\n");
}

TEST_CASE("an SDF with text and sides: the text stays, the sides are laid out") {
  CHECK(formatted(
            "<MVV><OBJECT name='A'><MAPPINGS><SDF name='S' function='1'><![CDATA[return p.x;]]>\n<POSITIVE region='R'/>"
            "<NEGATIVE\nregion='R'/></SDF></MAPPINGS></OBJECT></MVV>") ==
        "<MVV>\n  <OBJECT name=\"A\">\n    <MAPPINGS>\n"
        "      <SDF name=\"S\" function=\"1\"><![CDATA[return p.x;]]>\n"
        "        <POSITIVE region=\"R\"/>\n"
        "        <NEGATIVE region=\"R\"/>\n"
        "      </SDF>\n"
        "    </MAPPINGS>\n  </OBJECT>\n</MVV>\n");
}

TEST_CASE("comments are kept, beside what they stand beside, and move as a block") {
  CHECK(formatted(
            "<?xml version='1.0'?><!-- top -->\n<MVV>   <!-- of all -->\n<OBJECT name='A'/><!-- of A -->\n"
            "   <!-- first\n          second\n\n        third\n   -->\n<OBJECT name='B'/>\n\n\n<!-- last --></MVV>") ==
        "<?xml version=\"1.0\"?>\n<!-- top -->\n<MVV> <!-- of all -->\n  <OBJECT name=\"A\"/> <!-- of A -->\n"
        "  <!-- first\n         second\n\n       third\n  -->\n  <OBJECT name=\"B\"/>\n\n  <!-- last -->\n</MVV>\n");
}

TEST_CASE("processing instructions, DOCTYPE, quotes, entities, unknown names and MMV stay; a byte order mark goes") {
  const std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<?xml-model href=\"voml.rng\" schematypens=\"http://relaxng.org/ns/structure/1.0\"?>\n"
      "<!DOCTYPE MMV [<!ENTITY a \"b\">]>\n"
      "<MMV>\n  <OBJECT name='\"A\"' what=\"&amp;&#10;'\"/>\n  <Note x=\"1\" X=\"2\"/>\n</MMV>\n";
  CHECK(formatted(text) == text);
  CHECK(formatted("\xef\xbb\xbf" + text) == text);
}

TEST_CASE("what is no scene is refused with the reader's words") {
  CHECK(refusal("<MVV><OBJECT></MVV>") ==
        "scene.voml:1:16: error[E0002]: the closing tag 'MVV' does not close 'OBJECT', which is open");
  CHECK(refusal("<html/>") == "scene.voml:1:2: error[E0101]: the outermost element is 'html', it must be 'MVV'");
  CHECK(refusal("") == "scene.voml: error[E0002]: there is no element; a scene is one MVV element");
  const std::string instruction = refusal("<MVV/>\r\n<?a\"b?>");
  CHECK(instruction == "scene.voml:2:5: error[E0002]: this '<?' is never closed by '?>'");
  std::string deep;
  for (int i = 0; i < 5000; ++i) deep += "<a>";
  std::string closing;
  for (int i = 0; i < 5000; ++i) closing += "</a>";
  CHECK(refusal("<MVV>" + deep + closing + "</MVV>").find("error[E0004]") != std::string::npos);
}

TEST_CASE("deep trees: the output stays small") {
  std::string text = "<MVV>", closing;
  for (int i = 0; i < 4095; ++i) {
    text += "<a>\n";
    closing += "</a>";
  }
  const std::string once = formatted(text + "<!-- here -->" + closing + "</MVV>");
  CHECK(once.size() < 2 * 4100 * 90);
  CHECK(formatted(once) == once);
}

TEST_CASE("documents of every shape: nothing is lost, and the layout is stable") {
  std::mt19937 random(7);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random()) % n; };
  const auto one_of = [&](std::initializer_list<const char*> words) {
    return std::string(*(words.begin() + below(static_cast<std::uint32_t>(words.size()))));
  };
  const auto blanks = [&] { return one_of({"", "", " ", "\n", "\n\n", "\r\n \t", "   ", "\n\n\n  "}); };
  std::function<std::string(int)> element = [&](int depth) {
    const std::string name = one_of({"OBJECT", "object", "SDF", "Region", "note", "EMBEDDED", "POSITIVE", "FUNCTIONS"});
    std::string text = "<" + name;
    const std::uint32_t first = below(5);
    const std::string names[] = {"name", "SCALE", "file", "what", "seedfile", "type", "offset", "function"};
    for (std::uint32_t i = 0, n = below(4); i < n; ++i) {
      text += one_of({" ", "\n", "\t  "}) + names[first + i] + one_of({"=", " =\n"}) +
              one_of({"'a'", "\"b c\"", "'\"'", "\"&lt;&quot;\"", "'1 2\n 3'",
                      "\"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\""});
    }
    if (below(3) == 0) return text + blanks() + "/>";
    text += ">";
    for (std::uint32_t i = 0, n = depth == 0 ? below(2) : below(5); i < n; ++i) {
      text += blanks();
      switch (below(depth == 0 ? 6 : 9)) {
        case 0:
          text += one_of({"<!-- c -->", "<!---->", "<!-- a\n  b\n-->", "<!--\n\t\tx\n\n y -->"});
          break;
        case 1:
          text += one_of({"text", "a &lt; b;\n  c", "&#32;", "\xc3\xa4"});
          break;
        case 2:
          text += one_of({"<![CDATA[ a < b\n ]]>", "<![CDATA[]]>", "<![CDATA[x]]>"});
          break;
        case 3:
          text += one_of({"<?pi?>", "<?pi a  b?>"});
          break;
        default:
          text += element(depth - 1);
      }
    }
    return text + blanks() + "</" + name + one_of({">", " >", "\n>"});
  };
  for (int i = 0; i < 2000; ++i) {
    const std::string text = blanks() + one_of({"", "<!-- t -->"}) + blanks() + "<MVV>" + element(4) + blanks() +
                             element(2) + "</MVV>" + blanks();
    check_keeps_everything(text);
  }
}

TEST_CASE("the scenes of the examples are read the same before and after") {
  const fs::path folder = fs::path(DMVV_SOURCE_DIR) / "examples";
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".voml") continue;
    const std::string text = file_text(entry.path());
    CAPTURE(entry.path().string());
    check_keeps_everything(text);
    // Assets are not opened: every file is an empty list of seeds, an object of another file, or not there.
    const auto read = [&](const std::string& scene) {
      Diagnostics diagnostics;
      const ReadFile disk = disk_files();
      const ReadFile files = [&](const std::string& path, std::uint64_t most) -> Result<std::string> {
        if (path == "scene.voml") return scene;
        const fs::path relative(path);
        if (relative.extension() == ".voml") return disk((entry.path().parent_path() / relative).string(), most);
        if (relative.extension() == ".txt") return std::string("0.1 0.2 0.3\n");
        Grid grid;
        grid.size = glm::uvec3(1);
        grid.values = {1.0f};
        if (relative.extension() == ".lxn") return write_lxn(grid);
        return fail(Fault::input, "cannot read it");
      };
      const auto result = read_scene("scene.voml", files, {}, diagnostics);
      std::string out = result ? tests::to_text(*result) : "";
      for (const Diagnostic& d : diagnostics.all()) out += d.message + '\n';
      return out;
    };
    CHECK(read(text) == read(formatted(text)));
    ++count;
  }
  CHECK(count >= 7);
}
