// Pictures against rays cast in double: what is covered, where, by which cut, and the numbers that come with it.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "shaders/raster.h"
#include "support.h"

using namespace dmvv;
using namespace dmvv::tests;
using runtime::Camera;
using runtime::Picture;
using runtime::Plane;
using runtime::View;

namespace {

Picture render(const View& view, Show show) {
  auto evaluator = must(runtime::Evaluator::create(device(), program(show)));
  return must(evaluator.render(view));
}

glm::vec4 color_at(const Picture& picture, std::size_t pixel) {
  return {picture.rgba[4 * pixel], picture.rgba[4 * pixel + 1], picture.rgba[4 * pixel + 2],
          picture.rgba[4 * pixel + 3]};
}

/// Colours must be positions. Every pixel whose neighbourhood of a tenth of a pixel hits (or misses) as a whole must be
/// covered (or not), at a depth found there, and on the plane of its cut. Gives the share of the pixels that were too
/// near to a border to tell.
double compare_with_rays(const View& view, const voml::Mesh& mesh, const Picture& picture) {
  constexpr std::array<glm::dvec2, 5> offsets{
      glm::dvec2{0, 0}, {0.05, 0.05}, {-0.05, 0.05}, {0.05, -0.05}, {-0.05, -0.05}};
  const glm::dvec3 forward = glm::normalize(view.camera.look - view.camera.eye);
  std::size_t borders = 0, wrong_cover = 0, wrong_depth = 0, off_plane = 0, wrong_region = 0, covered = 0,
              wrong_position = 0;
  for (std::uint32_t y = 0; y < view.size_px.y; ++y) {
    for (std::uint32_t x = 0; x < view.size_px.x; ++x) {
      const std::size_t pixel = std::size_t{y} * view.size_px.x + x;
      std::vector<std::optional<Hit>> hits;
      for (const glm::dvec2& offset : offsets) hits.push_back(cast(view, mesh, x + 0.5 + offset.x, y + 0.5 + offset.y));
      const auto hit_count = std::ranges::count_if(hits, [](const auto& hit) { return hit.has_value(); });
      const bool is_covered = picture.rgba[4 * pixel + 3] != 0.0f;
      covered += is_covered ? 1 : 0;
      if (!picture.positions.empty()) {
        const glm::vec3& told = picture.positions[pixel];
        wrong_position += is_covered ? told != glm::vec3(color_at(picture, pixel)) : !std::isnan(told.x);
      }
      if (hit_count != 0 && hit_count != static_cast<long>(offsets.size())) {
        ++borders;
        continue;
      }
      wrong_cover += is_covered != (hit_count != 0) ? 1 : 0;
      if (hit_count == 0 || !is_covered) continue;
      const glm::dvec3 position(color_at(picture, pixel));
      const double depth = glm::dot(forward, position - view.camera.eye);
      double nearest = 1e300, farthest = 0.0;
      for (const auto& hit : hits) nearest = std::min(nearest, hit->depth), farthest = std::max(farthest, hit->depth);
      wrong_depth += depth < nearest - 1e-5 || depth > farthest + 1e-5 ? 1 : 0;
      if (!picture.depth.empty()) wrong_depth += std::abs(picture.depth[pixel] - depth) > 1e-5 ? 1 : 0;
      if (!picture.regions.empty()) {
        const std::uint32_t expected = position.x <= 0.25 ? 1 : 2;
        wrong_region += std::abs(position.x - 0.25) > 1e-6 && picture.regions[pixel] != expected ? 1 : 0;
      }
      const bool one_cap =
          std::ranges::all_of(hits, [&](const auto& hit) { return hit->cap && hit->cap == hits[0]->cap; });
      if (one_cap) {
        const Plane& cut = view.cuts[*hits[0]->cap];
        off_plane += std::abs(glm::dot(cut.normal, position) - cut.d) > 3e-7 * glm::length(cut.normal) ? 1 : 0;
      }
    }
  }
  CHECK(wrong_cover == 0);
  CHECK(wrong_depth == 0);
  CHECK(wrong_position == 0);
  CHECK(wrong_region == 0);
  CHECK(off_plane == 0);
  CHECK(covered > 0);
  return static_cast<double>(borders) / static_cast<double>(view.size_px.x * view.size_px.y);
}

/// Renders positions and compares; `name` also writes the checker picture, to be looked at.
void check_view(View view, const voml::Mesh& mesh, const std::string& name) {
  CAPTURE(name);
  const QuietValidation quiet;
  view.mesh = shared(mesh);
  view.want_depth = view.want_regions = view.want_positions = true;
  view.shading = runtime::Shading::none;
  const Picture positions = render(view, Show::position);
  CHECK(compare_with_rays(view, mesh, positions) < 0.05);
  CHECK(positions.edges.count() == 0);
  view.shading = runtime::Shading::lit;
  view.size_px *= 3u;
  must(runtime::write_picture((scratch() / (name + ".png")).string(), render(view, Show::checker)));
}

View view_from(const glm::dvec3& eye, std::vector<Plane> cuts = {}) {
  View view;
  view.size_px = {121, 90};
  view.camera = {.eye = eye, .look = {0.05, 0.02, 0.0}};
  view.cuts = std::move(cuts);
  return view;
}

const voml::Mesh& cube() {
  static const voml::Mesh mesh = voml::standard_cube();
  return mesh;
}

}  // namespace

