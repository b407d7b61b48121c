// Rays against mathematics, and against 10^5 points each.
#include "compiler/rays/ray_reference.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/support/random.h"
#include "tests/support/scene_table.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::compiler;

namespace {

constexpr double exact = 1e-12;

/// A ball in the middle of the cube; nothing around it.
std::string ball(double radius, const std::string& region, const std::string& name = "BALL") {
  return fmt::format(
      "<OBJECT name='{}'><SDF name='S' function='true'>return length(p) - {};</SDF>{}<REGION name='OUT' type='empty'/>"
      "<MAPPINGS><SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT>",
      name, radius, region);
}
std::string region(const std::string& rgb, double opacity) {
  return fmt::format("<REGION name='IN' type='color' rgb='{}' opacity='{}'/>", rgb, opacity);
}
Module scene(const std::string& objects) { return tests::lowered("<MVV>" + objects + "</MVV>"); }

const Ray from_the_front{{0.0, 0.0, 5.0}, {0.0, 0.0, -1.0}};

/// What the ray meets at evenly spaced points: boundaries to within a step.
std::vector<RaySegment> sampled(const Reference& points, const Ray& ray, double t0, double t1, int count,
                                double time_ms) {
  std::vector<RaySegment> segments;
  bool is_open = false;
  for (int i = 0; i < count; ++i) {
    const double t = t0 + (t1 - t0) * (i + 0.5) / count;
    const auto path = points.evaluate(ray.origin + t * ray.direction, time_ms).path;
    if (is_open && segments.back().path == path) {
      segments.back().t1 = t;
      continue;
    }
    is_open = !path.empty();
    if (is_open) segments.push_back({t, t, path});
  }
  return segments;
}

}  // namespace

TEST_CASE("a ray meets a ball where a sphere is, whatever its direction's length and wherever it begins") {
  const Module module = scene(ball(0.5, region("1 0.5 0.25", 1.0)));
  const RayReference reference(module);
  const RayAnswer hit = reference.along(from_the_front);
  REQUIRE(hit.segments.size() == 1);
  CHECK(std::abs(hit.segments[0].t0 - 4.5) < exact);
  CHECK(std::abs(hit.segments[0].t1 - 5.5) < exact);
  CHECK(hit.certain);
  CHECK(hit.segments[0].certain);
  CHECK(hit.depth == hit.segments[0].t0);
  CHECK(hit.rgba == glm::dvec4(1.0, 0.5, 0.25, 1.0));
  CHECK(format_path(legend(module), hit.segments[0].path) == "BALL:IN");

  const RayAnswer twice = reference.along({{0.0, 0.0, 5.0}, {0.0, 0.0, -2.0}});
  CHECK(std::abs(twice.segments.at(0).t0 - 2.25) < exact);
  const RayAnswer within = reference.along({{0.0, 0.1, 0.0}, {0.0, 0.0, 1.0}});  // the eye is in the ball
  CHECK(within.segments.at(0).t0 == 0.0);
  CHECK(std::abs(within.segments.at(0).t1 - std::sqrt(0.25 - 0.01)) < exact);
  for (const Ray& away : {Ray{{0.0, 0.0, 5.0}, {0.0, 0.0, 1.0}}, Ray{{0.0, 0.6, 5.0}, {0.0, 0.0, -1.0}},
                          Ray{{3.0, 0.0, 5.0}, {0.0, 0.0, -1.0}}}) {
    const RayAnswer missed = reference.along(away);
    CHECK(missed.segments.empty());
    CHECK(missed.rgba == glm::dvec4(0.0));
    CHECK(missed.depth == std::numeric_limits<double>::infinity());
    CHECK(missed.certain);
  }
  tests::Random random(3);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 origin = 3.0 * glm::normalize(random.point(-1.0, 1.0)), target = random.point(-0.4, 0.4);
    const Ray ray{origin, glm::normalize(target - origin)};
    const double middle = -glm::dot(origin, ray.direction);
    const double reach = 0.25 - glm::dot(origin, origin) + middle * middle;  // squared, of half the chord
    const RayAnswer answer = reference.along(ray);
    REQUIRE(answer.segments.size() == (reach > 0.0 ? 1 : 0));
    if (reach <= 0.0) continue;
    CHECK(std::abs(answer.segments[0].t0 - (middle - std::sqrt(reach))) < exact / std::sqrt(reach));
    CHECK(std::abs(answer.segments[0].t1 - (middle + std::sqrt(reach))) < exact / std::sqrt(reach));
    CHECK(answer.certain == answer.segments[0].certain);
  }
}

