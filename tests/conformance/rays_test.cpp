// Pictures by rays against the reference's rays, on all conformance scenes.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "runtime/runtime.h"
#include "tests/support/agreement.h"
#include "tests/support/rays.h"
#include "tests/support/scene_table.h"

using namespace dmvv;

namespace {

runtime::Device& device() {
  static runtime::Device opened = runtime::Device::create({.name = "", .validation = true}).value();
  return opened;
}

runtime::View view_of(const glm::dvec3& eye, std::vector<runtime::Plane> cuts) {
  runtime::View view;
  view.size_px = {160, 120};
  view.camera = {.eye = eye, .look = {0.05, 0.02, 0.0}, .up = {0.0, 1.0, 0.0}, .fov_deg = 30.0};
  view.cuts = std::move(cuts);
  view.rays = view.want_regions = view.want_depth = view.want_doubt = true;
  return view;
}

struct Drawn {
  compiler::Program program;
  runtime::Evaluator evaluator;
};
Drawn drawn(const compiler::Module& module, compiler::Codegen codegen) {
  compiler::CompileOptions options;
  options.codegen = codegen;
  options.rays = true;
  compiler::Program program = tests::compiled(module, options);
  auto evaluator = runtime::Evaluator::create(device(), program).value();
  return {std::move(program), std::move(evaluator)};
}

/// Whole, cut, and from within.
std::vector<runtime::View> views() {
  return {view_of({2.0, 1.5, 4.0}, {}), view_of({-1.0, 2.0, 4.0}, {{{0.0, 0.3, 1.0}, 0.1}}),
          view_of({0.4, 0.3, 0.9}, {{{0.0, 0.0, 1.0}, 0.1}})};
}

}  // namespace

namespace {

/// A ball in the middle of the cube, of one region; nothing around it.
std::string ball(const std::string& name, double radius, const std::string& region) {
  return fmt::format(
      "<OBJECT name='{0}'><SDF name='S' function='true'>return length(p) - {1};</SDF>{2}<REGION name='OUT' "
      "type='empty'/>"
      "<MAPPINGS><SDF name='S'><POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT>",
      name, radius, region);
}
std::string region(const std::string& rgb, double opacity, const std::string& embedded = "") {
  return fmt::format("<REGION name='IN' type='color' rgb='{}' opacity='{}'>{}</REGION>", rgb, opacity, embedded);
}

/// Draws the scene unlit, and tells what differs from the reference.
tests::RayAgreement media_of(const std::string& objects, compiler::Codegen codegen) {
  const auto module = tests::lowered("<MVV>" + objects + "</MVV>");
  const compiler::RayReference reference(module);
  auto [program, evaluator] = drawn(module, codegen);
  tests::RayAgreement all;
  for (runtime::View view : views()) {
    view.shading = runtime::Shading::none;
    view.want_regions = view.want_depth = true;
    const auto picture = evaluator.render(view);
    REQUIRE_MESSAGE(picture, picture.error().message);
    all.add(tests::compare_rays(reference, program, view, *picture, 31));
  }
  return all;
}

}  // namespace

