// Names in the functions of a scene: they are the author's, and belong to the file that defines them.
#include <set>
#include <string>
#include <vector>

#include "compiling.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

/// GLSL 4.60, chapter 8: all functions but those that a vertex shader does not have.
const std::vector<std::string> built_ins = {"radians",
                                            "degrees",
                                            "sin",
                                            "cos",
                                            "tan",
                                            "asin",
                                            "acos",
                                            "atan",
                                            "sinh",
                                            "cosh",
                                            "tanh",
                                            "asinh",
                                            "acosh",
                                            "atanh",
                                            "pow",
                                            "exp",
                                            "log",
                                            "exp2",
                                            "log2",
                                            "sqrt",
                                            "inversesqrt",
                                            "abs",
                                            "sign",
                                            "floor",
                                            "trunc",
                                            "round",
                                            "roundEven",
                                            "ceil",
                                            "fract",
                                            "mod",
                                            "modf",
                                            "min",
                                            "max",
                                            "clamp",
                                            "mix",
                                            "step",
                                            "smoothstep",
                                            "isnan",
                                            "isinf",
                                            "floatBitsToInt",
                                            "floatBitsToUint",
                                            "intBitsToFloat",
                                            "uintBitsToFloat",
                                            "fma",
                                            "frexp",
                                            "ldexp",
                                            "packUnorm2x16",
                                            "packSnorm2x16",
                                            "packUnorm4x8",
                                            "packSnorm4x8",
                                            "unpackUnorm2x16",
                                            "unpackSnorm2x16",
                                            "unpackUnorm4x8",
                                            "unpackSnorm4x8",
                                            "packHalf2x16",
                                            "unpackHalf2x16",
                                            "packDouble2x32",
                                            "unpackDouble2x32",
                                            "length",
                                            "distance",
                                            "dot",
                                            "cross",
                                            "normalize",
                                            "ftransform",
                                            "faceforward",
                                            "reflect",
                                            "refract",
                                            "matrixCompMult",
                                            "outerProduct",
                                            "transpose",
                                            "determinant",
                                            "inverse",
                                            "lessThan",
                                            "lessThanEqual",
                                            "greaterThan",
                                            "greaterThanEqual",
                                            "equal",
                                            "notEqual",
                                            "any",
                                            "all",
                                            "not",
                                            "uaddCarry",
                                            "usubBorrow",
                                            "umulExtended",
                                            "imulExtended",
                                            "bitfieldExtract",
                                            "bitfieldInsert",
                                            "bitfieldReverse",
                                            "bitCount",
                                            "findLSB",
                                            "findMSB",
                                            "textureSize",
                                            "textureQueryLod",
                                            "textureQueryLevels",
                                            "textureSamples",
                                            "texture",
                                            "textureProj",
                                            "textureLod",
                                            "textureOffset",
                                            "texelFetch",
                                            "texelFetchOffset",
                                            "textureProjOffset",
                                            "textureLodOffset",
                                            "textureProjLod",
                                            "textureProjLodOffset",
                                            "textureGrad",
                                            "textureGradOffset",
                                            "textureProjGrad",
                                            "textureProjGradOffset",
                                            "textureGather",
                                            "textureGatherOffset",
                                            "textureGatherOffsets",
                                            "atomicCounterIncrement",
                                            "atomicCounterDecrement",
                                            "atomicCounter",
                                            "atomicAdd",
                                            "atomicMin",
                                            "atomicMax",
                                            "atomicAnd",
                                            "atomicOr",
                                            "atomicXor",
                                            "atomicExchange",
                                            "atomicCompSwap",
                                            "imageSize",
                                            "imageSamples",
                                            "imageLoad",
                                            "imageStore",
                                            "imageAtomicAdd",
                                            "dFdx",
                                            "dFdy",
                                            "dFdxFine",
                                            "dFdyFine",
                                            "dFdxCoarse",
                                            "dFdyCoarse",
                                            "fwidth",
                                            "fwidthFine",
                                            "fwidthCoarse",
                                            "interpolateAtCentroid",
                                            "interpolateAtSample",
                                            "interpolateAtOffset",
                                            "noise1",
                                            "noise2",
                                            "noise3",
                                            "noise4",
                                            "EmitStreamVertex",
                                            "EndStreamPrimitive",
                                            "EmitVertex",
                                            "EndPrimitive",
                                            "barrier",
                                            "memoryBarrier",
                                            "memoryBarrierAtomicCounter",
                                            "memoryBarrierBuffer",
                                            "memoryBarrierShared",
                                            "memoryBarrierImage",
                                            "groupMemoryBarrier",
                                            "subpassLoad",
                                            "anyInvocation",
                                            "allInvocations",
                                            "allInvocationsEqual",
                                            "max3",
                                            "min3",
                                            "mid3",
                                            "texture2D",
                                            "texture3D",
                                            "textureCube",
                                            "shadow2D",
                                            "lerp",
                                            "saturate",
                                            "frac",
                                            "mul",
                                            "main",
                                            "f",
                                            "p",
                                            "t",
                                            "sd_sphere",
                                            "op_union",
                                            "sampler",
                                            "demote",
                                            "ballotARB",
                                            "timeAMD"};