TEST_CASE("the whole cube") { check_view(view_from({3.0, 2.5, 5.0}), cube(), "cube"); }

TEST_CASE("a cut cube is capped") {
  check_view(view_from({3.0, 2.5, 5.0}, {{{0.0, 0.0, 1.0}, 0.3}}), cube(), "cube_cut_z");
  check_view(view_from({3.0, 2.5, 5.0}, {{{1.0, 1.0, 2.0}, 0.2}}), cube(), "cube_cut_oblique");
}

TEST_CASE("several cuts meet without gaps") {
  const std::vector<Plane> corner{{{1.0, 0.0, 0.0}, 0.1}, {{0.0, 1.0, 0.0}, 0.2}, {{0.0, 0.0, 1.0}, 0.0}};
  check_view(view_from({3.0, 2.5, 5.0}, corner), cube(), "cube_cut_three");
  std::vector<Plane> ball;  // a many-sided thing cut out of the cube
  for (int i = 0; i < DMVV_MAX_CUTS; ++i) {
    const double z = -0.9 + 1.8 * i / (DMVV_MAX_CUTS - 1), turn = 2.4 * i, reach = std::sqrt(1.0 - z * z);
    ball.push_back({{reach * std::cos(turn), reach * std::sin(turn), z}, 0.85});
  }
  check_view(view_from({3.0, 2.5, 5.0}, ball), cube(), "cube_cut_64");
}

TEST_CASE("a cut that the eye sees from behind hides what it takes away") {
  check_view(view_from({3.0, 2.5, 5.0}, {{{0.0, 0.0, -1.0}, 0.0}}), cube(), "cube_cut_behind");
  View nothing = view_from({3.0, 2.5, 5.0}, {{{0.0, 0.0, 1.0}, -2.0}});
  const QuietValidation quiet;
  const Picture picture = render(nothing, Show::position);
  CHECK(std::ranges::all_of(picture.rgba, [](float value) { return value == 0.0f; }));
}

