// Functions of scenes through compile_snippet: what compiles, and each mistake at its place.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "compiling.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

constexpr double tolerance = 1e-6;  // literals are float32

}  // namespace

// ---- what compiles ----

TEST_CASE("locals, loops, branches, arrays, matrices and built-ins") {
  CHECK(value_of("float a[3] = float[3](1.0, 2.0, 4.0); float sum = 0.0;\n"
                 "for (int i = 0; i < 3; ++i) { if (i == 1) continue; sum += a[i]; }\n"
                 "mat2 m = mat2(1.0, 2.0, 3.0, 4.0); return sum + (m * vec2(1.0, 10.0)).y;") ==
        doctest::Approx(5.0 + 42.0));
  CHECK(value_of("p = p * 2.0; return p.x;") == doctest::Approx(0.5));  // p may be written
  CHECK(value_of("struct S { float a; }; S s; s.a = 3.0; return s.a; // done") == 3.0);
}

TEST_CASE("Cg spellings mean what they mean in Cg") {
  CHECK(value_of("return lerp(1.0, 3.0, 0.25);") == doctest::Approx(1.5));
  CHECK(value_of("return frac(-0.25);") == doctest::Approx(0.75));
  CHECK(value_of("return saturate(float2(-1.0, 7.0)).y + saturate(-3.0);") == doctest::Approx(1.0));
  CHECK(value_of("return fmod(-5.5, 2.0);") == doctest::Approx(-1.5));  // the sign of the first
  CHECK(value_of("return atan2(1.0, -1.0);") == doctest::Approx(3.0 * M_PI / 4.0).epsilon(tolerance));
  CHECK(value_of("return rsqrt(4.0) + log10(1000.0);") == doctest::Approx(3.5).epsilon(tolerance));
  CHECK(value_of("float s, c; sincos(0.5, s, c); return s * 10.0 + c;") ==
        doctest::Approx(std::sin(0.5) * 10.0 + std::cos(0.5)));
  CHECK(value_of(
            "half a = 0.5h; fixed4 b = fixed4(a, a, a, a); static const float2 c = float2(1, 2); return b.w + c.y;") ==
        doctest::Approx(2.5));
}

TEST_CASE("mul takes the rows of a Cg matrix") {
  const std::string m = "float2x3 m = float2x3(1, 2, 3, 4, 5, 6); ";  // rows (1 2 3) and (4 5 6)
  CHECK(value_of(m + "return mul(m, float3(1, 10, 100)).y;") == doctest::Approx(4 + 50 + 600));
  CHECK(value_of(m + "return mul(float2(1, 10), m).z;") == doctest::Approx(3 + 60));
  CHECK(value_of(m + "return m[1].z;") == doctest::Approx(6));
  const std::string n = m + "float3x2 n = float3x2(1, 0, 0, 1, 7, 8); float2x2 r = mul(m, n); ";
  CHECK(value_of(n + "return r[0].x;") == doctest::Approx(1 + 3 * 7));
  CHECK(value_of(n + "return r[1].x;") == doctest::Approx(4 + 6 * 7));
}

TEST_CASE("names of the author are the author's, also where Cg or the wrapper has them") {
  CHECK(value_of("float frac = 3.0; return frac;") == 3.0);
  CHECK(value_of("return saturate(3.0);", {}, "float saturate(float x) { return x + 1.0; }") == 4.0);
  CHECK(value_of("return f(p, t);", {}, "float f(vec3 p, float t) { return 7.0; }") == 7.0);
  CHECK(value_of("main(); return barrier(1.0);", {}, "void main() {} float barrier(float x) { return -x; }") == -1.0);
  CHECK(value_of("vec3 half_size = vec3(2.0); float texture_scale = half_size.x; return texture_scale;") == 2.0);
}

