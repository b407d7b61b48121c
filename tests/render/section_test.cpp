// A cut that faces the camera: where the section lies on the screen follows from the camera alone.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <glm/common.hpp>

#include "compiler/reference/reference.h"
#include "tests/render/render_scenes.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

constexpr glm::uvec2 size_px{80, 60};
constexpr double eye_z = 5.0;
constexpr double fov_deg = 40.0;
constexpr double pi = 3.14159265358979323846;

/// Where the ray through a pixel's middle meets the plane z = 0.
glm::dvec3 on_section(std::uint32_t x, std::uint32_t y) {
  const double half_height = eye_z * std::tan(fov_deg / 2 * pi / 180);
  const double pixel = 2 * half_height / size_px.y;
  return {(x + 0.5 - size_px.x / 2.0) * pixel, -(y + 0.5 - size_px.y / 2.0) * pixel, 0.0};
}

/// The region at p, if it is the same all around p: rasterised positions are good to some 1e-6.
std::optional<std::uint32_t> steady_region(const compiler::Reference& reference, const glm::dvec3& p) {
  constexpr double error = 1e-5;
  const compiler::ReferenceAnswer middle = reference.evaluate(p);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 d(corner & 1 ? error : -error, corner & 2 ? error : -error, corner & 4 ? error : -error);
    const compiler::ReferenceAnswer around = reference.evaluate(p + d);
    if (!around.certain || around.number != middle.number) return {};
  }
  return middle.number;
}

}  // namespace

TEST_CASE("a capped section shows the scene on its plane, at the plane's depth") {
  const Folder folder;
  for (const RenderScene& scene : write_render_scenes(folder)) {
    CAPTURE(scene.name);
    const compiler::Module module = tests::lowered_file(scene.path);
    const compiler::Reference reference(module);
    for (const std::string codegen : {"specialised", "table"}) {
      CAPTURE(codegen);
      const Run run = run_dmvv({"render", scene.path, "-o", folder.file("p.png"), "--size",
                                fmt::format("{}x{}", size_px.x, size_px.y), "--camera",
                                fmt::format("eye 0 0 {} look 0 0 0 fov {}", eye_z, fov_deg), "--cut", "0 0 1 0",
                                "--shading", "none", "--codegen", codegen, "--validation", "--aov",
                                fmt::format("region={},depth={}", folder.file("r.exr"), folder.file("z.exr"))});
      REQUIRE_MESSAGE(run.exit_code == 0, run.err);
      const auto regions = read_regions(folder.file("r.exr"));
      const auto depth = read_depth(folder.file("z.exr"));
      std::size_t compared = 0, wrong_regions = 0, wrong_depths = 0;
      for (std::uint32_t y = 0; y < size_px.y; ++y) {
        for (std::uint32_t x = 0; x < size_px.x; ++x) {
          const glm::dvec3 p = on_section(x, y);
          if (std::max(std::abs(p.x), std::abs(p.y)) > 0.999) continue;  // beside the cube, or its edge
          const auto expected = steady_region(reference, p);
          if (!expected) continue;
          ++compared;
          const std::size_t pixel = x + std::size_t{size_px.x} * y;
          wrong_regions += regions[pixel] != *expected;
          wrong_depths += *expected == 0 ? !std::isinf(depth[pixel]) : std::abs(depth[pixel] - eye_z) > 1e-4;
        }
      }
      CHECK(wrong_regions == 0);
      CHECK(wrong_depths == 0);
      CHECK(compared > 900);  // the section covers some 33 x 33 pixels
    }
  }
}