TEST_CASE("sections of curved and hollow solids") {
  const voml::Mesh ball = sphere(0.9, {0.05, 0.0, -0.05}, 12);
  const voml::Mesh ring = torus(0.65, 0.3, 24);
  const voml::Mesh hollow = join(sphere(0.9, {0.0, 0.0, 0.0}, 10), sphere(0.6, {0.05, 0.0, 0.0}, 10), true);
  const voml::Mesh nested = join(sphere(0.9, {0.0, 0.0, 0.0}, 10), sphere(0.6, {0.05, 0.0, 0.0}, 10), false);
  CHECK(voml::find_edge_faults(ball).count() == 0);
  check_view(view_from({2.5, 3.0, 4.0}), ball, "ball");
  check_view(view_from({2.5, 3.0, 4.0}, {{{0.3, 0.2, 1.0}, 0.1}}), ball, "ball_cut");
  check_view(view_from({2.5, 3.0, 4.0}), ring, "torus");
  check_view(view_from({2.5, 3.0, 4.0}, {{{0.0, 0.0, 1.0}, 0.05}}), ring, "torus_cut_flat");
  check_view(view_from({2.5, 3.0, 4.0}, {{{1.0, 0.0, 0.2}, 0.1}}), ring, "torus_cut_across");
  check_view(view_from({2.5, 3.0, 4.0}, {{{0.0, 0.0, 1.0}, 0.2}, {{1.0, 0.1, 0.0}, 0.1}}), hollow, "hollow_cut");
  check_view(view_from({2.5, 3.0, 4.0}, {{{0.0, 0.0, 1.0}, 0.2}}), nested, "nested_cut");
}

TEST_CASE("the eye inside the solid or in what was taken away") {
  View inside = view_from({0.1, 0.2, 0.3});
  inside.camera.look = {-0.7, 0.1, -1.0};
  inside.camera.fov_deg = 80.0;
  check_view(inside, cube(), "inside");
  inside.cuts = {{{0.0, 0.0, -1.0}, 0.6}};
  check_view(inside, cube(), "inside_kept");
  inside.cuts = {{{0.0, 0.0, 1.0}, 0.0}};
  check_view(inside, cube(), "inside_removed");
  inside.cuts = {{{0.0, 0.0, 1.0}, 0.299}};  // a thousandth in front of the eye
  check_view(inside, cube(), "inside_close");
  const voml::Mesh hollow = join(sphere(0.95, {0.0, 0.0, 0.0}, 10), sphere(0.7, {0.05, 0.0, 0.0}, 10), true);
  inside.cuts = {{{0.0, 0.0, -1.0}, 0.4}};
  check_view(inside, hollow, "inside_hollow");
}

TEST_CASE("an eye very near the surface") {
  View near = view_from({0.3, 0.2, 1.0005});
  near.camera.look = {0.3, 0.2, 0.0};
  const QuietValidation quiet;
  near.mesh = shared(cube());
  near.shading = runtime::Shading::none;
  const Picture picture = render(near, Show::position);
  const double half_height = 0.0005 * std::tan(15.0 / 180.0 * 3.14159265358979);
  const glm::vec4 top = color_at(picture, near.size_px.x / 2);  // the middle of the first row
  CHECK(top.x == doctest::Approx(0.3).epsilon(1e-6));
  CHECK(std::abs(top.y - (0.2 + half_height * 89.0 / 90.0)) < 3e-7);
  CHECK(top.z == 1.0f);
}