TEST_CASE("macros, conditions and the library") {
  CHECK(value_of("#define TWICE(x) ((x) + \\\n (x))\n#define ONE 1.0\nreturn TWICE(TWICE(ONE)) + p.x;") ==
        doctest::Approx(4.25));
  CHECK(value_of("#define A\n#ifdef A\nreturn 1.0;\n#else\nreturn nonsense(;\n#endif") == 1.0);
  CHECK(value_of("#define x x\nfloat x = 2.0; return x;") == 2.0);  // a macro does not expand in itself
  CHECK(value_of("#include <sdf>\nreturn sd_sphere(p, 0.5);", {0, 2, 0}) == doctest::Approx(1.5));
  CHECK(value_of("return ball(p);", {0, 2, 0}, "#include <sdf>\nfloat ball(vec3 p) { return sd_sphere(p, 2.0); }\n") ==
        doctest::Approx(0.0));
}

TEST_CASE("equal bodies make equal programs") {
  const std::string a = snippet_of("float r = 0.5; return length(p) - r;").glsl("d", 0);
  CHECK(a == snippet_of("float radius = 0.5; /* the same */ return length(p) - radius;").glsl("d", 0));
  CHECK(a != snippet_of("return length(p) - 0.25;").glsl("d", 0));
}

// ---- mistakes at their place ----

TEST_CASE("E0401: syntax") {
  check_body("float a = 1.0\n@return a;", {"E0401 ',' or ';' is missing before 'return'"});
  check_body("return 1.0@\n// the end\n", {"E0401 ',' or ';' is missing here"});
  check_body("return @(1.0;", {"E0401 '(' is never closed by ')'"});
  check_body("if (p.x > 0.0) @{ return 1.0; return 2.0;", {"E0401 '{' is never closed by '}'"});
  check_body("return 1.0; @} float g() { return 2.0;", {"E0401 '}' closes nothing"});
  check_body("float a[2@); return 1.0;", {"E0401 ')' does not close '[', which is open"});
  check_body("return 1.0; @/* and so on", {"E0401 this comment is never closed by '*/'"});
  check_body("float @\xc3\xa9 = 1.0; return 1.0;", {"E0401 '\xc3\xa9' has no meaning in GLSL"});
  check_body("float @sample = 1.0; return sample;",
             {"E0401 'sample' is a word that GLSL keeps for itself; take another name"});
  check_body("float g(float x) @{ return x; } return g(1.0);",
             {"E0401 a function cannot be defined inside of another; helper functions stand in FUNCTIONS"});
  check_body("@break; return 1.0;", {"E0401 'break' stands outside of a loop or switch"});
  check_body("#ifdef A\nreturn 1.0;\n#endif\n#@endif\nreturn 2.0;",
             {"E0401 there is no #if that this #endif could belong to"});
}

TEST_CASE("E0401: types") {
  check_body("vec3 a = @1.0; return a.x;", {"E0401 a vec3 is needed, but this is a float"});
  check_body("int i = @1.5; return 1.0;", {"E0401 an int is needed, but this is a float"});
  check_body("return (p @+ mat2(1.0)).x;", {"E0401 '+' does not work between vec3 and mat2"});
  check_body("return p.@w;", {"E0401 the vector has no component '.w'"});
  check_body("@if (p.x) return 1.0; return 2.0;",
             {"E0401 a condition must be a bool; compare the value with something"});
  check_body("vec3 a = @vec3(1.0, 2.0); return a.x;", {"E0401 this constructor gets too few values"});
  check_body("return @dot(p, 1.0);", {"E0401 'dot' does not take these arguments"});
  check_body("float a = 1.0;\n  float @a = 2.0; return a;",
             {"E0401 'a' is defined twice; take one away, or give it another name"});
  check_body("vec3 a = vec3(1.0), b = @2.0; a = @t; return a.x;",
             {"E0401 a vec3 is needed, but this is a float", "E0401 a vec3 is needed, but this is a float"});
  check_body("const float a = 1.0; a @= 2.0; return a;", {"E0401 a constant cannot be changed"});
  check_body("float a[3]; return a[@5];", {"E0401 the index 5 lies outside of the array"});
}

