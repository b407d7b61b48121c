// Beyond its content nothing is: what is left out of a cube is empty to every device, and little more than it is kept.
#include "compiler/passes/content.h"

#include <doctest/doctest.h>

#include <cmath>
#include <glm/vector_relational.hpp>

#include "compiler/reference/reference.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::compiler;

namespace {

Module trimmed(const std::string& mappings, const std::string& sdfs, tests::Files files = {}) {
  Module module =
      tests::lowered("<MVV><OBJECT name=\"O\">" + sdfs +
                         "<REGION name=\"IN\" type=\"color\" rgb=\"1 0 0\"/><REGION name=\"OUT\" type=\"empty\"/>" +
                         mappings + "</OBJECT></MVV>",
                     std::move(files));
  trim_cubes(module, TexelFormat::r32f, Filter::hardware);
  return module;
}

const char* const inside_one =
    R"(<MAPPINGS><SDF name="S"><POSITIVE region="OUT"/><NEGATIVE region="IN"/></SDF></MAPPINGS>)";

std::string function(const std::string& body) {
  return "<SDF name=\"S\" function=\"true\"><![CDATA[" + body + "]]></SDF>";
}

void check_near(const LocalBox& box, const glm::dvec3& lo, const glm::dvec3& hi, double slack) {
  for (int k = 0; k < 3; ++k) {
    CHECK(box.lo[k] <= lo[k]);
    CHECK(box.lo[k] >= lo[k] - slack);
    CHECK(box.hi[k] >= hi[k]);
    CHECK(box.hi[k] <= hi[k] + slack);
  }
}

constexpr double finest = 2.0 / 32.0 + 1e-6;

}  // namespace

TEST_CASE("balls, boxes and rods are found to the finest step") {
  check_near(trimmed(inside_one, function("return length(p) - 0.5;")).objects[0].content, glm::dvec3(-0.5),
             glm::dvec3(0.5), finest);
  check_near(trimmed(inside_one, function("return length(p - vec3(0.3, 0.0, -0.2)) - 0.4;")).objects[0].content,
             {-0.1, -0.4, -0.6}, {0.7, 0.4, 0.2}, finest);
  check_near(trimmed(inside_one, function("return length(p - vec3(clamp(p.x, -0.7, 0.7), 0.0, 0.0)) - 0.2;"))
                 .objects[0]
                 .content,
             {-0.9, -0.2, -0.2}, {0.9, 0.2, 0.2}, finest);
}

TEST_CASE("what moves is kept wherever it may be, at any time") {
  const LocalBox content =
      trimmed(inside_one, function("return length(p - vec3(0.4 * sin(0.001 * t), 0.0, 0.0)) - 0.3;"))
          .objects[0]
          .content;
  check_near(content, {-0.7, -0.3, -0.3}, {0.7, 0.3, 0.3}, 2.0 * finest);
}

TEST_CASE("an object that is not empty beside a source is not trimmed") {
  const char* const outside =
      R"(<MAPPINGS><SDF name="S"><POSITIVE region="IN"/><NEGATIVE region="OUT"/></SDF></MAPPINGS>)";
  CHECK(trimmed(outside, function("return length(p) - 0.5;")).objects[0].content == LocalBox{});
  CHECK(trimmed(inside_one, function("return fract(7.0 * p.x) - 2.0;")).objects[0].content == LocalBox{});
  CHECK(trimmed(inside_one, function("return length(p) + 1.0;")).objects[0].content ==
        LocalBox{});  // nowhere: not worth a case
}

TEST_CASE("seeds are trimmed to their source, and their object to all of them") {
  const Module module = trimmed(
      inside_one,
      R"(<SDF name="S" function="true" type="seeding" seedFile="s.txt" scale="0.2 0.2 0.2">return length(p) - 0.5;</SDF>)",
      {{"s.txt", "0.1 0 0\n-0.2 0.1 0\n"}});
  check_near(module.sdfs[0].content, glm::dvec3(-0.5), glm::dvec3(0.5), finest);
  check_near(module.objects[0].content, {-0.5, -0.1, -0.1}, {0.3, 0.3, 0.1}, 0.2 * finest + 1e-3);
}

TEST_CASE("no point beyond the content of a grid is inside it") {
  tests::Random random(3);
  const Module module = trimmed(inside_one, R"(<SDF name="S" file="sphere.lxn" offset="-0.1"/>)",
                                {{"sphere.lxn", tests::sphere_lxn(24, 0.7)}});
  const LocalBox content = module.objects[0].content;
  CHECK(content.hi.x < 0.9);
  const Reference reference(module);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 p = random.point();
    const bool is_beyond = glm::any(glm::lessThan(p, content.lo)) || glm::any(glm::greaterThan(p, content.hi));
    if (is_beyond) REQUIRE(reference.evaluate(p, 0.0).number == 0);
  }
}