TEST_CASE("triangles of any size make the same picture") {
  const auto faces_of = [](int n, int m) {  // the cube, each face in n x m rectangles
    voml::Mesh mesh;
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, side = face % 2 == 0 ? 1 : -1;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size()), row = static_cast<std::uint32_t>(n + 1);
      for (int v = 0; v <= m; ++v) {
        for (int u = 0; u <= n; ++u) {
          glm::dvec3 p(0.0);
          p[axis] = side;
          p[(axis + 1) % 3] = side * (2.0 * u / n - 1.0);
          p[(axis + 2) % 3] = 2.0 * v / m - 1.0;
          mesh.positions.push_back(p);
        }
      }
      for (std::uint32_t v = 0; v < static_cast<std::uint32_t>(m); ++v) {
        for (std::uint32_t u = 0; u + 1 < row; ++u) {
          const std::uint32_t a = first + v * row + u;
          mesh.triangles.push_back({a, a + 1, a + row + 1});
          mesh.triangles.push_back({a, a + row + 1, a + row});
        }
      }
    }
    return mesh;
  };
  for (const glm::dvec3& eye : {glm::dvec3(3.0, 2.5, 5.0), glm::dvec3(0.3, 0.2, 0.1), glm::dvec3(0.0, 0.0, 4.0)}) {
    View view = view_from(eye, {});
    view.size_px = {400, 300};
    view.camera.look = {0.0, 0.05, 0.0};
    view.shading = runtime::Shading::none;
    const voml::Mesh large = faces_of(1, 1);
    view.mesh = shared(large);
    const Picture expected = render(view, Show::position);
    // Triangles of some 70, 10 and 1 pixels across, and slivers.
    for (const auto& division :
         {std::pair(4, 4), std::pair(30, 30), std::pair(250, 250), std::pair(120, 1), std::pair(1, 500)}) {
      const int n = division.first, m = division.second;
      const voml::Mesh fine = faces_of(n, m);
      view.mesh = shared(fine);
      const Picture picture = render(view, Show::position);
      std::size_t others = 0, off = 0;
      for (std::size_t i = 0; i < std::size_t{400} * 300; ++i) {
        const bool is_covered = expected.rgba[4 * i + 3] != 0.0f;
        if (is_covered != (picture.rgba[4 * i + 3] != 0.0f))
          ++others;
        else
          off += is_covered && glm::distance(color_at(expected, i), color_at(picture, i)) > 2e-5f;
      }
      CAPTURE(n);
      CAPTURE(m);
      CHECK(others <= 3);  // at the cube's outline, by rounding
      CHECK(off <= 3);     // at its edges, likewise
    }
  }
}

TEST_CASE("random cuts through a torus") {
  const voml::Mesh ring = torus(0.65, 0.3, 16);
  std::uint32_t state = 12345;
  const auto random = [&] {
    return static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) / 8388608.0 - 1.0;
  };
  for (int round = 0; round < 12; ++round) {
    View view = view_from({4.0 * random(), 4.0 * random(), 3.0});
    view.size_px = {64, 64};
    for (int cut = 0; cut <= round % 4; ++cut)
      view.cuts.push_back({{random(), random(), random()}, 0.4 * random() + 0.3});
    view.mesh = shared(ring);
    const QuietValidation quiet;
    CAPTURE(round);
    CHECK(compare_with_rays(view, ring, render(view, Show::position)) < 0.12);
  }
}

TEST_CASE("tiles meet without seams") {
  View view = view_from({3.0, 2.5, 5.0}, {{{1.0, 0.3, 2.0}, 0.2}});
  view.size_px = {2300, 30};
  view.mesh = shared(cube());
  view.camera.fov_deg = 2.0;
  view.shading = runtime::Shading::none;
  const QuietValidation quiet;
  CHECK(compare_with_rays(view, cube(), render(view, Show::position)) < 0.05);
}

TEST_CASE("positions lie on the faces of the cube to the bit, and never beyond") {
  const QuietValidation quiet;
  for (const glm::dvec3& eye : {glm::dvec3(7.0, 3.0, 1.5), glm::dvec3(-1.2, 0.4, -3.0), glm::dvec3(0.2, -9.0, 0.1)}) {
    View view = view_from(eye);
    view.size_px = {320, 200};
    const Picture picture = render(view, Show::position);
    std::size_t off = 0, beyond = 0;
    for (std::size_t i = 0; i < picture.rgba.size() / 4; ++i) {
      const glm::vec4 p = color_at(picture, i);
      if (p.a == 0.0f) continue;
      const float reach = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      off += reach < 1.0f ? 1 : 0;
      beyond += reach > 1.0f ? 1 : 0;
    }
    CHECK(off == 0);
    CHECK(beyond == 0);
  }
}

