// The preprocessor of GLSL in the functions of a scene: values are those of GLSL 4.60, section 3.3, and of C, which it
// refers to.
#include <chrono>
#include <string>
#include <vector>

#include "compiling.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

/// Whether a condition holds.
bool holds(const std::string& condition, const std::string& before = "") {
  return value_of(before + "\n#if " + condition + "\nreturn 1.0;\n#else\nreturn 0.0;\n#endif\n") == 1.0;
}

}  // namespace

TEST_CASE("conditions compute with whole numbers, by the precedence of C") {
  for (const std::string condition : {"1",
                                      "2 - 1",
                                      "1 + 2 * 3 == 7",
                                      "(1 + 2) * 3 == 9",
                                      "10 - 4 - 3 == 3",
                                      "100 / 10 / 5 == 2",
                                      "-7 / 2 == -3",
                                      "-7 % 3 == -1",
                                      "7 % -3 == 1",
                                      "1 << 2 + 1 == 8",
                                      "1 << 3 >> 1 == 4",
                                      "-8 >> 1 == -4",
                                      "1 < 2 == 1",
                                      "3 > 2 && 2 >= 2",
                                      "(6 & 3) == 2",
                                      "(6 | 3) == 7",
                                      "(6 ^ 3) == 5",
                                      "~0 == -1",
                                      "!0",
                                      "!!5",
                                      "- - 1 == 1",
                                      "-+-+1 == 1",
                                      "0x1F == 31",
                                      "0XfF == 255",
                                      "017 == 15",
                                      "12u == 12",
                                      "0 || 1 && 1",
                                      "1 || 0 && 0",
                                      "1 | 2 ^ 2 & 0",
                                      "!defined X && !defined(X)",
                                      "0 && NOTHING || 1",
                                      "1 || NOTHING",
                                      "0 && 1 / 0 || 1",
                                      "0x7fffffff + 1 > 0",
                                      "1 // why\n",
                                      "1 /* a\n b */",
                                      "__VERSION__ == 460",
                                      "GL_core_profile",
                                      "defined GL_core_profile && !defined(GL_ES)",
                                      "defined(__LINE__)",
                                      "1 + \\\n 1 == 2"}) {
    CAPTURE(condition);
    CHECK(holds(condition));
  }
  for (const std::string condition :
       {"0", "1 - 1", "2 == 3", "6 & 3 == 3", "!1", "1 && 0", "0 || 0", "3 < 2", "~0 == 1", "8 >> 4"}) {
    CAPTURE(condition);
    CHECK_FALSE(holds(condition));
  }
}

TEST_CASE("macros count in conditions, also those that ask themselves") {
  CHECK(holds("A == 6", "#define B 2\n#define A (B * 3)"));
  CHECK(holds("MORE(3, 2)", "#define MORE(a, b) ((a) > (b))"));
  CHECK(holds("HAS", "#define X\n#define HAS defined(X)"));
  CHECK(holds("defined X && !defined(Y)", "#define X 0\n#define Y\n#undef Y"));
  CHECK(holds("CAT(1, 2) == 12", "#define CAT(a, b) a##b"));
}

TEST_CASE("one branch of a condition counts, also with conditions in what is skipped") {
  const std::string text =
      "#if A == 1\nreturn 1.0;\n#elif A == 2\nreturn 2.0;\n#elif A == 2 || A == 3\nreturn 3.0;\n#else\nreturn "
      "4.0;\n#endif\n";
  for (int a = 1; a <= 4; ++a) CHECK(value_of(fmt::format("#define A {}\n", a) + text) == a);
  CHECK(value_of("#if 0\n#if 1\n (\n#elif nonsense (\n#else\n ]\n#endif\n#ifdef X\n#else\n#endif\n#else\nreturn "
                 "5.0;\n#endif") == 5.0);
  CHECK(value_of("#if 1\nreturn 1.0;\n#elif 1 / 0\n#elif\n#else\n nonsense\n#endif") == 1.0);  // not asked any more
  CHECK(value_of("#ifdef A\n#version 330\n#error no\n#include <stdio>\n#endif\nreturn 2.0;") == 2.0);
  CHECK(value_of("#if 1\n#if 0\n#else\nreturn 3.0;\n#endif\n#endif") == 3.0);
  CHECK(value_of("  #  if 1 /* blanks */\nreturn 1.0;\n # endif // done") == 1.0);
}