const std::string analytic_region = "<REGION name='R' type='color' rgb='1 0 0'/></OBJECT>";

std::string object(const std::string& name, const std::string& body, const std::string& functions = "") {
  const std::string block = functions.empty() ? "" : "<FUNCTIONS><![CDATA[" + functions + "]]></FUNCTIONS>";
  return "<OBJECT name='" + name + "'>" + block + "<SDF name='S' function='true'><![CDATA[" + body + "]]></SDF>" +
         analytic_region;
}

std::string functions(const std::string& text) { return "<FUNCTIONS><![CDATA[" + text + "]]></FUNCTIONS>"; }

/// The values of all functions of a scene at a point, in the order of the document.
std::vector<double> values_of(const std::map<std::string, std::string>& files, glm::dvec3 p = {0.25, -0.5, 0.75}) {
  const Outcome outcome = compile(files);
  CHECK(outcome.messages == std::vector<std::string>{});
  std::vector<double> values;
  for (const auto& snippet : outcome.snippets) {
    REQUIRE(snippet);
    values.push_back(snippet->evaluate(p, 0.0).f);
  }
  return values;
}

using Values = std::vector<double>;

/// What is said of a scene, notes and all.
std::string said_of(const std::map<std::string, std::string>& files) {
  Diagnostics diagnostics;
  const auto scene = voml::read_scene("s.voml", memory_files(files), {}, diagnostics);
  if (scene) {
    for (const voml::Function& function : scene->functions) compile_snippet(function, diagnostics);
  }
  std::string result;
  for (const Diagnostic& d : diagnostics.all()) {
    const LineColumn at = diagnostics.locate(d.span.source, d.span.begin);
    result += fmt::format("{}:{}:{}: {} {}\n", diagnostics.source_name(d.span.source), at.line, at.column,
                          info(d.code).number, d.message);
    for (const Note& note : d.notes) {
      const LineColumn there = diagnostics.locate(note.span.source, note.span.begin);
      result += fmt::format("  {}:{}:{}: {}\n", diagnostics.source_name(note.span.source), there.line, there.column,
                            note.message);
    }
  }
  return result;
}

}  // namespace

// ---- names of GLSL and of the library ----

TEST_CASE("a function, variable or macro may have the name of any function of GLSL") {
  for (const std::string& name : built_ins) {
    CAPTURE(name);
    const bool is_parameter = name == "p" || name == "t";  // of the body
    const std::string head = "float " + name + "(float x, float y, float z) { return x + 2.0 * y + 3.0 * z; }\n";
    const std::string one = "float " + name + "(float x) { return x + 1.0; }\n";
    const std::string two = "vec2 " + name + "(vec2 x, vec2 y) { return x - y; }\n";
    if (!is_parameter) {
      CHECK(value_of("return " + name + "(1.0, 2.0, 3.0);", {}, head) == 14.0);
      CHECK(value_of("return " + name + "(1.0);", {}, one) == 2.0);
      CHECK(value_of("return " + name + "(p.xy, p.yz).x + " + name + "(2.0);", {1, 2, 3}, one + two) == 2.0);
      CHECK(value_of("float " + name + " = 3.0; return " + name + " + 1.0;") == 4.0);
      CHECK(value_of("return " + name + ";", {}, "const float " + name + " = 6.0;") == 6.0);
      const std::string field = name == "length" ? "size" : name;  // `a.length` is glslang's, of arrays
      CHECK(value_of(name + " a; a." + field + " = 2.0; return a." + field + ";", {},
                     "struct " + name + " { float " + field + "; };") == 2.0);
    }
    CHECK(value_of("return g();", {}, "float g() { float " + name + " = 3.0; return " + name + "; }") == 3.0);
    CHECK(value_of("return g(5.0);", {}, "float g(float " + name + ") { return " + name + "; }") == 5.0);
    CHECK(value_of("#define " + name + "(x) ((x) + 7.0)\nreturn " + name + "(1.0);") == 8.0);
    CHECK(value_of("return g();", {}, "#define " + name + " 4.0\nfloat g() { return " + name + "; }") == 4.0);
  }
}

