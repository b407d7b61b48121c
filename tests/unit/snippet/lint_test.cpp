// compiler::lint: warnings of what is no distance, and of surfaces that the cube cuts off.
#include "compiler/reference/lint.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>

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

TEST_CASE("W0404: an SDF that is inside, or outside, everywhere") {
  const std::string inside = lint_function("return length(p) - 5.0;");  // sqrt(3) - 5 at the corners, at most
  CHECK(inside.starts_with(
      "W0404 the SDF 'S' is inside everywhere: its largest value in the standard cube [-1,1]^3 at p = ("));
  CHECK(contains(inside, "is -3.26795;"));
  const std::string outside = lint_function("return length(p - vec3(3.0, 0.0, 0.0)) - 0.5;");  // 1.5 at (1, 0, 0)
  CHECK(contains(outside, "W0404 the SDF 'S' is outside everywhere: its least value"));
  CHECK(contains(outside, "at p = (1, 0, 0) is 1.5;"));
  CHECK(contains(lint_function("return length(p) + 0.25;", "offset='0.1'"), "and its offset is 0.1;"));
  CHECK(lint_function("return length(p) + 0.25;", "offset='0.5'") == "");
  // One mistake, one message: no gradient is missed where there is no surface.
  CHECK_FALSE(contains(lint_function("return -1.0;"), "W0402"));
  CHECK(contains(lint_function("return -1.0;"), "W0404"));
  CHECK(contains(lint_function("return length(p) - 5.0;", "type='tiling' scale='0.5 0.5 0.5'"), "W0404"));
  // Outside for a minute, inside later: there is a surface at some time.
  CHECK_FALSE(contains(lint_function("return length(p) + 0.5 - t / 60000.0;"), "W0404"));
  CHECK(contains(lint_function("return length(p) - 5.0 + sin(t / 100.0);"), "W0404"));
}

TEST_CASE("W0404: what noise hides from intervals") {
  // 0.5 times a sum of noise below 1, on a ball of radius 5: written for another size.
  const std::string planet =
      "<MVV><FUNCTIONS><![CDATA["
      "float hash(vec3 q) { q = fract(q * 0.3183 + vec3(0.11, 0.17, 0.13)); q *= 17.0; return fract(q.x * q.y * q.z * "
      "(q.x + "
      "q.y + q.z)); }\n"
      "float noise(vec3 x) { vec3 i = floor(x), f = fract(x); f = f * f * (3.0 - 2.0 * f);"
      "  return mix(mix(mix(hash(i), hash(i + vec3(1, 0, 0)), f.x), mix(hash(i + vec3(0, 1, 0)), hash(i + vec3(1, 1, "
      "0)), f.x), f.y),"
      "             mix(mix(hash(i + vec3(0, 0, 1)), hash(i + vec3(1, 0, 1)), f.x), mix(hash(i + vec3(0, 1, 1)), "
      "hash(i + vec3(1, 1, 1)), f.x), f.y), f.z); }\n"
      "float fbm(vec3 x) { float s = 0.0, a = 0.5; for (int i = 0; i < 5; ++i) { s += a * noise(x); x = x * 2.03 + "
      "1.7; a *= 0.5; } return s; }"
      "]]></FUNCTIONS><OBJECT name='PLANET'><SDF name='S' function='true'>return length(p) - 5.0 + 0.5 * fbm(3.0 * p "
      "TIME);</SDF>"
      "<REGION name='R' type='color' rgb='0.9 0.6 0.2'/></OBJECT></MVV>";
  for (const std::string time : {"", " + t / 1000.0"}) {
    std::string text = planet;
    text.replace(text.find(" TIME"), 5, time);
    CHECK(contains(lint_text(text), "W0404 the SDF 'S' is inside everywhere"));
  }
}

TEST_CASE("W0404: no small or thin shape is overlooked") {
  CHECK(lint_function("return length(p - vec3(0.123, 0.456, 0.789)) - 0.001;") == "");
  CHECK(lint_function("return 0.001 - length(p - vec3(0.123, 0.456, 0.789));") == "");
  CHECK(lint_function("return abs(length(p) - 0.512) - 0.0005;") == "");
  CHECK(lint_function("return max(length(p.xy - vec2(0.031, 0.017)) - 0.0007, abs(p.z) - 0.9);") == "");
  // A blob that no sample meets, beside a plane that the cube does not hold.
  CHECK_FALSE(contains(
      lint_function("vec3 q = p - vec3(0.31, 0.42, 0.23); return min(p.y + 3.0, 0.5 - exp(-9000.0 * dot(q, q)));"),
      "W0404"));
}

TEST_CASE("W0404: grids, by all their samples") {
  const auto grid = [](float value, float one, const std::string& attributes = "") {
    voml::Grid made;
    made.size = glm::uvec3(4);
    made.values.assign(64, value);
    made.values[21] = one;
    return lint_text(
        "<MVV><OBJECT name='A'><SDF name='G' file='g.lxn' " + attributes + "/>" + filled + "</OBJECT></MVV>",
        {{"g.lxn", voml::write_lxn(made)}});
  };
  CHECK(grid(1.0f, -1.0f) == "");
  CHECK(grid(-1.0f, 1.0f) == "");
  CHECK(contains(grid(1.0f, 0.25f), "W0404 the SDF 'G' is outside everywhere: its least sample is 0.25;"));
  CHECK(contains(grid(-1.0f, -0.25f), "W0404 the SDF 'G' is inside everywhere: its largest sample is -0.25;"));
  CHECK(grid(1.0f, 0.25f, "offset='0.5'") == "");
}