TEST_CASE("macros expand as in C") {
  CHECK(value_of("#define F(x) ((x) * 2.0)\n#define G F\nreturn G(3.0) + G (1.0);") ==
        8.0);  // a name made before its '('
  CHECK(value_of("#define F(a, b) (a - b)\nreturn F(\n  5.0,\n  F(3.0,\n 1.0)\n);") == 3.0);
  CHECK(value_of("#define TWO(a, b) a b\nreturn TWO(, -) 1.0 TWO(+, ) 3.0;") == 2.0);  // empty arguments
  CHECK(value_of("#define NONE() 4.0\n#define ONE(x) x 5.0\nreturn NONE() + NONE( ) + ONE();") == 13.0);
  CHECK(value_of("#define F(x) x\nfloat F = 2.0; return F + F(3.0);") == 5.0);  // without '(' a name
  CHECK(value_of("#define f(x) (x + f)\nfloat f = 1.0; return f(f(2.0));") == 4.0);
  CHECK(value_of("#define A B\n#define B A\nfloat A = 3.0; return A;") == 3.0);
  CHECK(value_of("#define foo(x) bar x\n#define bar(x) (x + 1.0)\nreturn foo((2.0));") == 3.0);
  CHECK(value_of("#define ID(x) x\nreturn ID((1.0, 2.0)) + ID(vec2(3.0, 4.0).y);") == 6.0);
  CHECK(value_of("#define P max(1.0,\nreturn P 2.0);") == 2.0);
  CHECK(value_of("#define M 1.0\n#undef M\n#undef M\n#define M 2.0\nreturn M;") == 2.0);
  CHECK(value_of("#define M 1.0 + 1.0\n#define M  1.0 /* the same */ + 1.0\nreturn M;") == 2.0);
  CHECK(value_of("#define ARG(x) x\nreturn ARG(\n#ifdef Q\n 1.0\n#else\n 2.0\n#endif\n);") == 2.0);
}

TEST_CASE("'##' joins words, arguments as they are") {
  CHECK(value_of("#define CAT(a, b) a##b\nfloat xy = 2.0; return CAT(x, y);") == 2.0);
  CHECK(value_of("#define CAT(a, b) a ## b\n#define x z\nfloat xy = 2.0; return CAT(x, y);") == 2.0);
  CHECK(value_of(
            "#define CAT(a, b) a##b\n#define XCAT(a, b) CAT(a, b)\n#define x z\nfloat zy = 3.0; return XCAT(x, y);") ==
        3.0);
  CHECK(value_of("#define V(n) vec##n\nreturn V(2)(4.0).y;") == 4.0);
  CHECK(value_of("#define C3(a, b, c) a##b##c\nfloat ac = 5.0; return C3(a, , c);") == 5.0);
  CHECK(value_of("#define N(a) 1##a\nreturn N(.5) + float(N(2));") == 13.5);
  CHECK(value_of("#define LE <##=\nreturn 1.0 LE 2.0 ? 1.0 : 0.0;") == 1.0);
  CHECK(value_of("#define CAT(a, b) a##b\n#define AB 6.0\nreturn CAT(A, B);") == 6.0);  // what is made is expanded
}

TEST_CASE("a backslash at the end of a line joins it with the next, within words and comments as well") {
  CHECK(value_of("flo\\\nat a\\\nb = 2.0; return ab;") == 2.0);
  CHECK(value_of("float a = 1.0; // a comment \\\n a = 2.0;\nreturn a;") == 1.0);
  CHECK(value_of("#define A 1.0 \\\n + 2.0\nreturn A;") == 3.0);
  CHECK(value_of("float a = 1.0; a +\\\n= 2.0; return a;") == 3.0);
  check_body("float a = 1.0; \\\nreturn @b;", {"E0402 unknown name 'b'"});
  check_body("float a = 1.0; ret\\\nurn @b\\\nc;", {"E0402 unknown name 'bc'"});
}

TEST_CASE("macros that GLSL defines") {
  CHECK(value_of("return float(__VERSION__);") == 460.0);
  CHECK(value_of("return float(__LINE__);") == 1.0);
  CHECK(value_of("\n\n#define L __LINE__\n\\\nreturn float(L);") == 5.0);
  CHECK(value_of("return float(__FILE__);") == 0.0);
  CHECK(value_of("return float(__FILE__);", {}, "float g(vec3 p) { return 1.0; }") == 1.0);
  CHECK(value_of("#ifdef GL_ES\nprecision mediump float;\n#endif\nreturn float(GL_FRAGMENT_PRECISION_HIGH);") == 1.0);
}