TEST_CASE(
    "media: what is seen of slabs, balls in each other, and a glass cell with organelles is what the reference sees") {
  const std::string dot = ball("DOT", 0.9, region("0.9 0.2 0.1", 1.0));
  const std::string nucleus = ball(
      "NUCLEUS", 0.9, region("0.3 0.2 0.8", 0.6, "<EMBEDDED name='DOT' scale='0.3 0.3 0.3' translate='0.2 0.1 0'/>"));
  const std::map<std::string, std::string> scenes{
      {"slab", "<OBJECT name='A'>" + region("0.2 0.9 0.4", 0.37) + "</OBJECT>"},
      {"balls", ball("SMALL", 0.7, region("0.1 0.2 0.9", 0.8)) +
                    ball("LARGE", 0.9, region("0.9 0.8 0.1", 0.3, "<EMBEDDED name='SMALL' scale='0.6 0.6 0.6'/>"))},
      {"glass cell", dot + nucleus +
                         ball("CELL", 0.85,
                              region("0.5 0.8 0.7", 0.45,
                                     "<EMBEDDED name='NUCLEUS' scale='0.4 0.4 0.4' translate='0.1 0.1 0.1'/>"
                                     "<EMBEDDED name='DOT' scale='0.1 0.2 0.1' translate='0.1 -0.5 0.2'/>"))},
      {"thin glass before a wall",
       "<OBJECT name='A'><SDF name='S' function='true'>return abs(p.z - 0.5) - 0.001;</SDF>"
       "<SDF name='W' function='true'>return p.z + 0.5;</SDF>" +
           region("0.2 0.4 0.9", 0.999) +
           "<REGION name='WALL' type='color' rgb='0.9 0.9 0.8'/><REGION name='OUT' type='empty'/>"
           "<MAPPINGS><SDF name='W'><NEGATIVE region='WALL'/><POSITIVE><SDF name='S'><POSITIVE region='OUT'/>"
           "<NEGATIVE region='IN'/></SDF></POSITIVE></SDF></MAPPINGS></OBJECT>"}};
  for (const auto& scene : scenes) {
    for (const compiler::Codegen codegen : {compiler::Codegen::automatic, compiler::Codegen::table}) {
      const tests::RayAgreement found = media_of(scene.second, codegen);
      CAPTURE(scene.first);
      INFO(found.rays, " rays, ", found.uncertain, " uncertain, ", found.doubtful, " in doubt");
      CHECK(found.rays - found.uncertain - found.doubtful > found.rays * 9 / 10);
      CHECK(found.largest_color_error <= 1e-5);
    }
  }
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}

namespace {

/// The distance from the origin of a ray's points, cut to a ball: whether it comes within `radius` of the origin there.
struct ThinThing {
  std::string name, distance;
  /// Whether the ray meets what is where |distance| <= half, in the ball of radius 0.8 around the origin.
  std::function<bool(const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& axis, double half)> meets;
};

bool crosses_plate(const glm::dvec3& o, const glm::dvec3& d, const glm::dvec3& n, double) {
  const double t = -glm::dot(o, n) / glm::dot(d, n);
  return glm::length(o + t * d) < 0.79;
}
bool crosses_thread(const glm::dvec3& o, const glm::dvec3& d, const glm::dvec3& n, double half) {
  const glm::dvec3 across = glm::cross(d, n);
  const double gap = std::abs(glm::dot(o, across)) / glm::length(across);
  const double t = glm::dot(glm::cross(-o, n), across) / glm::dot(across, across);
  return gap < 0.9 * half && glm::length(o + t * d) < 0.79;
}
bool crosses_shell(const glm::dvec3& o, const glm::dvec3& d, const glm::dvec3&, double) {
  const double t = -glm::dot(o, d) / glm::dot(d, d);
  return glm::length(o + t * d) < 0.59;
}

}  // namespace

TEST_CASE("nothing thin is lost: plates, threads and shells of any width are seen, or the ray is in doubt") {
  const std::vector<ThinThing> things{{"plate", "abs(dot(p, n))", crosses_plate},
                                      {"thread", "length(p - n * dot(p, n))", crosses_thread},
                                      {"shell", "abs(length(p) - 0.6)", crosses_shell}};
  for (const ThinThing& thing : things) {
    std::size_t met = 0, seen = 0, lost = 0;
    for (const double width : {0.2, 2e-2, 2e-3, 2e-4, 2e-5, 2e-6}) {
      // The axis turns with time: its slopes are the same at all times.
      const auto module = tests::lowered(fmt::format(
          "<MVV><OBJECT name='A'><SDF name='S' function='true'>vec3 n = vec3(sin(t), cos(t) * cos(2.0 * t), cos(t) * "
          "sin(2.0 * "
          "t)); return max({} - {}, length(p) - 0.8);</SDF>{}<REGION name='OUT' type='empty'/><MAPPINGS><SDF name='S'>"
          "<POSITIVE region='OUT'/><NEGATIVE region='IN'/></SDF></MAPPINGS></OBJECT></MVV>",
          thing.distance, 0.5 * width, region("1 0 0", 1.0)));
      auto [program, evaluator] = drawn(module, compiler::Codegen::automatic);
      runtime::View view = view_of({2.0, 1.5, 4.0}, {});
      view.shading = runtime::Shading::none;
      for (const double time_ms : {0.0, 0.7, 1.4, 2.1, 2.9}) {
        view.time_ms = time_ms;
        const auto picture = evaluator.render(view);
        REQUIRE_MESSAGE(picture, picture.error().message);
        const runtime::RayFrame frame = runtime::plan_frame_setup(view, program.content, 16384)->rays.value();
        const glm::dvec3 axis(std::sin(time_ms), std::cos(time_ms) * std::cos(2.0 * time_ms),
                              std::cos(time_ms) * std::sin(2.0 * time_ms));
        for (std::size_t i = 0; i < picture->regions.size(); ++i) {
          const glm::dvec3 direction =
              frame.corner + double(i % view.size_px.x) * frame.step_x + double(i / view.size_px.x) * frame.step_y;
          if (!thing.meets(frame.eye, direction, axis, 0.5 * width)) continue;
          ++met;
          seen += picture->regions[i] != 0 ? 1 : 0;
          lost += picture->regions[i] == 0 && picture->doubt[i] == 0 ? 1 : 0;
        }
      }
      if (width >= 2e-3) CHECK(seen == met);  // wider than the least step
    }
    INFO(thing.name, ": ", met, " rays meet it, ", seen, " see it");
    CHECK(met > 1000);
    CHECK(lost == 0);
  }
}