TEST_CASE("normals face the viewer, light comes from him") {
  const QuietValidation quiet;
  View view = view_from({3.0, 2.5, 5.0}, {{{1.0, 0.0, 0.0}, 0.5}});
  view.want_regions = true;
  const Picture normals = render(view, Show::normal);
  const Picture positions = render(view, Show::position);
  std::array<int, 3> seen{};
  for (std::size_t i = 0; i < normals.regions.size(); ++i) {
    if (normals.regions[i] == 0) continue;
    const glm::vec3 normal(color_at(normals, i)), p(color_at(positions, i));
    const int axis = p.x > 0.4999f ? 0 : p.y > 0.9999f ? 1 : 2;
    glm::vec3 expected(0.0f);
    expected[axis] = 1.0f;
    if (std::min({0.5f - p.x, 1.0f - p.y, 1.0f - p.z}) > 1e-5f) FAIL_CHECK("a position lies on no face");
    if (normal == expected) ++seen[static_cast<std::size_t>(axis)];
  }
  CHECK(seen[0] > 100);
  CHECK(seen[1] > 100);
  CHECK(seen[2] > 100);
  CHECK(std::ranges::count_if(normals.regions, [](std::uint32_t r) { return r != 0; }) <=
        seen[0] + seen[1] + seen[2] + 60);

  const Picture light = render(view, Show::light);
  const auto lit = std::ranges::find_if(light.regions, [](std::uint32_t r) { return r != 0; }) - light.regions.begin();
  const glm::dvec3 towards(color_at(light, static_cast<std::size_t>(lit)));
  CHECK(glm::length(towards) == doctest::Approx(1.0).epsilon(1e-6));
  const glm::dvec3 back = glm::normalize(view.camera.eye - view.camera.look);
  CHECK(glm::dot(towards, back) > 0.8);
  CHECK(glm::dot(towards, glm::cross(view.camera.up, back)) > 0.05);
  CHECK(color_at(light, static_cast<std::size_t>(lit)).a == 1.0f);
}

TEST_CASE("slices are exact") {
  const QuietValidation quiet;
  View view;
  view.size_px = {96, 64};
  view.want_regions = view.want_depth = true;
  view.slice = Plane{{0.0, 0.0, 2.0}, 0.5};  // z = 0.25
  const Picture picture = render(view, Show::position);
  std::size_t wrong = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * 96 + static_cast<std::size_t>(x);
      const double px = (x + 0.5 - 48.0) / 32.0, py = (32.0 - y - 0.5) / 32.0;
      const glm::vec4 expected = std::abs(px) <= 1.0 ? glm::vec4(px, py, 0.25, 1.0) : glm::vec4(0.0);
      wrong += color_at(picture, i) != expected ? 1 : 0;
      wrong += picture.regions[i] != (std::abs(px) > 1.0 ? 0u : px <= 0.25 ? 1u : 2u) ? 1 : 0;
      wrong += picture.depth[i] != (std::abs(px) > 1.0 ? INFINITY : 0.0f) ? 1 : 0;
    }
  }
  CHECK(wrong == 0);
  view.slice = Plane{{1.0, 0.0, 0.0}, 1.0};  // a face of the closed cube belongs to it
  const Picture face = render(view, Show::position);
  CHECK(color_at(face, 32 * 96 + 48) == glm::vec4(1.0f, -1.0f / 64, -1.0f / 64, 1.0f));
  view.slice = Plane{{1.0, 0.0, 0.0}, 1.001};
  CHECK(std::ranges::all_of(render(view, Show::position).rgba, [](float value) { return value == 0.0f; }));
}