TEST_CASE("the cube ends what fills it, and a cut shows a section") {
  const Module module = scene("<OBJECT name='ALL'><REGION name='IN' type='color' rgb='0 1 0'/></OBJECT>");
  const RayReference reference(module);
  CHECK(reference.along(from_the_front).segments.at(0).t0 == 4.0);
  CHECK(reference.along(from_the_front).segments.at(0).t1 == 6.0);
  const Cut front{{0.0, 0.0, 1.0}, 0.25}, back{{0.0, 0.0, -2.0}, 1.0};  // z > 0.25 goes, and z < -0.5
  const RayAnswer cut = reference.along(from_the_front, std::array{front, back});
  CHECK(std::abs(cut.segments.at(0).t0 - 4.75) < exact);
  CHECK(std::abs(cut.segments.at(0).t1 - 5.5) < exact);
  CHECK(cut.certain);
  CHECK(reference.along({{0.0, 0.0, 0.9}, {1.0, 0.0, 0.0}}, std::array{front}).segments.empty());
}

TEST_CASE("media absorb by length in units of their object: nested balls against closed forms") {
  const double outer = 0.75, inner = 0.375, thin = 0.3, thick = 0.9;
  const std::string objects = ball(0.75, region("1 1 1", thick), "INNER") +  // embedded at half the size
                              fmt::format(
                                  "<OBJECT name='OUTER'><SDF name='S' function='true'>return length(p) - 0.75;</SDF>"
                                  "<REGION name='IN' type='color' rgb='1 0 0' opacity='{}'><EMBEDDED name='INNER' "
                                  "scale='0.5 0.5 0.5'/></REGION>"
                                  "<REGION name='OUT' type='empty'/><MAPPINGS><SDF name='S'><POSITIVE "
                                  "region='OUT'/><NEGATIVE region='IN'/></SDF>"
                                  "</MAPPINGS></OBJECT>",
                                  thin);
  const Module module = scene(objects);
  const RayReference reference(module);
  const auto half = [](double r, double y) { return std::sqrt(r * r - y * y); };
  for (const double y : {0.0, 0.2, 0.37}) {
    CAPTURE(y);
    const RayAnswer answer = reference.along({{0.0, y, 5.0}, {0.0, 0.0, -1.0}});
    REQUIRE(answer.segments.size() == 3);
    const double shell = half(outer, y) - half(inner, y), core = 2.0 * half(inner, y) / 0.5;  // in the inner's units
    const double through_shell = std::pow(1.0 - thin, shell), through_core = std::pow(1.0 - thick, core);
    const double alpha = 1.0 - through_shell * through_core * through_shell;
    const double red = (1.0 - through_shell) + through_shell * (1.0 - through_core) +
                       through_shell * through_core * (1.0 - through_shell);
    const double green = through_shell * (1.0 - through_core);
    CHECK(std::abs(answer.rgba.a - alpha) < exact);
    CHECK(std::abs(answer.rgba.r * alpha - red) < exact);
    CHECK(std::abs(answer.rgba.g * alpha - green) < exact);
    CHECK(answer.certain);
  }
}

