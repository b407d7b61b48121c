#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <span>

#include "support.h"
#include "tests/support/random.h"

using namespace dmvv;
using namespace dmvv::tests;
using namespace dmvv::runtime;

namespace {

/// Message and way out of what must be refused as the user's fault.
template <class T>
std::string refusal(const Result<T>& result) {
  REQUIRE_FALSE(result);
  CHECK(result.error().fault == Fault::input);
  REQUIRE(result.error().reasons.size() == 1);
  CHECK(result.error().reasons[0].starts_with("expected "));
  return result.error().message;
}

}  // namespace

TEST_CASE("a camera goes so near that points touch its frame, and turns nowhere") {
  tests::Random random(3);
  std::vector<glm::vec3> points{glm::vec3(std::numeric_limits<float>::quiet_NaN())};
  for (int i = 0; i < 200; ++i) points.push_back(glm::vec3(glm::dvec3(0.4, -0.2, 0.1) + 0.3 * random.point(-1.0, 1.0)));
  const Camera from = default_camera({{-1, -1, -1}, {1, 1, 1}}, {640, 480}, {});
  const Camera framed = framing(from, {640, 480}, points, 0.0);
  const glm::dvec3 forward = glm::normalize(framed.look - framed.eye);
  CHECK(glm::length(forward - glm::normalize(from.look - from.eye)) < 1e-12);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, framed.up)), up = glm::cross(right, forward);
  const double slope = std::tan(framed.fov_deg * 3.14159265358979 / 360.0);
  double farthest = 0.0;  // of the way from the middle to the border
  for (const glm::vec3& point : std::span(points).subspan(1)) {
    const glm::dvec3 p = glm::dvec3(point) - framed.eye;
    const double depth = glm::dot(p, forward);
    REQUIRE(depth > 0.0);
    farthest = std::max(farthest, std::abs(glm::dot(p, up)) / (slope * depth));
    farthest = std::max(farthest, std::abs(glm::dot(p, right)) / (slope * depth * 640.0 / 480.0));
  }
  CHECK(farthest == doctest::Approx(0.94).epsilon(1e-6));
  const Camera far = framing(from, {640, 480}, std::span(points).first(1), 0.0);
  CHECK(far.eye == from.eye);
}

TEST_CASE("cameras") {
  const Camera camera = must(parse_camera("fov 45.5 look 0 -1 2e-1  eye 3,2,+4 up 0 0 1"));
  CHECK(camera.eye == glm::dvec3(3, 2, 4));
  CHECK(camera.look == glm::dvec3(0, -1, 0.2));
  CHECK(camera.up == glm::dvec3(0, 0, 1));
  CHECK(camera.fov_deg == 45.5);
  CHECK(must(parse_camera("eye 1 1 1 look 0 0 0")).up == glm::dvec3(0, 1, 0));

  CHECK(refusal(parse_camera("")) == "camera '': 'eye' is missing");
  CHECK(refusal(parse_camera("eye 1 2 3")) == "camera 'eye 1 2 3': 'look' is missing");
  CHECK(refusal(parse_camera("eye 1 2 look 0 0 0")).find("'eye' needs 3 finite numbers, found 'look'") !=
        std::string::npos);
  CHECK(refusal(parse_camera("look 0 0 0 eye 1 2")).find("found the end") != std::string::npos);
  CHECK(refusal(parse_camera("eye 1 2 nan look 0 0 0")).find("found 'nan'") != std::string::npos);
  CHECK(refusal(parse_camera("eye 1 2 3x look 0 0 0")).find("found '3x'") != std::string::npos);
  CHECK(refusal(parse_camera("eye 1 2 3 look 0 0 0 eye 1 2 3")).find("'eye' is given twice") != std::string::npos);
  CHECK(refusal(parse_camera("eye 1 2 3 lok 0 0 0")).find("'lok' is none of") != std::string::npos);
  CHECK(refusal(parse_camera("eye 1 2 3 look 1 2 3")).find("the same point") != std::string::npos);
  CHECK(refusal(parse_camera("eye 1 2 3 look 0 0 0 up 0 0 0")).find("up is zero") != std::string::npos);
  CHECK(refusal(parse_camera("eye 1 2 3 look 0 0 0 fov 180")).find("fov is 180") != std::string::npos);
}

TEST_CASE("planes and slices") {
  const Plane plane = must(parse_plane("0 -2.5 1 .5"));
  CHECK(plane.normal == glm::dvec3(0, -2.5, 1));
  CHECK(plane.d == 0.5);
  CHECK(refusal(parse_plane("1 0 0")).find("4 numbers are needed, found 3") != std::string::npos);
  CHECK(refusal(parse_plane("1 0 0 1 2")).find("found 5") != std::string::npos);
  CHECK(refusal(parse_plane("1 0 zero 1")).find("'zero' is not a finite number") != std::string::npos);
  CHECK(refusal(parse_plane("1 0 inf 1")).find("'inf'") != std::string::npos);
  CHECK(refusal(parse_plane("0 0 0 1")).find("the normal is zero") != std::string::npos);

  const Plane slice = must(parse_slice(" y = -0.25 "));
  CHECK(slice.normal == glm::dvec3(0, 1, 0));
  CHECK(slice.d == -0.25);
  CHECK(must(parse_slice("1 2 3 4")).normal == glm::dvec3(1, 2, 3));
  CHECK(refusal(parse_slice("w=0")).find("none of x, y, z") != std::string::npos);
  CHECK(refusal(parse_slice("z=")).find("one finite number") != std::string::npos);
  CHECK(refusal(parse_slice("z=1 2")).find("one finite number") != std::string::npos);
  CHECK(refusal(parse_slice("z")).find("4 numbers") != std::string::npos);
}

