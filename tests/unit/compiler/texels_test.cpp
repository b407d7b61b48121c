#include "compiler/grids/texels.h"
#include <doctest/doctest.h>
#include <cmath>
#include <cstring>
#include "compiler/grids/sample.h"
#include "compiler/reference/reference.h"
#include "tests/support/scene_table.h"

using namespace dmvv;
using compiler::Filter;
using compiler::TexelFormat;

namespace {

/// A module with one grid, looked at with the given iso values.
compiler::Module with_isos(voml::Grid grid, const std::vector<double>& isos) {
  compiler::Module module;
  module.grids.push_back(std::move(grid));
  for (const double iso : isos) {
    compiler::Sdf sdf;
    sdf.source = Id<voml::Grid>{0};
    sdf.iso = iso;
    module.sdfs.push_back(std::move(sdf));
  }
  return module;
}

/// A grid of hash values: nothing that an interpolation error could hide in.
voml::Grid rough_grid(glm::uvec3 size) {
  tests::Random random(5);
  return tests::grid_of(size, [&](glm::dvec3) { return random.in(-1.0, 1.0); });
}

}  // namespace

TEST_CASE("a normalised format spans what a boundary can need: the slopes, and the farthest iso value") {
  // Neighbours differ by 0.25, 0.5 and 1/8 times 1, -1 and 2; values reach far beyond.
  const auto plane = [](glm::dvec3 p) { return p.x - p.y + 2.0 * p.z + 7.0; };
  const auto grid = tests::grid_of({8, 4, 16}, plane);
  const double slopes = 0.25 + 0.5 + 2.0 * 0.125;
  CHECK(compiler::texel_scales(with_isos(grid, {0.0}), TexelFormat::snorm16, Filter::shader)[0] ==
        doctest::Approx(slopes));
  CHECK(compiler::texel_scales(with_isos(grid, {0.5, -2.0}), TexelFormat::snorm8, Filter::hardware)[0] ==
        doctest::Approx(slopes + 2.0));
  CHECK(compiler::texel_scales(with_isos(grid, {0.0}), TexelFormat::snorm16, Filter::tricubic)[0] ==
        doctest::Approx(4.5 * slopes));
  CHECK(compiler::texel_scales(with_isos(grid, {1.0}), TexelFormat::r16f, Filter::shader)[0] == 1.0);
  // Never more than the samples themselves need; something that divides even if they are all 0.
  const auto flat = tests::grid_of({2, 2, 2}, [](glm::dvec3) { return -3.0; });
  CHECK(compiler::texel_scales(with_isos(flat, {0.0}), TexelFormat::snorm8, Filter::shader)[0] == 3.0);
  const auto zero = tests::grid_of({2, 2, 2}, [](glm::dvec3) { return 0.0; });
  CHECK(compiler::texel_scales(with_isos(zero, {0.0}), TexelFormat::snorm8, Filter::shader)[0] == 1.0);
}