TEST_CASE("samples are averaged by their alpha") {
  const QuietValidation quiet;
  View view;
  view.slice = Plane{{0.0, 0.0, 1.0}, 0.0};
  view.size_px = {24, 16};  // the cube ends in the middle of no pixel
  view.samples = 3;
  view.want_regions = true;
  const Picture picture = render(view, Show::position);
  CHECK(picture.size_px == glm::uvec2(24, 16));
  const glm::vec4 inner = color_at(picture, 8 * 24 + 12);  // the mean of a pixel's positions is its middle
  CHECK(inner.x == doctest::Approx(0.0625).epsilon(1e-5));
  CHECK(inner.y == doctest::Approx(-0.0625).epsilon(1e-5));
  CHECK(inner.a == 1.0f);

  view.size_px = {5, 4};
  view.samples = 2;  // a pixel is 0.5 wide; pixel 0 covers x from -1.25 to -0.75: its right half is in the cube
  const Picture edge = render(view, Show::position);
  const glm::vec4 left = color_at(edge, 5);
  CHECK(left.a == 0.5f);
  CHECK(left.x == doctest::Approx(-0.875).epsilon(1e-5));
  CHECK(edge.regions[5] == 0);  // its sample (0, 0) is outside
  CHECK(edge.regions[6] == 1);
}

TEST_CASE("two renders give the same bytes") {
  const QuietValidation quiet;
  const voml::Mesh ring = torus(0.65, 0.3, 24);
  View view = view_from({2.5, 3.0, 4.0}, {{{0.0, 0.0, 1.0}, 0.05}, {{1.0, 0.0, 0.0}, 0.3}});
  view.mesh = shared(ring);
  view.want_regions = view.want_depth = true;
  const Picture first = render(view, Show::checker);
  auto evaluator = must(runtime::Evaluator::create(device(), program(Show::checker)));
  View other = view_from({3.0, 2.5, 5.0});
  must(evaluator.render(other));  // what was drawn before leaves no trace
  const Picture second = must(evaluator.render(view));
  CHECK(first.rgba == second.rgba);
  CHECK(first.regions == second.regions);
  CHECK(first.depth == second.depth);
}

TEST_CASE("bytes are the floats of the same picture, rounded to the nearest") {
  const QuietValidation quiet;
  const voml::Mesh ring = torus(0.65, 0.3, 24);
  for (const bool sliced : {false, true}) {
    for (const std::uint32_t samples : {1u, 2u}) {
      View view = view_from({2.5, 3.0, 4.0}, {{{0.0, 0.0, 1.0}, 0.05}});
      view.mesh = shared(ring);
      if (sliced) view.slice = Plane{{0.3, 0.0, 1.0}, 0.1};
      view.samples = samples;
      view.want_regions = true;
      const Picture floats = render(view, Show::normal);
      view.colors = runtime::Colors::bytes;
      const Picture bytes = render(view, Show::normal);
      CHECK(bytes.rgba.empty());
      CHECK(floats.rgba8.empty());
      CHECK(bytes.regions == floats.regions);
      REQUIRE(bytes.rgba8.size() == floats.rgba.size());
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < floats.rgba.size(); ++i)
        wrong += bytes.rgba8[i] != runtime::to_byte(floats.rgba[i]) ? 1 : 0;
      CHECK(wrong == 0);
    }
  }
  CHECK(runtime::to_byte(NAN) == 0);
  CHECK(runtime::to_byte(-1.0f) == 0);
  CHECK(runtime::to_byte(0.5f / 255.0f) == 1);
  CHECK(runtime::to_byte(7.0f) == 255);
}