TEST_CASE("E0402: unknown functions and names, with a suggestion") {
  check_body("return @lenght(p) - 1.0;", {"E0402 no function 'lenght'; did you mean 'length'?"});
  check_body("float radius = 0.5;\n\treturn length(p) - @raduis;",
             {"E0402 unknown name 'raduis'; did you mean 'radius'?"});
  check_body("@flaot a = 1.0; return a;", {"E0402 unknown name 'flaot'; did you mean 'float'?"});
  check_body("return @sd_box(p, vec3(0.5));",
             {"E0402 'sd_box' is a function of the library; #include <sdf> makes it known"});
  check_body("#include <sdf>\nreturn @sd_spere(p, 0.5);", {"E0402 no function 'sd_spere'; did you mean 'sd_sphere'?"});
  check_body("return @bolb(p);", {"E0402 no function 'bolb'; did you mean 'blob'?"},
             "float blob(vec3 q) { return length(q); }");
  check_body("return a(1.0);", {"E0402 the function 'a' is declared, but not defined"}, "float @a(float x);");
}

TEST_CASE("the name at fault is the one that is meant, however often it stands in the line") {
  check_body("float foo = 1.0; return foo + @foo(2.0);", {"E0401 'foo' is a variable, not a function"});
  check_body("/* lenght */ return length(p) + @lenght(p); // lenght",
             {"E0402 no function 'lenght'; did you mean 'length'?"});
}

TEST_CASE("all mistakes are reported, their consequences are not") {
  check_body("float a = @lenght(p);\nfloat b = @cosinus(p.x);\nvec3 c = @1.0;\nreturn a + b + c.x + @dd;",
             {"E0402 no function 'lenght'; did you mean 'length'?", "E0402 no function 'cosinus'",
              "E0401 a vec3 is needed, but this is a float", "E0402 unknown name 'dd'"});
  check_body("vec3 d = @foo(p); vec3 e = @qq; vec3 g = qq + d; return g.x;",
             {"E0402 no function 'foo'", "E0402 unknown name 'qq'"});
  check_body("return @dFdx(p.x) + dot(p, @gl_Position.xyz);\n float x = @foo(1.0);",
             {"E0404 'dFdx' compares neighbouring pixels, but a distance is evaluated at single points; take "
              "differences of the function itself",
              "E0404 'gl_Position' belongs to a shader stage, but a distance function knows p and t alone",
              "E0402 no function 'foo'"});
}

TEST_CASE("E0403: returns") {
  const std::string not_every = "E0403 not every way through this function ends in a 'return'";
  check_body("@if (p.x > 0.0) return 1.0;", {not_every});
  check_body("@for (int i = 0; i < 3; ++i) { if (p.x > 0.0) return 1.0; }", {not_every});
  check_body("@switch (int(p.x)) { case 1: return 1.0; }", {not_every});
  check_body("@float a = 1.0;", {"E0403 the function never returns its distance; it needs a 'return'"});
  check_body("@return p;", {"E0403 a distance is one float, but this 'return' gives another type"});
  check_body("@return;", {"E0403 this 'return' has no value; the function must give one"});
  check_body("return a(p.x);", {not_every}, "float @a(float x) {\n if (x > 0.0) return x; }");
  check_body("return a(p.x).x;", {"E0403 this 'return' gives another type than the function has"},
             "vec3 a(float x) { @return x; }");
  CHECK(value_of("if (p.x > 9.0) return 1.0; else return 2.0;") == 2.0);
  CHECK(value_of("while (true) { if (p.x < 9.0) return 3.0; }") == 3.0);
}

