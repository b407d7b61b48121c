// A device without extras (no 64-bit atomics, short texel buffers) draws the same pictures as one that has them, to the
// bit.
#include <algorithm>

#include "runtime/gpu/gpu.h"
#include "support.h"

using namespace dmvv;
using namespace dmvv::tests;
using runtime::Picture;
using runtime::View;

namespace {

runtime::Device& plain_device() {
  static runtime::Device opened = must(runtime::create_without_extras({.name = "", .validation = true}));
  return opened;
}

Picture drawn(runtime::Device& on, const View& view) {
  auto evaluator = must(runtime::Evaluator::create(on, program(Show::position)));
  return must(evaluator.render(view));
}

void check_same(const View& view) {
  const Picture expected = drawn(device(), view), got = drawn(plain_device(), view);
  CHECK(got.rgba == expected.rgba);
  CHECK(std::ranges::any_of(expected.rgba, [](float value) { return value != 0.0f; }));
  for (const std::string& message : plain_device().validation_messages()) FAIL_CHECK(message);
}

View view_of(const voml::Mesh* mesh, std::vector<runtime::Plane> cuts = {}) {
  View view;
  view.size_px = {320, 240};
  view.camera = {.eye = {3.0, 2.5, 5.0}, .look = {0.05, 0.02, 0.0}};
  view.shading = runtime::Shading::none;
  view.mesh = mesh != nullptr ? shared(*mesh) : nullptr;
  view.cuts = std::move(cuts);
  return view;
}

/// Every triangle a second time, from another corner on: as near, but for rounding, and interpolated otherwise.
voml::Mesh twice(voml::Mesh mesh) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; ++i) {
    const glm::uvec3 corners = mesh.triangles[i];
    mesh.triangles.emplace_back(corners.y, corners.z, corners.x);
  }
  return mesh;
}

}  // namespace

TEST_CASE("without extras: solids, whole and cut, from outside and from within") {
  const voml::Mesh ring = torus(0.65, 0.3, 24);
  const runtime::Plane oblique{{1.0, 1.0, 2.0}, 0.2}, front{{0.0, 0.0, 1.0}, 0.1};
  check_same(view_of(nullptr));  // large triangles, drawn in parts
  check_same(view_of(nullptr, {oblique}));
  check_same(view_of(&ring));
  check_same(view_of(&ring, {front}));
  check_same(view_of(&ring, {front, oblique, {{1.0, 0.0, 0.0}, 0.3}}));
  check_same(view_of(
      &ring, {front, oblique, {{1.0, 0.0, 0.0}, 0.3}, {{0.0, 1.0, 0.0}, 0.25}}));  // kernels for any number of cuts
  View within = view_of(&ring, {front});
  within.camera = {.eye = {0.65, 0.0, 0.0}, .look = {0.0, 0.5, 0.3}};
  check_same(within);
}

TEST_CASE("without extras: of triangles equally near the same one is seen") {
  const voml::Mesh ball = twice(sphere(0.9, {0.05, 0.0, -0.05}, 12));
  check_same(view_of(&ball));
  const voml::Mesh cube = twice(voml::standard_cube());
  check_same(view_of(&cube));
}

TEST_CASE("without extras: a mesh that no short texel buffer holds") {
  const voml::Mesh ball = sphere(0.9, {0.05, 0.0, -0.05}, 120);
  REQUIRE(3 * ball.triangles.size() > 65536);
  check_same(view_of(&ball, {{{0.0, 0.0, 1.0}, 0.4}}));
}