TEST_CASE("a frame that keeps what stands still is the frame drawn anew, whatever changes and in whatever order") {
  const QuietValidation quiet;
  const voml::Mesh ring = torus(0.65, 0.3, 24), ball = sphere(0.9, glm::dvec3(0.0), 12);
  std::vector<View> views;
  const auto add = [&](auto change) {
    View view = view_from({2.5, 3.0, 4.0}, {{{0.0, 0.0, 1.0}, 0.05}});
    view.mesh = shared(ring);
    view.want_regions = view.want_depth = view.want_positions = true;
    change(view);
    views.push_back(view);
  };
  add([](View&) {});
  add([](View& v) { v.shading = runtime::Shading::lit; });
  add([](View& v) { v.camera.eye.x += 1e-3; });
  add([](View& v) { v.cuts.clear(); });
  add([](View& v) { v.cuts[0].d = 0.06; });
  add([&](View& v) { v.mesh = shared(ball); });
  add([](View& v) { v.slice = Plane{{0.0, 0.0, 1.0}, 0.0}; });
  add([](View& v) { v.slice = Plane{{0.0, 0.0, 1.0}, 1e-6}; });
  add([](View& v) { v.size_px.x -= 8; });
  add([](View& v) { v.colors = runtime::Colors::bytes; });
  add([](View& v) { v.want_depth = v.want_positions = false; });
  add([](View& v) { v.samples = 2; });
  std::vector<Picture> expected;
  for (const View& view : views) expected.push_back(render(view, Show::checker));

  auto evaluator = must(runtime::Evaluator::create(device(), program(Show::checker)));
  for (std::size_t step : {1u, 5u, 7u}) {  // coprime with the number of views: each follows each in some round
    for (std::size_t i = 0, at = 0; i < 2 * views.size();
         ++i, at = (at + (i % 2) * step) % views.size()) {  // each twice
      for (const auto& disabled : {std::vector<std::string>{},
                                   {"keep-picture"},
                                   {"keep-surface", "keep-picture"},
                                   {"pixel-list"},
                                   {"keep-surface", "clusters"}}) {
        View view = views[at];
        view.disabled_passes = disabled;
        const Picture picture = must(evaluator.render(view));
        CAPTURE(at);
        CHECK(picture.rgba == expected[at].rgba);
        CHECK(picture.rgba8 == expected[at].rgba8);
        CHECK(picture.regions == expected[at].regions);
        CHECK(picture.depth == expected[at].depth);
      }
    }
  }
  CHECK(runtime::frame_pass_names().size() == 8);  // the others: tests/render/frames_test.cpp
}

/// With a loose triangle of no size: not closed any more, so it is drawn from both sides.
voml::Mesh opened(voml::Mesh mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), 3, glm::dvec3(mesh.positions.front()));
  mesh.triangles.push_back({first, first + 1, first + 2});
  return mesh;
}

TEST_CASE("turned away triangles that are not drawn would not have been seen") {
  const QuietValidation quiet;
  const auto ball = [](double radius, double x) { return sphere(radius, {x, 0.0, 0.0}, 12); };
  const voml::Mesh hollow = join(ball(0.9, 0.0), ball(0.6, 0.05), true);
  const std::vector<voml::Mesh> meshes{torus(0.65, 0.3, 24), hollow, join(ball(0.7, -0.2), ball(0.7, 0.3), false),
                                       join(ball(0.4, -0.5), ball(0.4, 0.5), true)};  // the last one inside out
  const std::vector<std::vector<Plane>> cuts{
      {}, {{{0.0, 0.3, 1.0}, 0.1}}, {{{0.0, 0.0, -1.0}, 0.1}, {{1.0, 0.2, 0.0}, 0.3}}};
  auto evaluator = must(runtime::Evaluator::create(device(), program(Show::normal)));
  for (const voml::Mesh& mesh : meshes) {
    for (const auto& planes : cuts) {
      for (const glm::dvec3& eye :
           {glm::dvec3(2.5, 3.0, 4.0), glm::dvec3(-4.0, 0.2, 0.5), glm::dvec3(0.65, 0.05, 0.0)}) {
        View view = view_from(eye, planes);
        view.camera.look = {-0.1, 0.02, 0.3};
        view.mesh = shared(mesh);
        view.want_regions = view.want_positions = true;
        view.disabled_passes = {"keep-surface"};
        const Picture fronts = must(evaluator.render(view));
        const voml::Mesh both_sides = opened(mesh);
        view.mesh = shared(both_sides);
        const Picture all = must(evaluator.render(view));
        std::size_t differing = 0, covered = 0;  // at a silhouette, rounding may put a back before its front
        for (std::size_t i = 0; i < all.regions.size(); ++i) {
          covered += all.regions[i] != 0;
          differing += all.regions[i] != 0 && all.positions[i] != fronts.positions[i];
          CHECK((all.regions[i] != 0) == (fronts.regions[i] != 0));
        }
        CHECK(differing <= covered / 1000);
      }
    }
  }
}