TEST_CASE("what GLSL defines under a name stays beside what the author defines for other parameters") {
  CHECK(value_of("return max(vec3(1.0, 3.0, 2.0)) + max(4.0, 5.0);", {},
                 "float max(vec3 v) { return max(v.x, max(v.y, v.z)); }") == 8.0);
  CHECK(value_of("return tanh(2.0) + tanh(vec2(0.0)).x + mod(vec2(5.5), 2.0).y;", {},
                 "float tanh(float x) { return x * 10.0; }\n"
                 "float mod(float a, float b) { return 100.0; }") == 21.5);
  CHECK(value_of("float i; return modf(2.5, i) + i + round(0.4);", {},
                 "float round(float x) { return 8.0; }\n"
                 "vec2 modf(vec2 a, out vec2 b) { b = a; return a; }") == 10.5);
  CHECK(value_of("return smoothstep(0.0, 1.0, 0.5) + smoothstep(0.0, 2.0, vec2(1.0)).x;", {},
                 "float smoothstep(float a, float b, float x) { return clamp((x - a) / (b - a), 0.0, 1.0) + 3.0; }") ==
        4.0);
  CHECK(value_of("return transpose(mat2(1.0, 2.0, 3.0, 4.0))[0].y + determinant(inverse(mat3(2.0)));", {},
                 "mat2 transpose(mat2 m) { return m; }\nmat3 inverse(mat3 m) { return mat3(3.0); }") == 29.0);
}

TEST_CASE("the library's names may be defined anew") {
  CHECK(value_of("return sd_sphere(p, 0.5) + sd_box(p, vec3(1.0)) * 0.0;", {},
                 "#include <sdf>\nfloat sd_sphere(vec3 p, float r) { return 42.0; }") == 42.0);
  CHECK(value_of("#include <sdf>\nreturn sd_round_box(vec3(3.0, 0.0, 0.0), vec3(1.0), 0.25);", {},
                 "float sd_box(vec3 p, vec3 b) { return 42.0; }") ==
        doctest::Approx(2.0));  // the library's calls stay its own
  CHECK(value_of("#include <sdf>\nreturn sd_sphere(vec2(3.0, 4.0), 1.0) + sd_sphere(p, 0.0);", {0, 2, 0},
                 "float sd_sphere(vec2 p, float r) { return length(p) - r; }") == 6.0);
  CHECK(
      value_of("#include <sdf>\nfloat sd_sphere = 2.0; return sd_sphere + sd_torus(vec3(1.0, 0.0, 0.0), 1.0, 0.0);") ==
      2.0);
}

TEST_CASE("reserved words are refused, in one wording, once") {
  for (const char* word :
       {"float",   "vec3",        "mat2x3",    "if",        "for",           "return",     "struct",  "const",
        "in",      "true",        "discard",   "uniform",   "buffer",        "shared",     "layout",  "flat",
        "smooth",  "sample",      "patch",     "precise",   "highp",         "double",     "dvec2",   "sampler2D",
        "image3D", "atomic_uint", "common",    "partition", "active",        "asm",        "class",   "union",
        "enum",    "typedef",     "template",  "this",      "resource",      "goto",       "inline",  "noinline",
        "public",  "static",      "extern",    "external",  "interface",     "long",       "short",   "half",
        "fixed",   "unsigned",    "superp",    "input",     "output",        "hvec2",      "fvec4",   "filter",
        "sizeof",  "cast",        "namespace", "using",     "sampler3DRect", "subroutine", "varying", "attribute",
        "dmvv_x",  "gl_x"}) {
    CAPTURE(word);
    const std::string keeper = std::string(word).starts_with("dmvv_") ? "the compiler" : "GLSL";
    const std::string message =
        fmt::format("E0401 '{}' is a word that {} keeps for itself; take another name", word, keeper);
    check_body(fmt::format("float @{0} = 1.0; return {0};", word), {message});
    check_body("return 1.0;", {message}, fmt::format("float @{0}(float x) {{ return x; }}", word));
  }
}

