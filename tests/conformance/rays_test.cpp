// Pictures by rays against the reference's rays, on all conformance scenes.
#include <doctest/doctest.h>
#include <fmt/format.h>

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
  compiler::CompileOptions options;
  options.codegen = codegen;
  options.rays = true;
  const compiler::Program program = tests::compiled(module, options);
  auto evaluator = runtime::Evaluator::create(device(), program).value();
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
  for (const auto& [name, objects] : scenes) {
    for (const compiler::Codegen codegen : {compiler::Codegen::automatic, compiler::Codegen::table}) {
      const tests::RayAgreement found = media_of(objects, codegen);
      INFO(name, ": ", found.rays, " rays, ", found.uncertain, " uncertain, ", found.doubtful, " in doubt");
      CHECK(found.rays - found.uncertain - found.doubtful > found.rays * 9 / 10);
      CHECK(found.largest_color_error <= 1e-5);
    }
  }
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}

TEST_CASE("rays of every kind of scene meet what the reference's rays meet, where they meet it") {
  constexpr std::size_t every = 199;  // prime to the picture's width
  for (const tests::SceneCase& scene : tests::conformance_scenes()) {
    const auto module = tests::lowered(scene.text, scene.files);
    const compiler::RayReference reference(module);
    for (const compiler::Codegen codegen : {compiler::Codegen::automatic, compiler::Codegen::table}) {
      CAPTURE(scene.name);
      CAPTURE(static_cast<int>(codegen));
      compiler::CompileOptions options;
      options.codegen = codegen;
      options.rays = true;
      const compiler::Program program = tests::compiled(module, options);
      auto evaluator = runtime::Evaluator::create(device(), program).value();
      tests::RayAgreement all;
      for (runtime::View view : views()) {
        for (const double time_ms : tests::times_of(program)) {
          view.time_ms = time_ms;
          const auto picture = evaluator.render(view);
          REQUIRE_MESSAGE(picture, picture.error().message);
          all.add(tests::compare_rays(reference, program, view, *picture, every));
        }
      }
      MESSAGE(scene.name << ": " << all.rays << " rays, " << all.uncertain << " uncertain, " << all.doubtful
                         << " in doubt, off by " << all.largest_error);
      CHECK_MESSAGE(all.wrong == 0, all.wrong << " wrong; " << all.first);
    }
  }
  const auto messages = device().validation_messages();
  CHECK_MESSAGE(messages.empty(), messages.front());
}