TEST_CASE("E0404: what a distance function cannot have, and why") {
  const std::string texture =
      "reads textures or images, but a distance function knows p and t alone; a sampled distance "
      "is an SDF with a file";
  check_body("@sampler2D s; return @texture(s, p.xy).r;",
             {"E0404 'sampler2D' " + texture, "E0404 'texture' " + texture});
  check_body(
      "if (p.x > 0.0) @discard; return 1.0;",
      {"E0404 'discard' throws a pixel away, but a distance is evaluated at single points; return a positive value "
       "for 'outside'"});
  check_body("@barrier(); return 1.0;",
             {"E0404 'barrier' works with what other invocations see, but a distance is evaluated at single points"});
  check_body("@imageStore(p, p, p); return 1.0;", {"E0404 'imageStore' " + texture});
  check_body("@double x = 1.0; return float(x);",
             {"E0404 'double' is a 64-bit type, but distances are computed in float32 on the device"});
  const std::string interface = "declares data from outside, but a distance function knows p and t alone";
  check_body("return 1.0;", {"E0404 'uniform' " + interface}, "@uniform float u;");
  check_body("return 1.0;", {"E0404 'layout' " + interface, "E0404 'buffer' " + interface},
             "@layout(binding = 0) @buffer B { float x; } b;");
  check_body("return 1.0;", {"E0404 'in' " + interface}, "@in float q;");
  CHECK(value_of("float a; set(a); return a;", {}, "void set(out float x) { x = 2.0; }") == 2.0);
}

TEST_CASE("E0404: directives that reach outside") {
  check_body(
      "#@extension GL_EXT_shader_explicit_arithmetic_types : enable\nreturn 1.0;",
      {"E0404 '#extension' is refused: a distance function is plain GLSL 4.60, the same on every device; leave this "
       "line out, and do without what it asks for"});
  check_body(
      "#@version 330\nreturn 1.0;",
      {"E0404 '#version' belongs at the top of a whole shader; the functions of a scene are GLSL 4.60, leave this "
       "line out"});
  check_body("#@line 7 \"other\"\nreturn 1.0;",
             {"E0404 '#line' is refused: mistakes are reported where they stand in this file; leave this line out"});
  const std::string include =
      "E0404 only the library can be included, by #include <sdf>; functions of your own stand in "
      "FUNCTIONS, also of a file that IMPORT names";
  check_body("#include \"@secrets.h\"\nreturn 1.0;", {include});
  check_body("#include <@stdio>\nreturn 1.0;", {include});
}

TEST_CASE("E0405: recursion") {
  check_body("return @f(p * 2.0, t) + 1.0;", {"E0405 'f' calls itself; a shader has no stack, write a loop instead"});
  check_body("return factorial(p.x);", {"E0405 'factorial' calls itself; a shader has no stack, write a loop instead"},
             "float factorial(float x) { return x < 1.0 ? 1.0 : x * @factorial(x - 1.0); }");
  const Outcome mutual = compile({{"s.voml", scene_of("return a(p.x);",
                                                      "float a(float x);\n"
                                                      "float b(float x) { return a(x); }\n"
                                                      "float a(float x) { return b(x) + 1.0; }")}});
  REQUIRE(mutual.messages.size() == 1);
  CHECK(mutual.messages[0].find("E0405") != std::string::npos);
}

TEST_CASE("E0406: a loop that does not end, with the point and time") {
  const std::string endless = fmt::format("E0406 a loop does not end within {} steps at ", Snippet::step_budget);
  check_body("float a = 0.0; @while (a < 1.0) { a *= 0.5; } return a;", {endless + "p = (0, 0, 0)"});
  // ends at the start and in the first second, not in an hour
  check_body("float a = 0.0; @for (float i = 0.0; i < t; i += 1.0) a += 1.0; return a - p.x;",
             {endless + "p = (0, 0, 0), t = 3600000 ms"});
  check_body("@float a = p.x;\nfor (int i = 0; i >= 0; ) a += 1.0; while (a > 3.0) a -= 1.0; return a;",
             {endless + "p = (0, 0, 0)"});
}

TEST_CASE("W0401: values that are no distances, with a witness") {
  check_body("@return 1.0 / p.x;", {"W0401 the distance is infinite at p = (0, 0, 0)"});
  check_body("@return sqrt(p.x - 0.5);", {"W0401 the distance is not a number at p = (0, 0, 0)"});
  check_body("@return t > 2000.0 ? 1.0 / 0.0 + p.x : p.x;",
             {"W0401 the distance is infinite at p = (0, 0, 0), t = 60000 ms"});
  const Outcome outcome = compile({{"s.voml", scene_of("return 1.0 / p.x;")}});
  CHECK(outcome.snippets.at(0).has_value());  // a warning leaves it usable
}