// ---- files ----

TEST_CASE("files that are fine alone are fine together, whatever they call things") {
  const std::string cell = functions("float hash(float n) { return n * 2.0; }") + object("CELL", "return hash(p.x);");
  const std::string fibre = functions("float hash(float n) { return n * 3.0; }") + object("FIBRE", "return hash(p.x);");
  CHECK(values_of(
            {{"s.voml", "<MVV><IMPORT file='a.voml'/><IMPORT file='b.voml'/>" + object("T", "return p.y;") + "</MVV>"},
             {"a.voml", "<MVV>" + cell + "</MVV>"},
             {"b.voml", "<MVV>" + fibre + "</MVV>"}},
            {1, 2, 3}) == Values{2, 3, 2});
  // each text of `all` means its own in a file of its own, in either order
  const std::vector<std::pair<std::string, double>> all = {
      {"float g(float x) { return 1.0; } |return g(0.0);", 1},
      {"const float g = 2.0; |return g;", 2},
      {"struct g { float a; }; |g s = g(3.0); return s.a;", 3},
      {"#define g(x) 4.0\n|return g(0.0);", 4},
      {"#define g 5.0\n|return g;", 5},
      {"#define g\n|\n#ifdef g\nreturn 6.0;\n#endif", 6},
      {"float g(vec2 x) { return 7.0; } |return g(vec2(0.0));", 7},
      {"float h(float g) { return g; } |return h(8.0);", 8},
      {"|float g = 9.0; return g;", 9},
      {"struct A { float g; }; A make() { A a; a.g = 10.0; return a; } |return make().g;", 10},
      {"float g(float x, float y) { return 11.0; } float g(float x) { return 12.0; }|return g(0.0);", 12},
      {"float abs(float x) { return 13.0; } |return abs(-1.0);", 13},
      {"|return abs(-14.0);", 14},
      {"float frac(float x) { return 15.0; } |return frac(0.5);", 15},
      {"|return frac(0.5);", 0.5},
      {"#define float vec2\n|return length(float(16.0, 0.0));", 16}};
  for (const auto& one : all) {
    for (const auto& other : all) {
      const auto& first = one.first;
      const auto& second = other.first;
      const auto first_value = one.second, second_value = other.second;
      CAPTURE(first);
      CAPTURE(second);
      const auto file = [](const std::string& text, const std::string& name) {
        const std::size_t at = text.find('|');
        const std::string helpers = text.substr(0, at), body = text.substr(at + 1);
        return "<MVV>" + (helpers.empty() ? "" : functions(helpers)) + object(name, body) + "</MVV>";
      };
      CHECK(values_of({{"s.voml",
                        "<MVV><IMPORT file='a.voml'/><IMPORT file='b.voml'/>" + object("T", "return 0.0;") + "</MVV>"},
                       {"a.voml", file(first, "A")},
                       {"b.voml", file(second, "B")}}) == Values{first_value, second_value, 0});
    }
  }
}

TEST_CASE("what a file defines hides what it imports, and an object's what its file defines") {
  const std::string base =
      functions("float g(float x) { return 1.0; } float g(vec2 x) { return 2.0; }\n#define M 1.0\n");
  const std::map<std::string, std::string> files = {
      {"base.voml", "<MVV>" + base + object("BASE", "return g(0.0) + M;") + "</MVV>"},
      {"s.voml",
       "<MVV><IMPORT file='base.voml'/>" + functions("float g(float x) { return 10.0; }\n#define M 5.0\n") +
           object("A", "return g(0.0) + g(vec2(0.0)) + M;") +
           object("B", "return g(0.0) + g(vec2(0.0)) + M;", "float g(float x) { return 100.0; }\n#define M 7.0\n") +
           object("C", "#define M 9.0\nfloat g = 3.0; return g + M;") + "</MVV>"}};
  CHECK(values_of(files) == Values{2, 17, 109, 12});
}