TEST_CASE("what is stored is off by half a step at most where it is not cut off, and keeps its side there") {
  const auto grid = tests::grid_of(glm::uvec3(16), [](glm::dvec3 p) { return glm::length(p) - 0.6; });
  for (const auto& [format, steps] :
       {std::pair{TexelFormat::snorm16, 32767.0}, std::pair{TexelFormat::snorm8, 127.0}}) {
    const double scale = compiler::texel_scales(with_isos(grid, {0.0}), format, Filter::shader)[0];
    CHECK(scale < 3.0 * 2.0 / 16.0);  // of a distance, neighbours differ by their spacing at most
    const auto stored = compiler::as_stored(grid, format, scale);
    for (std::size_t i = 0; i < grid.values.size(); ++i) {
      if (std::abs(grid.values[i]) <= scale) {
        CHECK(std::abs(stored.values[i] - grid.values[i]) <= 0.5 * scale / steps * 1.0001);
      } else {
        CHECK(stored.values[i] == doctest::Approx(grid.values[i] > 0 ? scale : -scale).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("texels hold the bytes that the formats of Vulkan define") {
  const auto stored = [](float value, TexelFormat format, double scale) {
    std::int16_t wide = 0;
    std::int8_t narrow = 0;
    std::byte bytes[4];
    compiler::store_texel(value, format, scale, bytes);
    std::memcpy(&wide, bytes, 2);
    std::memcpy(&narrow, bytes, 1);
    return compiler::bytes_per_texel(format) == 2 ? int{wide} : int{narrow};
  };
  CHECK(stored(0.5f, TexelFormat::snorm16, 0.5) == 32767);
  CHECK(stored(-0.5f, TexelFormat::snorm16, 0.5) == -32767);
  CHECK(stored(-9.0f, TexelFormat::snorm16, 0.5) == -32767);
  CHECK(stored(0.25f, TexelFormat::snorm8, 1.0) == 32);  // 31.75
  CHECK(stored(-9.0f, TexelFormat::snorm8, 1.0) == -127);
  CHECK(stored(0.0f, TexelFormat::snorm8, 1.0) == 0);
}

TEST_CASE("cutting far samples off moves no boundary: trilinear and tricubic give the sides they gave") {
  // Slopes of up to 1 an axis beside values of up to 11.
  tests::Random random(9);
  voml::Grid grid = tests::grid_of(glm::uvec3(12), [](glm::dvec3 p) { return 6.0 * (p.x + p.y * p.z); });
  for (const Filter filter : {Filter::shader, Filter::tricubic}) {
    const double scale = compiler::texel_scales(with_isos(grid, {0.0}), TexelFormat::snorm16, filter)[0];
    voml::Grid cut = grid;
    for (float& value : cut.values) value = std::clamp(value, static_cast<float>(-scale), static_cast<float>(scale));
    const auto sample = filter == Filter::tricubic ? compiler::sample_tricubic : compiler::sample;
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 p = random.point();
      CHECK((sample(grid, p) <= 0.0) == (sample(cut, p) <= 0.0));
    }
  }
}

TEST_CASE(
    "tricubic keeps the samples, is exact for quadratics, smooth, and repeats the outer samples beyond the edge") {
  const auto rough = rough_grid({5, 4, 6});
  for (std::uint32_t z = 0, i = 0; z < 6; ++z) {
    for (std::uint32_t y = 0; y < 4; ++y) {
      for (std::uint32_t x = 0; x < 5; ++x, ++i) {
        const glm::dvec3 centre = (glm::dvec3(x, y, z) + 0.5) / glm::dvec3(5, 4, 6) * 2.0 - 1.0;
        CHECK(compiler::sample_tricubic(rough, centre) == doctest::Approx(rough.values[i]).epsilon(1e-9));
      }
    }
  }
  const auto quadratic = [](glm::dvec3 p) { return p.x * p.x - 2.0 * p.y * p.z + 0.5 * p.z * p.z + p.y; };
  const auto smooth = tests::grid_of(glm::uvec3(8), quadratic);
  tests::Random random(6);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 p = random.point(-0.6, 0.6);  // the support stays inside
    CHECK(compiler::sample_tricubic(smooth, p) == doctest::Approx(quadratic(p)).epsilon(1e-5));
  }
  // Values and slopes meet where cells meet: at a sample centre (x = -0.4 of 5 samples).
  const auto slope = [&](double x, double e) {
    return (compiler::sample_tricubic(rough, {x + e, 0.1, 0.2}) - compiler::sample_tricubic(rough, {x, 0.1, 0.2})) / e;
  };
  CHECK(slope(-0.4, 1e-6) == doctest::Approx(slope(-0.4, -1e-6)).epsilon(1e-3));
  // At the face of a grid of 2: the samples at -3/2, -1/2, 1/2, 3/2 texels are v0, v0, v1, v1 to the left and right of
  // the middle; half a texel before the first centre the weights are -1/16, 9/16, 9/16, -1/16 of v0, v0, v0, v1.
  const auto two = tests::grid_of({2, 1, 1}, [](glm::dvec3 p) { return p.x; });
  CHECK(compiler::sample_tricubic(two, {-1, 0, 0}) == doctest::Approx(-0.5 - 1.0 / 16.0));
  CHECK(compiler::sample_tricubic(two, {0, 0, 0}) == doctest::Approx(0.0));
}

TEST_CASE("tricubic comes much closer to a sphere than trilinear") {
  const auto ball = tests::grid_of(glm::uvec3(16), [](glm::dvec3 p) { return glm::length(p) - 0.6; });
  tests::Random random(8);
  double linear = 0.0, cubic = 0.0;
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 p = 0.6 * glm::normalize(random.point());
    linear = std::max(linear, std::abs(compiler::sample(ball, p)));
    cubic = std::max(cubic, std::abs(compiler::sample_tricubic(ball, p)));
  }
  CHECK(linear > 2e-3);  // about h^2 / 8 times the sum of the curvatures: (1/8)^2 / 8 * 2 / 0.6
  CHECK(cubic < linear / 5.0);
}

TEST_CASE("each filter is in the shader only where it is asked for") {
  const auto& scene = tests::conformance_scene("transformed");
  const auto module = tests::lowered(scene.text, scene.files);
  for (const auto codegen : {compiler::Codegen::specialised, compiler::Codegen::table}) {
    for (const auto filter : {Filter::hardware, Filter::shader, Filter::tricubic}) {
      compiler::CompileOptions options;
      options.codegen = codegen;
      options.filter = filter;
      const auto program = tests::compiled(module, options);
      const std::string& glsl = program.shader("pixels").glsl;
      CHECK((glsl.find("float sample_grid(") == std::string::npos) == (filter == Filter::hardware));
      CHECK((glsl.find("#define DMVV_TRICUBIC") != std::string::npos) == (filter == Filter::tricubic));
      REQUIRE(program.textures.size() == 1);
      CHECK(program.textures[0].filtered == (filter == Filter::hardware));
      CHECK(program.textures[0].extent == glm::uvec3(filter == Filter::tricubic ? 28 : 26));  // 24 and its borders
    }
  }
}