TEST_CASE("what rays meet faces along its gradient, whatever frames it stands in; sections face as their plane does") {
  // An ellipsoid: a ball in a turned and unevenly scaled frame within another one.
  const auto module = tests::lowered(
      "<MVV>" + ball("BALL", 0.8, region("1 0 0", 1.0)) +
      "<OBJECT name='A'><REGION name='R' type='empty'><EMBEDDED name='BALL' scale='0.8 0.5 0.3' rotate='20 30 40' "
      "translate='0.1 0 0'/></REGION></OBJECT></MVV>");
  for (const compiler::Codegen codegen : {compiler::Codegen::automatic, compiler::Codegen::table}) {
    auto [program, evaluator] = drawn(module, codegen);
    runtime::View view = view_of({2.0, 1.5, 4.0}, {{{0.0, 0.0, 1.0}, 0.15}});
    view.want_normals = view.want_positions = true;
    const auto picture = evaluator.render(view);
    REQUIRE_MESSAGE(picture, picture.error().message);
    const auto embedding = std::ranges::find_if(module.regions, [](const auto& r) { return !r.groups.empty(); });
    const compiler::Affine& affine = embedding->groups.front().candidates.front().local_from_parent;
    std::size_t surfaces = 0, sections = 0;
    for (std::size_t i = 0; i < picture->normals.size(); ++i) {
      if (picture->regions[i] == 0) continue;
      const glm::dvec3 p(picture->positions[i]), normal(picture->normals[i]);
      CHECK(glm::length(normal) == doctest::Approx(1.0).epsilon(1e-5));
      const bool is_section = p.z > 0.15 - 1e-6;
      const glm::dvec3 expected = is_section ? glm::dvec3(0.0, 0.0, 1.0) : glm::normalize(affine(p) * affine.linear);
      CHECK(glm::distance(normal, expected) < 1e-3);  // 15 bits an axis, and differences of float32
      (is_section ? sections : surfaces) += 1;
    }
    CHECK(surfaces > 500);
    CHECK(sections > 100);
  }
}

TEST_CASE("rays of every kind of scene meet what the reference's rays meet, where they meet it") {
  constexpr std::size_t every = 199;  // prime to the picture's width
  for (const tests::SceneCase& scene : tests::conformance_scenes()) {
    const auto module = tests::lowered(scene.text, scene.files);
    const compiler::RayReference reference(module);
    for (const compiler::Codegen codegen : {compiler::Codegen::automatic, compiler::Codegen::table}) {
      CAPTURE(scene.name);
      CAPTURE(static_cast<int>(codegen));
      auto [program, evaluator] = drawn(module, codegen);
      tests::RayAgreement all;
      for (runtime::View view : views()) {
        for (const double time_ms : tests::times_of(program)) {
          view.time_ms = time_ms;
          const auto picture = evaluator.render(view);
          REQUIRE_MESSAGE(picture, picture.error().message);
          const bool is_first = codegen == compiler::Codegen::automatic;
          all.add(tests::compare_rays(reference, program, view, *picture, is_first ? every : 3 * every));
        }
      }
      CHECK_MESSAGE(all.wrong == 0, all.wrong << " wrong; " << all.first);
    }
  }
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}