TEST_CASE("an open mesh is drawn from both sides, and its cut says so") {
  const QuietValidation quiet;
  voml::Mesh open = voml::standard_cube();
  std::erase_if(open.triangles, [&](const glm::uvec3& t) {
    return open.positions[t.x].z > 0 && open.positions[t.y].z > 0 && open.positions[t.z].z > 0;
  });
  REQUIRE(open.triangles.size() == 10);
  View view = view_from({0.3, 0.2, 5.0});
  view.mesh = shared(open);
  const Picture inside = render(view, Show::normal);
  const glm::vec4 back = color_at(inside, 45 * 121 + 60);  // through the missing front: the inside of the back
  CHECK(back == glm::vec4(0.0f, 0.0f, 1.0f, 1.0f));
  view.cuts = {{{0.0, 1.0, 0.0}, 0.5}};
  CHECK(render(view, Show::position).edges.open.count == 4);
}

TEST_CASE("views that cannot be drawn are refused with the numbers") {
  auto evaluator = must(runtime::Evaluator::create(device(), program(Show::position)));
  const auto refusal = [&](const View& view) {
    const auto picture = evaluator.render(view);
    REQUIRE_FALSE(picture);
    CHECK(picture.error().fault == Fault::input);
    return picture.error().message;
  };
  View view = view_from({3.0, 2.5, 5.0});
  view.size_px = {9000, 20};
  view.samples = 2;
  CHECK(refusal(view).find("18000 pixels long; this device draws at most 16384") != std::string::npos);
  view = view_from({3.0, 2.5, 5.0});
  view.size_px = {0, 20};
  CHECK(refusal(view).find("0x20") != std::string::npos);
  view = view_from({3.0, 2.5, 5.0});
  view.cuts.assign(65, {{0.0, 0.0, 1.0}, 0.0});
  CHECK(refusal(view) == "65 cuts were asked for; at most 64 can be drawn");
  view.cuts = {{{0.0, 0.0, 1.0}, 0.0}, {{0.0, 0.0, 0.0}, 0.0}};
  CHECK(refusal(view).find("cut 2 has a normal of length 0") != std::string::npos);
  view = view_from({0.05, 0.02, 0.0});
  CHECK(refusal(view).find("looks at a point 0 away") != std::string::npos);
  voml::Mesh broken = voml::standard_cube();
  broken.triangles[3].y = 8;
  view = view_from({3.0, 2.5, 5.0});
  view.mesh = shared(broken);
  CHECK(refusal(view) == "triangle 3 of the support mesh refers to vertex 8 of 8");

  auto endless = must(runtime::Evaluator::create(device(), program(Show::unfinished)));
  const auto picture = endless.render(view_from({3.0, 2.5, 5.0}));
  REQUIRE_FALSE(picture);
  CHECK(picture.error().message.find("pixels needed more loop rounds") != std::string::npos);
}

TEST_CASE("times are told: the driver's compilation once, the frame each time") {
  runtime::Timings timings;
  auto evaluator = must(runtime::Evaluator::create(device(), program(Show::checker), &timings));
  must(evaluator.render(view_from({3.0, 2.5, 5.0}), &timings));
  must(evaluator.render(view_from({3.0, 2.5, 4.0}), &timings));
  std::vector<std::string> steps;
  for (const runtime::Timing& timing : timings) steps.push_back(timing.step);
  CHECK(steps == std::vector<std::string>{"upload", "pipeline", "gpu", "frame", "gpu", "frame"});
  for (const std::size_t gpu : {std::size_t{2}, std::size_t{4}}) {
    CHECK(timings[gpu].ms > 0.0);
    CHECK(timings[gpu].ms <= timings[gpu + 1].ms);
  }
}
