// GLSL in scenes: FUNCTIONS, and the place of every byte of a text.
#include <fmt/format.h>

#include "tests/unit/voml/reading.h"

using namespace dmvv;
using namespace dmvv::voml;
using tests::read;
using tests::read_text;
using tests::scene_of;

namespace {

const std::string region = "<REGION name='R' type='empty'/>";

std::string object(const std::string& name, const std::string& inside) {
  return "<OBJECT name='" + name + "'>" + inside + "<SDF name='S' function='true'>return " + name + ";</SDF>" + region +
         "</OBJECT>";
}

/// The texts of the helpers of the function whose body is "return NAME;".
std::vector<std::string> helpers_of(const Scene& scene, const std::string& name) {
  std::vector<std::string> result;
  for (const Function& function : scene.functions) {
    if (function.body.text != "return " + name + ";") continue;
    for (const GlslText& helper : function.helpers) result.push_back(helper.text);
  }
  return result;
}

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("FUNCTIONS of MVV and OBJECT: in document order, those of the object last, wherever they stand") {
  const Scene scene = scene_of("<MVV><functions>one</functions>" +
                               object("A", "<FUNCTIONS>a1</FUNCTIONS><FUNCTIONS><![CDATA[a2]]></FUNCTIONS>") +
                               object("B", "") + "<FUNCTIONS>two</FUNCTIONS></MVV>");
  CHECK(helpers_of(scene, "A") == Texts{"one", "two", "a1", "a2"});
  CHECK(helpers_of(scene, "B") == Texts{"one", "two"});
}

TEST_CASE("FUNCTIONS of imported files stand where the import stands; a file sees what it imports, not its importers") {
  const std::map<std::string, std::string> files = {
      {"scene.voml",
       "<MVV><FUNCTIONS>first</FUNCTIONS><IMPORT file='a.voml'/><IMPORT file='b.voml'/>"
       "<FUNCTIONS>last</FUNCTIONS>" +
           object("S", "") + "</MVV>"},
      {"a.voml", "<MVV><IMPORT file='base.voml'/><FUNCTIONS>a</FUNCTIONS>" + object("A", "") + "</MVV>"},
      {"b.voml", "<MVV><IMPORT file='base.voml'/><FUNCTIONS>b</FUNCTIONS>" + object("B", "") + "</MVV>"},
      {"base.voml", "<MVV><FUNCTIONS>base</FUNCTIONS>" + object("BASE", "") + "</MVV>"}};
  const auto reading = read(files);
  CHECK(reading.messages == "");
  REQUIRE(reading.scene);
  CHECK(helpers_of(*reading.scene, "S") == Texts{"first", "base", "a", "b", "last"});
  CHECK(helpers_of(*reading.scene, "A") == Texts{"base", "a"});
  CHECK(helpers_of(*reading.scene, "B") == Texts{"base", "b"});
  CHECK(helpers_of(*reading.scene, "BASE") == Texts{"base"});
}

TEST_CASE("FUNCTIONS without a text, and grids, have no effect") {
  const Scene scene = scene_of("<MVV><FUNCTIONS/><FUNCTIONS> \n </FUNCTIONS>" + object("A", "") + "</MVV>");
  CHECK(helpers_of(scene, "A") == Texts{});
}

TEST_CASE("more FUNCTIONS than an SDF may use are refused at the one too many") {
  std::string blocks;
  for (int i = 0; i < 257; ++i) blocks += "<FUNCTIONS>x</FUNCTIONS>";
  CHECK(read_text("<MVV>" + blocks + object("A", "") + "</MVV>").messages.find("error[E0005]") != std::string::npos);
  const std::string large = "<FUNCTIONS>" + std::string(140000, ' ') + "x</FUNCTIONS>";
  CHECK(read_text("<MVV>" + large + object("A", "") + "</MVV>").errors == 0);
  const std::string larger = "<FUNCTIONS>" + std::string(9'000'000, ' ') + "x</FUNCTIONS>";
  CHECK(read_text("<MVV>" + larger + object("A", "") + "</MVV>").errors == 0);
  CHECK(read_text("<MVV>" + larger + larger + object("A", "") + "</MVV>").messages.find("error[E0005]") !=
        std::string::npos);
  std::string many;  // small for each, too much for all
  for (int i = 0; i < 300; ++i) many += object(fmt::format("A{}", i), "");
  CHECK(read_text("<MVV>" + large + many + "</MVV>").messages.find("error[E0005]") != std::string::npos);
}

TEST_CASE("every byte of a text knows where it stands") {
  const std::string file =
      "<MVV><OBJECT name='A'><SDF name='S' function='true'>a &lt; b;\r\n c<!-- \n no -->&#x1F600;d<![CDATA[&lt;e]]>"
      " &nope; &#65; f</SDF>" +
      region + "</OBJECT></MVV>";
  const Scene scene = scene_of(file);
  const GlslText& body = scene.functions.at(0).body;
  REQUIRE(body.text ==
          "a < b;\n c\n\xf0\x9f\x98\x80"
          "d&lt;e &nope; A f");
  CHECK(body.pieces.at(0).begin == 0);
  const auto written = [&](const std::string& part) {
    const auto begin = static_cast<std::uint32_t>(body.text.find(part));
    const Span span = locate(body, begin, begin + static_cast<std::uint32_t>(part.size()));
    return file.substr(span.begin, span.end - span.begin);
  };
  CHECK(written("a") == "a");
  CHECK(written("<") == "&lt;");
  CHECK(written("b") == "b");
  CHECK(written("c") == "c");
  CHECK(written("\xf0\x9f\x98\x80") == "&#x1F600;");
  CHECK(written("d") == "d");
  CHECK(written("&lt;e") == "&lt;e");
  CHECK(written("&nope;") == "&nope;");
  CHECK(written("A") == "&#65;");
  CHECK(written("a < b") == "a &lt; b");
  CHECK(written("f") == "f");
  const auto length = static_cast<std::uint32_t>(body.text.size());
  const Span end = locate(body, length, length);
  CHECK(end.begin == end.end);
  CHECK(file.substr(end.begin, 6) == "</SDF>");
}

TEST_CASE("a text that was not read from a file has no places") {
  const Span span = locate(GlslText{"return 1.0;", {}}, 0, 3);
  CHECK_FALSE(span.source.valid());
}

TEST_CASE("FUNCTIONS elsewhere are misplaced, a misspelt one is suggested") {
  CHECK(read_text("<MVV><OBJECT name='A'><REGION name='R' type='empty'><FUNCTIONS/></REGION></OBJECT></MVV>")
            .messages.find("FUNCTIONS cannot stand in REGION; it belongs in MVV or OBJECT") != std::string::npos);
  CHECK(read_text("<MVV><FUNCTION>x</FUNCTION><OBJECT name='A'>" + region + "</OBJECT></MVV>")
            .messages.find("did you mean 'FUNCTIONS'?") != std::string::npos);
}