TEST_CASE("light goes both ways alike, and a ray may be divided anywhere") {
  const Module module = scene(ball(0.7, region("0.2 0.4 0.6", 0.5)));
  const RayReference reference(module);
  tests::Random random(9);
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 a = 2.0 * glm::normalize(random.point(-1.0, 1.0)),
                     b = 2.0 * glm::normalize(random.point(-1.0, 1.0));
    const double alpha = reference.along({a, b - a}).rgba.a;
    CHECK(std::abs(alpha - reference.along({b, a - b}).rgba.a) < 1e-11);
    // What a cut across the ray leaves on either side, one behind the other, is the whole.
    const glm::dvec3 normal = glm::normalize(b - a);
    const double d = glm::dot(normal, a + 0.45 * (b - a));
    const double front = reference.along({a, b - a}, std::array{Cut{normal, d}}).rgba.a;
    const double rest = reference.along({a, b - a}, std::array{Cut{-normal, -d}}).rgba.a;
    CHECK(std::abs(1.0 - (1.0 - front) * (1.0 - rest) - alpha) < 1e-11);
  }
}

TEST_CASE("what is thin is not lost") {
  for (const double thickness : {1e-2, 1e-4, 1e-5}) {
    CAPTURE(thickness);
    const Module module = scene(fmt::format(
        "<OBJECT name='SHEET'><SDF name='S' function='true'>return abs(p.z - 0.1) - {};</SDF>"
        "<REGION name='IN' type='color' rgb='1 0 0'/><REGION name='OUT' type='empty'/><MAPPINGS><SDF name='S'>"
        "<POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT>",
        0.5 * thickness));
    const RayReference reference(module);
    tests::Random random(17);
    for (int i = 0; i < 100; ++i) {
      const glm::dvec3 origin(2.0 * random.point(-1.0, 1.0).x, 2.0 * random.point(-1.0, 1.0).y, 3.0);
      const Ray ray{origin, glm::dvec3(0.4 * random.point(-1.0, 1.0).x, 0.4 * random.point(-1.0, 1.0).y, 0.1) - origin};
      const RayAnswer answer = reference.along(ray);
      REQUIRE(answer.segments.size() == 1);
      const double expected = (3.0 - 0.1 - 0.5 * thickness) / 2.9;
      CHECK(std::abs(answer.segments[0].t0 - expected) < 1e-9);
    }
  }
}

TEST_CASE("rays of every kind of scene: what 10^5 points of them see") {
  tests::Random random(23);
  int certain = 0, all = 0;
  for (const tests::SceneCase& one : tests::conformance_scenes()) {
    CAPTURE(one.name);
    const Module module = tests::lowered(one.text, one.files);
    const RayReference reference(module);
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 origin = 2.5 * glm::normalize(random.point(-1.0, 1.0)), target = random.point(-0.5, 0.5);
      const Ray ray{origin, target - origin};
      const double time_ms = i == 0 ? 0.0 : 700.0 * i;
      const RayAnswer answer = reference.along(ray, {}, time_ms);
      constexpr int count = 100000;
      const double end = answer.segments.empty() ? 4.0 : answer.segments.back().t1, step = end / count;
      const auto expected = sampled(reference.points(), ray, 0.0, end, count, time_ms);
      ++all;
      certain += answer.certain;
      // Points may step over what is shorter than their distance.
      std::vector<RaySegment> long_ones;
      for (const RaySegment& segment : answer.segments) {
        if (segment.t1 - segment.t0 > 1.5 * step) long_ones.push_back(segment);
      }
      std::vector<RaySegment> seen;
      for (const RaySegment& segment : expected) {
        if (segment.t1 - segment.t0 > 0.6 * step) seen.push_back(segment);
      }
      CHECK(long_ones.size() >= seen.size());
      for (const RaySegment& segment : seen) {
        const auto same = std::ranges::find_if(long_ones, [&](const RaySegment& s) {
          return s.path == segment.path && std::abs(s.t0 - segment.t0) <= 1.01 * step &&
                 std::abs(s.t1 - segment.t1) <= 1.01 * step;
        });
        CHECK(same != long_ones.end());
      }
    }
  }
  MESSAGE(certain, " of ", all, " rays are certain");
  CHECK(certain * 10 >= all * 9);
}
