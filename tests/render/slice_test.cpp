// Slices through small scenes, pixel by pixel against the reference evaluator: pixel centres are known exactly.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <set>

#include "compiler/reference/reference.h"
#include "runtime/view/view.h"
#include "tests/render/render_scenes.h"
#include "tests/support/scenes.h"

using namespace dmvv;
using namespace dmvv::tests;

namespace {

constexpr glm::uvec2 size_px{96, 64};

struct Slice {
  std::vector<std::uint32_t> regions;
  std::vector<std::uint8_t> rgba;
};

Slice render_slice(const Folder& folder, const RenderScene& scene, const std::string& plane,
                   const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"render",      scene.path,
                                     "-o",          folder.file("p.png"),
                                     "--size",      fmt::format("{}x{}", size_px.x, size_px.y),
                                     "--slice",     plane,
                                     "--aov",       "region=" + folder.file("r.exr"),
                                     "--validation"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Run run = run_dmvv(arguments);
  REQUIRE_MESSAGE(run.exit_code == 0, run.err);
  CHECK(run.err.empty());  // no validation message
  return {read_regions(folder.file("r.exr")), read_rgba8(folder.file("p.png"))};
}

/// Compares every pixel whose answer float32 cannot change. Returns the region numbers seen.
std::set<std::uint32_t> compare(const Slice& slice, const std::string& plane, const compiler::Reference& reference) {
  const runtime::SliceFrame frame = runtime::slice_frame(runtime::parse_slice(plane).value(), size_px);
  std::set<std::uint32_t> seen;
  std::size_t uncertain = 0, wrong_regions = 0, wrong_colours = 0;
  std::string first_wrong;
  for (std::uint32_t y = 0; y < size_px.y; ++y) {
    for (std::uint32_t x = 0; x < size_px.x; ++x) {
      const glm::dvec3 p = frame.origin + double(x) * frame.step_x + double(y) * frame.step_y;
      const compiler::ReferenceAnswer expected = reference.evaluate(p);
      if (!expected.certain) {
        ++uncertain;
        continue;
      }
      const std::size_t pixel = x + std::size_t{size_px.x} * y;
      seen.insert(expected.number);
      if (slice.regions[pixel] != expected.number) {
        if (wrong_regions++ == 0) {
          first_wrong = fmt::format("pixel {} {} at ({} {} {}): region {} instead of {}", x, y, p.x, p.y, p.z,
                                    slice.regions[pixel], expected.number);
        }
        continue;
      }
      for (int channel = 0; channel < 4; ++channel) {
        const double shown = slice.rgba[4 * pixel + static_cast<std::size_t>(channel)];
        if (std::abs(shown - 255.0 * expected.rgba[channel]) > 1.0) ++wrong_colours;  // rounding, and texture filtering
      }
    }
  }
  CHECK_MESSAGE(wrong_regions == 0, wrong_regions << " wrong pixels; first: " << first_wrong);
  CHECK(wrong_colours == 0);
  CHECK(uncertain < slice.regions.size() / 20);
  return seen;
}

}  // namespace

TEST_CASE("every certain pixel of a slice has the reference's region and colour") {
  const Folder folder;
  for (const RenderScene& scene : write_render_scenes(folder)) {
    const compiler::Module module = tests::lowered_file(scene.path);
    const compiler::Reference reference(module);
    std::set<std::uint32_t> regions_there;
    for (const compiler::Region& region : module.regions) {
      if (region.number != 0) regions_there.insert(region.number);
    }
    for (const std::vector<std::string>& form :
         {std::vector<std::string>{"--codegen", "specialised"}, {"--codegen", "table"}}) {
      std::set<std::uint32_t> seen;
      for (const std::string plane : {"z=0.013", "x=-0.31", "y=0.2", "1 2 3 0.1"}) {
        CAPTURE(scene.name);
        CAPTURE(form.back());
        CAPTURE(plane);
        seen.merge(compare(render_slice(folder, scene, plane, form), plane, reference));
      }
      // The planes meet every region, or the comparison would say less than it seems to.
      for (const std::uint32_t number : regions_there)
        CHECK_MESSAGE(seen.contains(number), scene.name << " " << number);
    }
  }
}