TEST_CASE("a file sees what it imports, through others as well, and what both imports import") {
  const std::map<std::string, std::string> files = {
      {"base.voml",
       "<MVV>" +
           functions("float g(float x) { return x + 1.0; }\n#define TWICE(x) ((x) * 2.0)\nstruct P { float a; };") +
           "</MVV>"},
      {"a.voml", "<MVV><IMPORT file='base.voml'/>" + functions("float ga(float x) { return g(x) + 10.0; }") + "</MVV>"},
      {"b.voml", "<MVV><IMPORT file='base.voml'/>" +
                     functions("float g(float x) { return TWICE(x); } P gb(float x) { return P(g(x)); }") +
                     object("B", "return gb(3.0).a;") + "</MVV>"},
      {"only.voml", "<MVV><IMPORT file='a.voml'/></MVV>"},
      {"s.voml", "<MVV><IMPORT file='only.voml'/><IMPORT file='b.voml'/>" +
                     object("S", "P s = P(1.0); return ga(TWICE(2.0)) + gb(1.0).a + s.a + g(3.0);") + "</MVV>"}};
  CHECK(values_of(files) == Values{6, 15 + 2 + 1 + 6});  // g is b's, which imports base's
}

TEST_CASE("functions with other parameters are overloads, wherever they stand") {
  const std::map<std::string, std::string> files = {
      {"a.voml", "<MVV>" + functions("float g(float x) { return 1.0; }") + object("A", "return g(1);") + "</MVV>"},
      {"b.voml", "<MVV>" + functions("float g(int x) { return 2.0; }") + object("B", "return g(1);") + "</MVV>"},
      {"s.voml", "<MVV><IMPORT file='b.voml'/><IMPORT file='a.voml'/>" +
                     functions("vec2 g(inout vec2 x[2]) { x[1] = vec2(3.0); return x[1]; }") +
                     object("S", "vec2 x[2]; return g(1) + g(1.0) + g(x).x + x[1].y;") + "</MVV>"}};
  CHECK(values_of(files) == Values{2, 1, 9});
}

TEST_CASE("E0411: a name of two imports is a fault where it is used, and names both places") {
  const std::string a =
      "<MVV>" + functions("float g(float x) { return 1.0; }\n#define M 1.0\n#define N 1.0\n") + "</MVV>";
  const std::string b =
      "<MVV>" + functions("float g(float x) { return 2.0; }\n#define M 2.0\nconst float N = 2.0;\n") + "</MVV>";
  const auto scene = [&](const std::string& body, const std::string& own = "") {
    return std::map<std::string, std::string>{
        {"a.voml", a},
        {"b.voml", b},
        {"s.voml", "<MVV><IMPORT file='a.voml'/><IMPORT file='b.voml'/>" + (own.empty() ? "" : functions(own)) + "\n" +
                       object("S", body) + "</MVV>"}};
  };
  CHECK(said_of(scene("\nreturn g(1.0);")) ==
        "s.voml:3:8: E0411 'g' is defined in two files that are imported here, and neither imports the other; define "
        "it here as "
        "well, or give one of them another name\n"
        "  a.voml:1:32: it is defined here\n  b.voml:1:32: and here\n");
  const std::string means =
      "means different things in the files that are imported here, at least once a macro; '#undef ";
  CHECK(said_of(scene("\nreturn M;")) == "s.voml:3:8: E0411 'M' " + means +
                                             "M' or define it here, or give one another name\n"
                                             "  a.voml:2:9: it is defined here\n  b.voml:2:9: and here\n");
  CHECK(said_of(scene("\nreturn N;")) == "s.voml:3:8: E0411 'N' " + means +
                                             "N' or define it here, or give one another name\n"
                                             "  a.voml:3:9: it is defined here\n  b.voml:3:13: and here\n");
  CHECK(said_of(scene("return p.x;")).empty());
  CHECK(values_of(scene("float g = 3.0; return g;")) == Values{3});  // a variable of the text
  CHECK(values_of(scene("return g(1.0) + M + N;",
                        "float g(float x) { return 4.0; }\n#define M 5.0\nconst float N = 6.0;")) == Values{15});
  CHECK(values_of(scene("#undef M\nfloat M = 7.0; return M;")) == Values{7});
}

TEST_CASE("a file does not see what its importers define") {
  const std::map<std::string, std::string> files = {
      {"a.voml", "<MVV>" + functions("float h() { return\n g(); }") + "</MVV>"},
      {"s.voml", "<MVV>" + functions("float g() { return 1.0; }") + "<IMPORT file='a.voml'/>" +
                     object("S", "return h();") + "</MVV>"}};
  CHECK(said_of(files) ==
        "a.voml:2:2: E0402 'g' is defined in a file that this one does not import; import it, or move the definition\n"
        "  s.voml:1:32: it is defined here\n");
}