TEST_CASE("sizes") {
  CHECK(must(parse_size("1280x720")) == glm::uvec2(1280, 720));
  CHECK(must(parse_size("1x16384")) == glm::uvec2(1, 16384));
  for (const char* bad :
       {"", "x", "12", "12x", "x12", "0x5", "5x0", "16385x1", "1x99999999999", "-3x4", "3.5x4", "3x4x5", " 3x4"}) {
    CAPTURE(bad);
    CHECK_FALSE(refusal(parse_size(bad)).empty());
  }
}

TEST_CASE("the default camera frames the bounds, and no more than its margin is left") {
  const std::vector<voml::Bounds> boxes{
      {{-1, -1, -1}, {1, 1, 1}}, {{5, -2, 0}, {9, -1.9, 0.5}}, {{-1, -1, 0}, {1, 1, 0}}, {{0, 0, -3}, {0, 0, 3}}};
  for (const glm::uvec2 size : {glm::uvec2(1280, 720), glm::uvec2(300, 900), glm::uvec2(64, 64)}) {
    for (const voml::Bounds& box : boxes) {
      const Camera camera = default_camera(box, size, {});
      const glm::dvec3 forward = glm::normalize(camera.look - camera.eye);
      CHECK(glm::dot(forward, glm::normalize(glm::dvec3(-0.55, -0.45, -1.0))) == doctest::Approx(1.0).epsilon(1e-12));
      const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
      const double tangent = std::tan(camera.fov_deg * std::numbers::pi / 360.0);
      double reach[2] = {0.0, 0.0};
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p((corner & 1 ? box.hi : box.lo).x, (corner & 2 ? box.hi : box.lo).y,
                           (corner & 4 ? box.hi : box.lo).z);
        const double depth = glm::dot(forward, p - camera.eye);
        REQUIRE(depth > 0.0);
        reach[0] = std::max(reach[0], std::abs(glm::dot(right, p - camera.eye)) / depth / tangent * size.y / size.x);
        reach[1] = std::max(reach[1], std::abs(glm::dot(up, p - camera.eye)) / depth / tangent);
      }
      CHECK(std::max(reach[0], reach[1]) == doctest::Approx(0.94).epsilon(1e-9));
    }
  }
  const Camera at_point = default_camera({{2, 2, 2}, {2, 2, 2}}, {100, 100}, {});
  CHECK(glm::length(at_point.eye - glm::dvec3(2)) > 0.5);
  CHECK(glm::length(at_point.eye - glm::dvec3(2)) < 10.0);
}

TEST_CASE("the default camera sees the sections") {
  const voml::Bounds box{{-1, -1, -1}, {1, 1, 1}};
  const std::vector<std::vector<Plane>> sets{{{{0, 0, -1}, 0}},
                                             {{{-1, 0, 0}, 0}, {{0, -1, 0}, 0}},
                                             {{{0, 3, 0}, 0}},
                                             {{{1, 0, 0}, 0}, {{0, 1, 0}, 0}, {{0, 0, -1}, 0}}};
  for (const auto& cuts : sets) {
    const Camera camera = default_camera(box, {640, 480}, cuts);
    for (const Plane& cut : cuts) {
      CHECK(glm::dot(glm::normalize(cut.normal), glm::normalize(camera.eye - camera.look)) > 0.3);
    }
  }
}

TEST_CASE("slices: the cube's width fills the shorter side, y or z is up") {
  const auto close = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-14; };
  const SliceFrame z = slice_frame({{0, 0, 1}, 0.25}, {200, 100});
  CHECK(close(z.step_x, {0.02, 0, 0}));
  CHECK(close(z.step_y, {0, -0.02, 0}));
  CHECK(close(z.origin, {-1.99, 0.99, 0.25}));
  const SliceFrame x = slice_frame({{-4, 0, 0}, 2}, {100, 100});  // x = -0.5 seen from -x: z to the right
  CHECK(close(x.step_x, {0, 0, 0.02}));
  CHECK(close(x.origin, {-0.5, 0.99, -0.99}));
  const SliceFrame y = slice_frame({{0, 1, 0}, 0}, {100, 100});  // from above, z up: x to the left
  CHECK(close(y.step_x, {-0.02, 0, 0}));
  CHECK(close(y.step_y, {0, 0, -0.02}));
  const SliceFrame oblique = slice_frame({{1, 1, 1}, 1}, {50, 70});
  const glm::dvec3 middle = oblique.origin + 24.5 * oblique.step_x + 34.5 * oblique.step_y;
  CHECK(close(middle, glm::dvec3(1.0 / 3.0)));
  CHECK(glm::length(oblique.step_x) == doctest::Approx(2.0 / 50));
  CHECK(std::abs(glm::dot(oblique.step_x, oblique.step_y)) < 1e-17);
  CHECK(oblique.step_y.y < 0.0);
}
