// Pictures on a surface that was prepared for them, for other ones, or not at all: the same to the bit.
#include <doctest/doctest.h>

#include <future>

#include "runtime/runtime.h"
#include "tests/render/render_scenes.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

std::shared_future<Result<runtime::Device>> opened() {
  std::promise<Result<runtime::Device>> promise;
  promise.set_value(device());
  return promise.get_future().share();
}

runtime::View cut_open(double at) {
  runtime::View view;
  view.size_px = {160, 90};
  view.camera.eye = {2.0, 1.5, 4.0};
  view.cuts = {{{0.0, 0.0, 1.0}, at}};
  view.want_regions = view.want_depth = true;
  return view;
}

const char* const ball =
    "<MVV><OBJECT name='O'><SDF name='S' function='true'>return length(p) - 0.8;</SDF>"
    "<REGION name='IN' type='color' rgb='1 0.5 0'/><REGION name='OUT' type='color' rgb='0 0 1'/>"
    "<MAPPINGS name='O'><SDF name='S'><POSITIVE><REGION name='OUT'/></POSITIVE><NEGATIVE><REGION "
    "name='IN'/></NEGATIVE></SDF>"
    "</MAPPINGS></OBJECT></MVV>";

}  // namespace

TEST_CASE("a prepared surface changes no picture") {
  const compiler::Program program = tests::compiled(tests::lowered(ball, {}), {});
  auto plain = runtime::Evaluator::create(device(), program).value();
  const runtime::View view = cut_open(0.1);
  const auto expected = plain.render(view);
  REQUIRE(expected);

  runtime::View larger = view, slice = view;
  larger.size_px = {200, 200};
  larger.samples = 2;
  larger.cuts.clear();
  slice.slice = runtime::Plane{{0.0, 0.0, 1.0}, 0.1};
  for (const runtime::View& prepared : {view, larger, slice}) {
    auto surface = runtime::PreparedSurface::prepare_async(opened(), prepared).get();
    REQUIRE(surface);
    auto evaluator = runtime::Evaluator::create(device(), program, nullptr, std::move(*surface)).value();
    const auto got = evaluator.render(view);
    REQUIRE(got);
    CHECK(got->rgba == expected->rgba);
    CHECK(got->regions == expected->regions);
    CHECK(got->depth == expected->depth);
  }
  CHECK(device().validation_messages().empty());
}

TEST_CASE("what cannot be drawn is refused by the surface as by the picture") {
  const compiler::Program program = tests::compiled(tests::lowered(ball, {}), {});
  auto plain = runtime::Evaluator::create(device(), program).value();
  voml::Mesh broken = voml::standard_cube();
  broken.triangles.front().x = 1000;
  runtime::View bad_mesh = cut_open(0.1), bad_camera = cut_open(0.1);
  bad_mesh.mesh = std::make_shared<const voml::Mesh>(broken);
  bad_camera.camera.look = bad_camera.camera.eye;
  for (const runtime::View& view : {bad_mesh, bad_camera}) {
    const auto surface = runtime::PreparedSurface::prepare_async(opened(), view).get();
    const auto picture = plain.render(view);
    REQUIRE(!surface);
    REQUIRE(!picture);
    CHECK(surface.error().message == picture.error().message);
  }
}

TEST_CASE("a device that cannot be opened leaves no surface") {
  const auto opening = runtime::Device::create_async({.name = "no such device"});
  const auto surface = runtime::PreparedSurface::prepare_async(opening, cut_open(0.1)).get();
  REQUIRE(!surface);
  CHECK(surface.error().message == opening.get().error().message);
}
