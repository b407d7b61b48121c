#include "compiler/layout/atlas.h"

#include <doctest/doctest.h>

#include <cstring>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "tests/support/scenes.h"

using namespace dmvv;

namespace {

float texel(const compiler::Atlas& atlas, glm::uvec3 at) {
  const glm::uvec3 extent = atlas.texture.extent;
  float value;
  std::memcpy(&value, atlas.texture.texels.data() + 4 * ((std::size_t{at.z} * extent.y + at.y) * extent.x + at.x), 4);
  return value;
}

}  // namespace

TEST_CASE("packed boxes never overlap and stay inside") {
  tests::Random random(11);
  for (int round = 0; round < 20; ++round) {
    std::vector<glm::uvec3> sizes;
    std::uint64_t volume = 0;
    for (int i = 0; i < 30; ++i) {
      sizes.emplace_back(1 + random.bits() % 40, 1 + random.bits() % 40, 1 + random.bits() % 40);
      volume += std::uint64_t{sizes.back().x} * sizes.back().y * sizes.back().z;
    }
    const auto packing = compiler::pack_boxes(sizes, 512);
    REQUIRE(packing);
    CHECK(packing->used == volume);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const glm::uvec3 lo = packing->positions[i], hi = lo + sizes[i];
      CHECK(glm::all(glm::lessThanEqual(hi, packing->extent)));
      for (std::size_t j = 0; j < i; ++j) {
        const glm::uvec3 other = packing->positions[j];
        CHECK_FALSE((glm::all(glm::lessThan(lo, other + sizes[j])) && glm::all(glm::lessThan(other, hi))));
      }
    }
    // Uniform random boxes: a packing that wastes more than half would be no packing.
    const double fill =
        static_cast<double>(volume) / (double(packing->extent.x) * packing->extent.y * packing->extent.z);
    CHECK(fill > 0.5);
  }
}

TEST_CASE("equal cubes pack without waste, the extent is no power of two") {
  const std::vector<glm::uvec3> sizes(12, glm::uvec3(10));
  const auto packing = compiler::pack_boxes(sizes, 512);
  REQUIRE(packing);
  CHECK(std::uint64_t{packing->extent.x} * packing->extent.y * packing->extent.z == 12000);
}

TEST_CASE("boxes beyond the limit are refused") {
  CHECK_FALSE(compiler::pack_boxes(std::vector<glm::uvec3>{{65, 1, 1}}, 64));
  CHECK_FALSE(compiler::pack_boxes(std::vector<glm::uvec3>(2, glm::uvec3(64)), 64));
  CHECK(compiler::pack_boxes(std::vector<glm::uvec3>{{64, 64, 64}}, 64));
  CHECK(compiler::pack_boxes({}, 64));
}

TEST_CASE("each grid has a border that repeats its outer samples") {
  const auto value = [](glm::dvec3 p) { return p.x + 10 * p.y + 100 * p.z; };
  const std::vector<voml::Grid> grids{tests::grid_of({3, 4, 5}, value),
                                      tests::grid_of({2, 2, 2}, [](glm::dvec3) { return -7.0; })};
  Diagnostics diagnostics;
  const auto atlas = compiler::pack_atlas(grids, {}, 64, diagnostics);
  REQUIRE(atlas);
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const glm::ivec3 n(grids[g].size);
    for (int z = -1; z <= n.z; ++z) {
      for (int y = -1; y <= n.y; ++y) {
        for (int x = -1; x <= n.x; ++x) {
          const glm::uvec3 inner(glm::clamp(glm::ivec3(x, y, z), glm::ivec3(0), n - 1));
          const float expected = grids[g].values[(inner.z * n.y + inner.y) * n.x + inner.x];
          CHECK(texel(*atlas, atlas->slots[g] + glm::uvec3(x, y, z)) == expected);
        }
      }
    }
  }
}

TEST_CASE("an atlas that does not fit names the largest grid and the limit") {
  std::vector<voml::Grid> grids{tests::grid_of({2, 2, 2}, [](glm::dvec3) { return 0.0; }),
                                tests::grid_of({20, 2, 2}, [](glm::dvec3) { return 0.0; })};
  grids[1].path = "long.lxn";
  Diagnostics diagnostics;
  CHECK_FALSE(compiler::pack_atlas(grids, {}, 16, diagnostics));
  REQUIRE(diagnostics.all().size() == 1);
  CHECK(diagnostics.all()[0].code == Code::atlas_too_large);
  CHECK(diagnostics.all()[0].message.find("'long.lxn'") != std::string::npos);
  CHECK(diagnostics.all()[0].message.find("16") != std::string::npos);
}

TEST_CASE("half precision keeps the sign of every sample") {
  const std::vector<voml::Grid> grids{tests::grid_of({4, 4, 4}, [](glm::dvec3 p) { return p.x < 0 ? -1e6 : 1e6; })};
  Diagnostics diagnostics;
  const auto atlas = compiler::pack_atlas(grids, {.format = compiler::TexelFormat::r16f}, 64, diagnostics);
  REQUIRE(atlas);
  CHECK(atlas->texture.texels.size() == 6 * 6 * 6 * 2);
  std::uint16_t first, last;
  std::memcpy(&first, atlas->texture.texels.data(), 2);
  std::memcpy(&last, atlas->texture.texels.data() + atlas->texture.texels.size() - 2, 2);
  CHECK(first == 0xfbff);  // -65504, the largest half
  CHECK(last == 0x7bff);
}
