// Pictures by rays against the reference's rays, on all conformance scenes.
#include <doctest/doctest.h>

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