TEST_CASE("a directive is obeyed, or is one error at its place") {
  const auto both = [](const std::string& body, const std::string& message) {
    check_body(body + "\nreturn 1.0;", {message});
    check_body("return g();", {message}, body + "\nfloat g() { return 1.0; }");
  };
  both("#@elsif 1", "E0401 '#elsif' is no directive; did you mean '#elif'?");
  both("#if 0\n#@elseif 1\n#endif", "E0401 '#elseif' is no directive; did you mean '#elif'?");
  both("#if 0\n#@elifdef A\n#endif", "E0401 '#elifdef' is no directive; write '#elif defined(NAME)'");
  both("#if 0\n#@esle\n#endif", "E0401 '#esle' is no directive; did you mean '#else'?");
  both("#@defin A", "E0401 '#defin' is no directive; did you mean '#define'?");
  both("#@elif 1", "E0401 there is no #if that this #elif could belong to");
  both("#@else", "E0401 there is no #if that this #else could belong to");
  both("#@if 1\n", "E0401 this #if has no #endif");
  both("#if 1\n#else\n#@else\n#endif", "E0401 this #else stands behind the #else of its condition");
  both("#if 1\n#else\n#@elif 1\n#endif", "E0401 this #elif stands behind the #else of its condition");
  both("#ifdef A @B\n#endif", "E0401 '#ifdef' ends before 'B'; what follows it stands on the next line");
  both("#if 1\n#else @A\n#endif", "E0401 '#else' ends before 'A'; what follows it stands on the next line");
  both("#@ifdef\n#endif", "E0401 '#ifdef' needs the name of a macro");
  both("#undef @3", "E0401 '#undef' needs the name of a macro");
  both("#@if\nnonsense (\n#endif", "E0401 '#if' needs a condition");
  both("#@define", "E0401 #define needs a name");
  both("#error @write your own radius first", "E0410 write your own radius first");
  both("#ifndef RADIUS\n#error @RADIUS: don't forget\n#endif", "E0410 RADIUS: don't forget");
  both("#pragma @STDGL invariant(all)",
       "E0404 this #pragma is not known, so it could not be obeyed; 'once', 'optimize(on)' and 'debug(on)' are (and "
       "'off'): leave "
       "it out");
  CHECK(value_of("#pragma once\n#pragma optimize(off)\n#pragma debug(on)\n#\nreturn 1.0;") == 1.0);
}

TEST_CASE("conditions that cannot be answered are one error; no branch counts") {
  const auto wrong = [](const std::string& condition, const std::string& message) {
    check_body("#if " + condition + "\nnonsense (\n#elif 1\n)\n#else\n]\n#endif\nreturn 1.0;", {message});
  };
  wrong("@FOO > 1",
        "E0401 'FOO' is no macro here, and GLSL takes no unknown name for 0; ask 'defined(FOO)', or write '#define FOO "
        "0' before");
  wrong("1 @/ 0", "E0401 this condition divides by zero");
  wrong("1 @% (2 - 2)", "E0401 this condition divides by zero");
  wrong("1 @<< 64", "E0401 '<<' moves by 0 to 63 bits, not by 64");
  wrong("1 @>> -1", "E0401 '>>' moves by 0 to 63 bits, not by -1");
  wrong("@1.5", "E0401 '1.5' is no whole number; a condition computes with whole numbers");
  wrong("@08", "E0401 '08' is no whole number; a condition computes with whole numbers");
  wrong("@99999999999999999999", "E0401 this number is larger than 64 bits hold");
  wrong("1 @? 2 : 3", "E0401 '?' cannot stand here in a condition");
  wrong("1 @= 1", "E0401 '=' cannot stand here in a condition");
  wrong("@(1", "E0401 '(' is never closed by ')'");
  wrong("1 @+", "E0401 this condition ends where a number is missing");
  wrong("1 @2", "E0401 '2' cannot stand here in a condition");
  wrong("@defined", "E0401 'defined' needs the name of a macro: 'defined(NAME)'");
  wrong("@defined(A", "E0401 'defined' needs the name of a macro: 'defined(NAME)'");
}

