#include "compiler/glsl/families.h"

#include <doctest/doctest.h>

#include <bit>

using dmvv::compiler::Families;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string ball(const std::string& name, const std::string& radius) {
  return "// a ball\nfloat " + name + "(vec3 p) {\n  return length(p) - " + radius + ";  // its radius\n}\n";
}

}  // namespace

TEST_CASE("functions that differ in literals alone become one, which reads them") {
  Families families;
  families.add("f", ball("f", "0.5"));
  families.add("g", ball("g", "-0.25"));
  families.add("h", "float h(vec3 p) {\n  return length(p) + 0.5;\n}\n");
  CHECK(families.shape("f") == families.shape("g"));
  CHECK(families.shape("f") != families.shape("h"));

  CHECK(families.unite({"f", "g"}) == "f_united");
  families.add("main", "void main() {\n  x = f_united(r, p) + h(p);\n}\n");
  families.settle();
  REQUIRE(families.parameters().size() == 2);
  CHECK(families.parameters()[families.row("f")].x == std::bit_cast<std::uint32_t>(0.5f));
  CHECK(families.parameters()[families.row("g")].x == std::bit_cast<std::uint32_t>(-0.25f));
  CHECK(families.take({"main"}) ==
        "// f and 1 more of its shape\n"
        "float f_united(uint row, vec3 p) {\n"
        "  uvec4 k0 = parameter_at(row + 0u);\n"
        "  return length(p) - uintBitsToFloat(k0.x);\n"
        "}\n"
        "float h(vec3 p) {\n  return length(p) + 0.5;\n}\n"
        "void main() {\n  x = f_united(r, p) + h(p);\n}\n");
  CHECK(families.take({"main"}).empty());  // once
}

TEST_CASE(
    "what is the same in all members stays, equal differences share a parameter, callees are united with their "
    "callers") {
  Families families;
  for (const char* n : {"1", "2"}) {
    const std::string number = n;
    families.add("f" + number,
                 "float f" + number + "(vec3 p) { return p.x * " + number + ".5 + " + number + ".5 - 3.0; }\n");
    families.add("g" + number, "bool g" + number + "(vec3 p, uint u) {\n  return f" + number +
                                   "(p) <= 0.0 && u == " + number + "u;\n}\n");
  }
  CHECK(families.unite({"g1", "g2"}) == "g1_united");
  families.add("main", "bool b = g1_united(0u, p, 1u);\n");
  families.settle();
  const std::string text = families.take({"main"});
  CHECK(has(text, "float f1_united(uint row, vec3 p) { "));
  CHECK(has(text, "- 3.0"));
  CHECK_FALSE(has(text, "k0.y) - 3.0"));
  CHECK(has(text, "return f1_united(k0.y, p) <= 0.0 && u == k0.x;"));
  for (const char* name : {"g1", "g2"}) {
    CHECK(families.parameters()[families.row(name)].y == families.row("f" + std::string(1, name[1])));
  }
}

TEST_CASE("constant arrays may differ in length; other sizes are part of the shape") {
  Families families;
  const auto sum = [](const std::string& name, const std::string& values, const std::string& last) {
    return "float " + name + "(vec3 p) {\n  const float a0[" + last + "] = float[" + last + "](" + values +
           ");\n  float s = 0.0;\n  for (int i = 0; i < " + last + "; ++i) s = s + a0[clamp(i, 0, " + last +
           ")];\n  return s;\n}\n";
  };
  families.add("f", sum("f", "1.0, 2.0", "2"));
  families.add("g", sum("g", "5.0, 6.0, 7.0", "3"));
  families.add("m", "float m(vec3 p) {\n  float a[2] = float[2](p.x, p.y);\n  return a[0];\n}\n");
  families.add("n", "float n(vec3 p) {\n  float a[3] = float[3](p.x, p.y);\n  return a[0];\n}\n");
  CHECK(families.shape("m") != families.shape("n"));
  REQUIRE(families.shape("f") == families.shape("g"));
  families.unite({"f", "g"});
  families.add("main", "float s = f_united(row, p);\n");
  families.settle();
  CHECK(has(families.take({"main"}),
            "s = s + uintBitsToFloat(parameter_at(row + 1u + 1u * uint(clamp(i, 0, int(k0.x)))).x);"));
  const auto value = [&](const std::string& name, std::uint32_t i) {
    return std::bit_cast<float>(families.parameters()[families.row(name) + 1 + i].x);
  };
  CHECK(value("f", 1) == 2.0f);
  CHECK(value("g", 2) == 7.0f);
}

TEST_CASE("a sign belongs to a literal, an operation does not; names and swizzles hold no literals") {
  Families families;
  families.add("f", "float f(vec3 r1) { return r1.x * -2.0 - 1e-3; }\n");
  families.add("g", "float g(vec3 r1) { return r1.x * 3.0 - 2e+5; }\n");
  families.add("h", "float h(vec3 r2) { return r2.x * 3.0 - 2e+5; }\n");
  families.add("i", "float i(vec3 r1) { return r1.x * 3.0 + 2e+5; }\n");
  CHECK(families.shape("f") == families.shape("g"));
  CHECK(families.shape("g") != families.shape("h"));
  CHECK(families.shape("g") != families.shape("i"));
}