// ---- places through the file's own encoding ----

TEST_CASE("places through entities, comments, CDATA, CR LF and a byte order mark") {
  check_marked(
      {{"s.voml",
        "<MVV><OBJECT name='A'><SDF name='S' function='true'>\n"
        "  float a = p.x &lt; 0.5 &amp;&amp; p.y &gt; 0.0 ? 1.0 : @b;<!-- a\n comment --> float c = @d;\n"
        "<![CDATA[  return a < 1.0 ? c : @lenght(p);]]> /* &#38; */</SDF>"
        "<REGION name='R' type='empty'/></OBJECT></MVV>"}},
      {"E0402 unknown name 'b'", "E0402 unknown name 'd'", "E0402 no function 'lenght'; did you mean 'length'?"});
  check_marked({{"s.voml",
                 "<MVV><OBJECT name='A'><SDF name='S' function='true'>\r\n float a = 1.0;\r\n"
                 "  return a + @bb;\r\n</SDF><REGION name='R' type='empty'/></OBJECT></MVV>"}},
               {"E0402 unknown name 'bb'"});
  const Outcome bom =
      compile({{"s.voml", "\xef\xbb\xbf" + scene_of("return @;").replace(scene_of("return @;").find('@'), 1, "bb")}});
  REQUIRE(bom.messages.size() == 1);
  CHECK(bom.messages[0] == "s.voml:3:49: E0402 unknown name 'bb'");
}

TEST_CASE("an operator that an entity stands for is marked whole") {
  Diagnostics diagnostics;
  const std::string text =
      "<MVV><OBJECT name='A'><SDF name='S' function='true'>return p &lt; 1.0 ? 1.0 : 2.0;</SDF>"
      "<REGION name='R' type='empty'/></OBJECT></MVV>";
  const auto scene = voml::read_scene("s.voml", memory_files({{"s.voml", text}}), {}, diagnostics);
  REQUIRE(scene);
  CHECK_FALSE(compile_snippet(scene->functions.at(0), diagnostics));
  REQUIRE(diagnostics.all().size() == 1);
  const Span span = diagnostics.all()[0].span;
  CHECK(text.substr(span.begin, span.end - span.begin) == "&lt;");
}

TEST_CASE("a mistake in FUNCTIONS is reported there, once, also in an imported file") {
  const std::string sdfs =
      "<OBJECT name='A'><SDF name='S' function='true'>return blob(p);</SDF>"
      "<SDF name='T' function='true'>return blob(p) + @c;</SDF><REGION name='R' type='empty'/>"
      "<MAPPINGS><SDF name='S'><POSITIVE region='R'/><NEGATIVE><SDF name='T'><POSITIVE region='R'/>"
      "<NEGATIVE region='R'/></SDF></NEGATIVE></SDF></MAPPINGS></OBJECT>";
  check_marked(
      {{"s.voml", "<MVV>" + sdfs + "<FUNCTIONS>float blob(vec3 q) {\n return @lenght(q); }</FUNCTIONS></MVV>"}},
      {"E0402 unknown name 'c'", "E0402 no function 'lenght'; did you mean 'length'?"});
  check_marked({{"s.voml", "<MVV><IMPORT file='other.voml'/>" + sdfs + "</MVV>"},
                {"other.voml", "<MVV>\n <FUNCTIONS>float blob(vec3 q) { return q.x + @r; }</FUNCTIONS></MVV>"}},
               {"E0402 unknown name 'c'", "E0402 unknown name 'r'"});
}

TEST_CASE("each text ends for itself: a fault never moves into the next one") {
  check_body("return a;", {"E0401 ',' or ';' is missing here"}, "const float a = 1.0@");
  check_body("return 1.0;", {"E0401 '{' is never closed by '}'"}, "float g() @{ return 1.0;");
}