TEST_CASE("macros that cannot be are one error") {
  check_body("#define @__LINE__ 3\nreturn 1.0;",
             {"E0401 '__LINE__' is a word that GLSL keeps for itself; take another name"});
  check_body("#undef @GL_core_profile\nreturn 1.0;",
             {"E0401 'GL_core_profile' is a word that GLSL keeps for itself; take another name"});
  check_body("#define @defined\nreturn 1.0;",
             {"E0401 'defined' is a word that GLSL keeps for itself; take another name"});
  check_body("#define A 1\n#define @A 2\nreturn 1.0;",
             {"E0401 the macro 'A' is defined twice, and not the same; '#undef A' before, or another name"});
  check_body("#define A(x) x\n#define @A(y) y\nreturn 1.0;",
             {"E0401 the macro 'A' is defined twice, and not the same; '#undef A' before, or another name"});
  check_body("#define F(a, @a) a\nreturn 1.0;", {"E0401 this macro has two parameters of the name 'a'"});
  check_body("#define F(a @b) a\nreturn 1.0;",
             {"E0401 'b' cannot stand among the parameters of a macro, which are names with ',' between them"});
  check_body("#define F(a@.) a\nreturn 1.0;",
             {"E0401 '.' cannot stand among the parameters of a macro, which are names with ',' between them"});
  check_body("#define F(a, @b\nreturn 1.0;", {"E0401 the parameters of this macro are never closed by ')'"});
  check_body("#define F(a) @#a\nreturn 1.0;", {"E0401 GLSL has no strings, so '#' makes none of a macro's argument"});
  check_body("#define F(a) a @##\nreturn 1.0;", {"E0401 '##' joins two words, and stands between them"});
  check_body("#define CAT(a, b) a##b\nreturn @CAT(+, 1.0);",
             {"E0401 '##' makes '+1.0' here, which is no single word of GLSL"});
  check_body("#define F(a, b) a\nreturn @F(1.0);", {"E0401 the macro 'F' takes 2 arguments, but gets 1"});
  check_body("#define F(a) a\nreturn @F(1.0;", {"E0401 the arguments of the macro 'F' are never closed by ')'"});
  check_body("#define D @#undef\nreturn 1.0;", {"E0401 GLSL has no strings, so '#' makes none of a macro's argument"});
}

TEST_CASE("what a macro makes is at fault where it is used, an argument where it stands") {
  const std::string macro = "#define SUM(a, b) (a +\\\n b)\n";
  check_body(macro + "float d = 1.0;\nreturn SUM(d, @qqq);", {"E0402 unknown name 'qqq'"});
  check_body(macro + "float d = SUM(1.0,\n  SUM(2.0, @lenght(p)));\nreturn d;",
             {"E0402 no function 'lenght'; did you mean 'length'?"});
  check_body("#define TIMES *\n#define OUTER INNER\n#define INNER p TIMES mat2(1.0)\nreturn (@OUTER).x;",
             {"E0401 '*' does not work between vec3 and mat2"});
  Diagnostics diagnostics;
  const auto scene =
      voml::read_scene("s.voml", memory_files({{"s.voml", scene_of("#define R raduis\nreturn R;")}}), {}, diagnostics);
  REQUIRE(scene);
  CHECK_FALSE(compile_snippet(scene->functions.at(0), diagnostics));
  REQUIRE(diagnostics.all().size() == 1);
  REQUIRE(diagnostics.all()[0].notes.size() == 1);
  CHECK(diagnostics.all()[0].notes[0].message == "'raduis' comes from the macro 'R', defined here");
  CHECK(
      diagnostics.locate(diagnostics.all()[0].notes[0].span.source, diagnostics.all()[0].notes[0].span.begin).column ==
      50);
}

TEST_CASE("preprocessing takes time linear in the text") {
  // A hundred thousand lines, their macros and conditions, in a time that a quadratic search would exceed many times
  // over.
  std::string text = "float a = p.x;\n#define S(x, k) ((x) + float(k))\n";
  for (int i = 0; i < 25000; ++i) {
    text += fmt::format("#define M{0} {0}\n#if M{0} >= 0 && defined(M{0})\n#endif\n", i);
  }
  const auto begin = std::chrono::steady_clock::now();
  CHECK(value_of(text + "return S(a, M24999);") == doctest::Approx(24999.25));
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(20));
}