TEST_CASE("W0405: a tile whose surface the next one does not continue") {
  const std::string half = "type='tiling' scale='0.5 0.5 0.5'";
  const std::string cut = lint_function("return length(p - vec3(0.75, 0.0, 0.0)) - 0.5;", half);
  CHECK(contains(cut, "W0405 the surface of the SDF 'S' is cut at the edge of its tile: at p = (1, "));
  // -0.25 at (1, 0, 0), 1.25 at (-1, 0, 0)
  CHECK(lint_function("return length(p - vec3(0.25, 0.0, 0.0)) - 0.5;", half) == "");
  CHECK(lint_function("return length(p) - 1.25;", half) == "");                                     // faces are equal
  CHECK(lint_function("return 0.3 * sin(3.14159265 * p.x) * sin(3.14159265 * p.y);", half) == "");  // periodic
  CHECK(lint_function("return length(p - vec3(0.75, 0.0, 0.0)) - 0.5;", "type='tiling'") == "");  // one tile: the cube
  CHECK(lint_function("return length(p - vec3(0.75, 0.0, 0.0)) - 0.5;").starts_with("W0403"));
  // Both sides of the cut are one region.
  CHECK(lint_text(
            "<MVV><OBJECT name='A'>" + function("return length(p - vec3(0.75, 0.0, 0.0)) - 0.5;", half) + filled +
            "<MAPPINGS><SDF name='S'><POSITIVE region='R'/><NEGATIVE region='R'/></SDF></MAPPINGS></OBJECT></MVV>") ==
        "");
}

TEST_CASE("W0406: a hash of a sine depends on rounding, one of integers does not") {
  const auto cells = [&](const std::string& hash) {
    return lint_text(
        "<MVV><FUNCTIONS><![CDATA[#include <sdf>\n" + hash +
        "float cells(vec3 x) { vec3 i = floor(x), f = fract(x); float r = 8.0;\n"
        "for (int k = 0; k < 27; ++k) { vec3 b = vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1); vec3 d = b - f + hash(i + "
        "b); r = min(r, dot(d, d)); }\n"
        "return sqrt(r); }]]></FUNCTIONS><OBJECT name='O'><SDF name='S' function='true'>return (cells(3.0 * p) - 0.4) "
        "/ 3.0;</SDF>"
        "<REGION name='E' type='color' rgb='0 0 0'/><REGION name='R' type='color' rgb='0.9 0.6 0.2'/>"
        "<MAPPINGS><SDF name='S'><POSITIVE region='E'/><NEGATIVE region='R'/></SDF></MAPPINGS></OBJECT></MVV>");
  };
  const std::string sine = cells(
      "vec3 hash(vec3 q) { return fract(sin(vec3(dot(q, vec3(12.9, 78.2, 37.7)), dot(q, vec3(39.3, 11.1, 83.2)), "
      "dot(q, "
      "vec3(73.2, 52.2, 9.1)))) * 43758.5453); }\n");
  CHECK(contains(sine, "W0406 the side of the SDF 'S' depends on rounding at "));
  CHECK(contains(sine, "fract of a product of 43758.5 and a sine, which float32 knows to within "));
  CHECK(contains(sine, "op_noise"));
  const std::string integers = cells(
      "vec3 hash(vec3 q) { uvec3 v = uvec3(ivec3(q)) * 1664525u + 1013904223u; v.x += v.y * v.z; v.y += v.z * v.x; v.z "
      "+= v.x * "
      "v.y; v ^= v >> 16u; v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y; return vec3(v >> 8u) / 16777216.0; "
      "}\n");
  CHECK_FALSE(contains(integers, "W0406"));
  CHECK_FALSE(
      contains(lint_function("#include <sdf>\nreturn (length(p) - 0.6 + 0.2 * op_noise(7.0 * p)) / 3.0;"), "W0406"));
  // Without a jump: what is left of a small number beside a large one.
  CHECK(contains(lint_function("return (p.x + 1e8) - 1e8 - 0.3 * p.y;"),
                 "W0406 the side of the SDF 'S' depends on rounding"));
}

TEST_CASE("the collection of distance functions is sound: nothing is missing, unset or left to rounding") {
  for (const auto& file : std::filesystem::directory_iterator(DMVV_SOURCE_DIR "/tests/snippets")) {
    if (file.path().extension() != ".glsl") continue;
    std::ifstream stream(file.path());
    std::string text(std::istreambuf_iterator<char>(stream), {}), helpers;
    constexpr std::string_view mark = "// ---- body\n";
    if (const std::size_t at = text.find(mark); at != std::string::npos) {
      helpers = "<FUNCTIONS><![CDATA[" + text.substr(0, at) + "]]></FUNCTIONS>";
      text.erase(0, at + mark.size());
    }
    const std::string said =
        lint_text("<MVV>" + helpers + "<OBJECT name='A'>" + function(text) + filled + "</OBJECT></MVV>");
    CAPTURE(file.path().string());
    CHECK_MESSAGE(!contains(said, "W0404"), said);
    CHECK_MESSAGE(!contains(said, "W0406"), said);
  }
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