TEST_CASE("a place in a macro's text is where the macro is used") {
  check_body("#define R lenght(p)\nfloat a = 1.0; return a + @R;",
             {"E0402 no function 'lenght'; did you mean 'length'?"});
}

// ---- hostile text ----

TEST_CASE("text that would take too long or too much is refused, soon") {
  std::string bomb;
  for (int i = 0; i < 40; ++i) bomb += fmt::format("#define a{} a{} a{}\n", i, i + 1, i + 1);
  const auto repeat = [](const std::string& text, int n) {
    std::string result;
    for (int i = 0; i < n; ++i) result += text;
    return result;
  };
  const std::vector<std::string> bodies = {
      bomb + "#define a40 +1.0\nreturn a0;",
      "#define f(x) x+x\nreturn " + repeat("f(", 40) + "1.0" + repeat(")", 40) + ";",
      "return " + repeat("(", 100000) + "1.0" + repeat(")", 100000) + ";",
      "return " + repeat("-", 200000) + "p.x;",
      "return " + repeat("p.x+", 100000) + "1.0;",
      "float a = 0.0; " + repeat("for (int i = 0; i < 2; ++i) ", 5000) + "a += 1.0; return a;",
      "float a = 0.0; " + repeat("if (p.x > 0.0) a = 1.0; else ", 5000) + "a = 2.0; return a;",
      repeat("float a; ", 50000) + "return 1.0;",
      "float a[1000000000]; a[int(p.x)] = 1.0; return a[3];",
      "return 1.0; // " + repeat("x", 1 << 25),
      "#define f(x) f2(x x)\n#define f2(x) f3(x x)\n#define f3(x) x x\n" + repeat("f(", 30) + "1.0" + repeat(")", 30),
      repeat("#if 1\n", 100000) + "return 1.0;\n" + repeat("#endif\n", 99999),
      "#if " + repeat("(", 100000) + "1" + repeat(")", 100000) + "\n#endif\nreturn 1.0;",
      "#if " + repeat("!", 100000) + "1\n#endif\nreturn 1.0;",
      "#define m(x) x##x\n#define n(x) m(x)\nreturn " + repeat("n(", 30) + "1" + repeat(")", 30) + ";",
  };
  for (const std::string& body : bodies) {
    CAPTURE(body.substr(0, 80));
    const std::clock_t begin = std::clock();  // of this process: other programs on the machine do not count
    const Outcome outcome = compile({{"s.voml", scene_of(body)}});
    CHECK(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC < (is_sanitized ? 60.0 : 10.0));
    CHECK(outcome.messages.size() == 1);
    CHECK_FALSE(outcome.snippets.at(0).has_value());
  }
}

TEST_CASE("nesting that is allowed compiles") {
  const auto repeat = [](const std::string& text, int n) {
    std::string result;
    for (int i = 0; i < n; ++i) result += text;
    return result;
  };
  CHECK(value_of("return " + repeat("(", 99) + "1.0" + repeat(")", 99) + ";") == 1.0);
  CHECK(value_of("return " + repeat("1.0+", 900) + "1.0;") == 901.0);
  CHECK(value_of("float a = 0.0; " + repeat("if (p.x > 0.3) a = 1.0; else ", 48) + "a = 2.0; return a;") == 2.0);
}

TEST_CASE("any bytes are compiled or refused, never worse") {
  const std::string alphabet = "pt.xyz(){}[];,+-*/<>=!?: \n#01e\"@'\\float vec3 return if for while define include sdf";
  std::uint32_t state = 1;
  const auto next = [&] { return state = state * 1664525u + 1013904223u; };
  for (int i = 0; i < 400; ++i) {
    std::string body = "x";
    for (std::uint32_t n = next() >> 26; n-- > 0;) body += alphabet[(next() >> 8) % alphabet.size()];
    voml::Function function;
    function.body.text = body;
    Diagnostics diagnostics;
    const auto snippet = compile_snippet(function, diagnostics);
    CAPTURE(body);
    CHECK(snippet.has_value() == !diagnostics.has_errors());
  }
}