// ---- messages ----

TEST_CASE("use before definition") {
  check_body(
      "return a(p);",
      {"E0402 'b' is defined further down, and a function stands before its use; move it up, or declare it before: "
       "'float b(vec3 p, const float r[2]);'"},
      "float a(vec3 p) { float r[2]; return @b(p, r); }\nfloat b(vec3 p, const float r[2]) { return length(p) - 0.5; "
      "}");
  check_body("return a(p);", {"E0402 'k' is defined further down, and stands before its use in GLSL; move it up"},
             "float a(vec3 p) { return p.x + @k; }\nconst float k = 0.5;");
  check_body("return a(p);", {"E0402 the macro 'K' is defined further down, and holds from there on; move it up"},
             "float a(vec3 p) { return p.x + @K; }\n#define K 0.5\n");
  CHECK(value_of("return a(p);", {1, 2, 3},
                 "float b(vec3 p);\nfloat a(vec3 p) { return b(p); }\nfloat b(vec3 p) { return p.z; }") == 3.0);
}

TEST_CASE("what only the text of an SDF knows") {
  check_body(
      "return a(p);",
      {"E0402 't' is known in the text of an SDF alone; a function of FUNCTIONS gets it as a parameter: 'float t'"},
      "#define iTime (t / 1000.0)\nfloat a(vec3 p) { return length(p) - 0.5 + 0.1 * sin(@iTime); }");
  check_body(
      "return a(1.0);",
      {"E0402 'p' is known in the text of an SDF alone; a function of FUNCTIONS gets it as a parameter: 'vec3 p'"},
      "float a(float r) { return length(@p) - r; }");
}

TEST_CASE("defined twice: both places, no consequences") {
  const auto said = [](const std::string& text, const std::string& body) {
    return said_of({{"s.voml", "<MVV><FUNCTIONS>\n" + text + "\n</FUNCTIONS>\n" + object("S", body) + "</MVV>"}});
  };
  CHECK(said("float g(float x) { return 1.0; }\nvoid h() {}\nfloat g(float y) { if (y > 1.0) return y; return 2.0; }",
             "return g(1.0);") ==
        "s.voml:4:7: E0401 the function 'g' is defined twice; take one away, or give it another name\n"
        "  s.voml:2:7: it is defined here\n");
  CHECK(said("float g(float x) { return 1.0; }\nvec2 g(float y) { return vec2(2.0); }", "return g(1.0);") ==
        "s.voml:3:6: E0401 'g' is defined before, with the same parameters and another type of result; take one away, "
        "or give it "
        "another name\n  s.voml:2:7: it is defined here\n");
  CHECK(said("const float k = 1.0;\nconst float k = 2.0;", "return k;") ==
        "s.voml:3:13: E0401 'k' is defined twice; take one away, or give it another name\n  s.voml:2:13: it is defined "
        "here\n");
  CHECK(said("struct A { float a; };\nstruct A { float b; };", "return 1.0;") ==
        "s.voml:3:8: E0401 'A' is defined twice; take one away, or give it another name\n  s.voml:2:8: it is defined "
        "here\n");
  CHECK(said("#define K 1.0\n#define K 2.0", "return K;") ==
        "s.voml:3:9: E0401 the macro 'K' is defined twice, and not the same; '#undef K' before, or another name\n"
        "  s.voml:2:9: it is defined here\n");
  CHECK(said("const float k = 1.0;", "{ float a = 1.0; }\nfloat a = 1.0;\nfloat a = 2.0; return a;") ==
        "s.voml:6:7: E0401 'a' is defined twice; take one away, or give it another name\n  s.voml:5:7: it is defined "
        "here\n");
  check_body("float @p = 1.0; return p;",
             {"E0401 'p' is what the function is given; assign to it, or take another name"});
}

TEST_CASE("what XML does not replace within CDATA") {
  check_body("if (p.x @&lt; 0.5) return 1.0; return 2.0;",
             {"E0401 '&lt;' stands for '<' outside of CDATA alone; here write '<'"});
  check_body("return p.x > 0.0 @&amp;&amp; p.y > 0.0 ? 1.0 : 2.0;",
             {"E0401 '&amp;' stands for '&' outside of CDATA alone; here write '&'"});
  CHECK(value_of("int lt = 3; int a = 6 &lt; return float(a);") == 2.0);  // the author's own
}
