// compiler::lint: warnings of what is no distance, and of surfaces that the cube cuts off.
#include "compiler/lint.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <map>
#include <string>

using namespace dmvv;

namespace {

std::string function(const std::string& body, const std::string& attributes = "", const std::string& name = "S") {
  return "<SDF name='" + name + "' function='true' " + attributes + "><![CDATA[" + body + "]]></SDF>";
}

const std::string filled = "<REGION name='R' type='color' rgb='1 0 0'/>";

/// What lint says of a scene, its codes and messages one a line.
std::string lint_text(const std::string& text, std::map<std::string, std::string> files = {}) {
  files["s.voml"] = text;
  Diagnostics diagnostics;
  auto scene = voml::read_scene("s.voml", memory_files(files), {}, diagnostics);
  REQUIRE_MESSAGE(scene.has_value(), diagnostics.render());
  const auto module = compiler::lower(std::move(*scene), diagnostics);
  REQUIRE(module.has_value());
  CHECK(diagnostics.all().empty());
  compiler::lint(*module, diagnostics);
  std::string result;
  for (const Diagnostic& d : diagnostics.all()) {
    CHECK(d.span.source.valid());
    result += fmt::format("{} {}\n", info(d.code).number, d.message);
  }
  return result;
}

std::string lint_function(const std::string& body, const std::string& attributes = "") {
  return lint_text("<MVV><OBJECT name='A'>" + function(body, attributes) + filled + "</OBJECT></MVV>");
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a distance that keeps inside of the cube gives no warning") {
  CHECK(lint_function("return length(p) - 0.5;") == "");
  CHECK(lint_function("return length(p) - 1.0;") == "");  // touches the cube, but nothing is cut off
  CHECK(lint_function("return length(p) - 0.5 - 0.25 * sin(t / 1000.0);") == "");
  CHECK(lint_function("return max(p.x, length(p) - 0.75);") == "");
}

TEST_CASE("W0402: the measured gradient, with its point") {
  CHECK(contains(lint_function("return 8.0 * (length(p) - 0.5);"), "W0402 the SDF 'S' changes by 8 a unit at p = ("));
  CHECK(contains(lint_function("return 0.125 * (length(p) - 0.5);"),
                 "W0402 the SDF 'S' changes by no more than 0.125 a unit"));
  // steeper as time goes by: 1 at the start, 61 after a minute
  const std::string later = lint_function("return (1.0 + min(t, 60000.0) / 1000.0) * (length(p) - 0.5);");
  CHECK(contains(later, "W0402 the SDF 'S' changes by 61 a unit"));
  CHECK(contains(later, "t = 60000 ms"));
}

TEST_CASE("W0403: a surface that leaves the cube, at some time") {
  CHECK(contains(lint_function("return length(p) - 1.25;"),
                 "W0403 the surface of the SDF 'S' is cut off by the standard cube"));
  const std::string grows = lint_function("return length(p) - 0.5 - min(t, 60000.0) / 60000.0;");
  CHECK(contains(grows, "W0403"));
  CHECK(contains(grows, "t = 60000 ms"));
  // (1, 0, 0) of the object is where the moved ball still is
  CHECK(contains(lint_function("return length(p - vec3(0.75, 0.0, 0.0)) - 0.5;"), "W0403"));
  CHECK_FALSE(contains(lint_function("return -1.0;"), "W0403"));  // fills everything: there is no surface
}

TEST_CASE("W0403: the cube of the SDF's own frame cuts as well") {
  const std::string small = lint_function("return length(p) - 1.25;", "scale='0.25 0.25 0.25'");
  CHECK(contains(small, "cut off by the standard cube of its own frame"));
  CHECK(lint_function("return length(p) - 0.75;", "scale='0.25 0.25 0.25'") == "");
  CHECK(contains(lint_function("return length(p) - 0.75;", "translate='0.5 0 0'"), "W0403"));  // the object's cube
  CHECK_FALSE(contains(lint_function("return length(p) - 1.25;", "type='tiling'"), "W0403"));
}

TEST_CASE("W0403 is silent where both sides are filled, or another SDF decides") {
  const std::string two = filled + "<REGION name='Q' type='color' rgb='0 1 0'/><REGION name='E' type='empty'/>";
  const std::string halves = "<MAPPINGS><SDF name='S'><POSITIVE region='R'/><NEGATIVE region='Q'/></SDF></MAPPINGS>";
  CHECK(lint_text("<MVV><OBJECT name='A'>" + function("return p.x;") + two + halves + "</OBJECT></MVV>") == "");
  const auto nested = [&](const std::string& outer) {
    return lint_text("<MVV><OBJECT name='A'>" + function(outer, "", "OUTER") + function("return p.x;") + two +
                     "<MAPPINGS><SDF name='OUTER'><POSITIVE region='E'/><NEGATIVE><SDF name='S'><POSITIVE region='E'/>"
                     "<NEGATIVE region='Q'/></SDF></NEGATIVE></SDF></MAPPINGS></OBJECT></MVV>");
  };
  CHECK(nested("return length(p) - 0.75;") == "");
  CHECK(contains(nested("return length(p) - 1.25;"), "W0403 the surface of the SDF 'OUTER'"));
}

TEST_CASE("W0403 looks at seeds and grids on the way") {
  const std::map<std::string, std::string> files = {{"seeds.txt", "0 0 0\n0.25 0 0\n"}};
  const auto seeded = [&](const std::string& radius) {
    return lint_text(
        "<MVV><OBJECT name='A'>" +
            function("return length(p) - " + radius + ";", "type='seeding' seedFile='seeds.txt' scale='0.4 0.4 0.4'") +
            filled + "</OBJECT></MVV>",
        files);
  };
  CHECK(seeded("0.75") == "");
  CHECK(contains(seeded("1.25"), "W0403"));
}
