#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "tests/unit/voml/test_files.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

std::optional<Grid> parse(const std::string& bytes, std::string* messages = nullptr) {
  Diagnostics diagnostics;
  auto grid = parse_lxn(bytes, diagnostics.add_source("g.lxn", ""), diagnostics);
  if (messages != nullptr) *messages = diagnostics.render();
  CHECK(grid.has_value() == !diagnostics.has_errors());
  return grid;
}

std::string refusal(const std::string& bytes) {
  std::string messages;
  CHECK_FALSE(parse(bytes, &messages).has_value());
  return messages;
}

void put(std::string& bytes, std::size_t at, std::int32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(static_cast<std::uint32_t>(value) >> (8 * i));
}

}  // namespace

TEST_CASE("a file written by hand from the table of the thesis' appendix B is read as it says") {
  std::string bytes(128 + 4 * 6, '\0');
  bytes.replace(0, 3, "LXN");
  put(bytes, 4, 1);   // channel type uint, as the appendix has it
  put(bytes, 8, 3);   // dimension
  put(bytes, 12, 1);  // channels
  put(bytes, 16, 3);  // 3 x 2 x 1
  put(bytes, 20, 2);
  put(bytes, 24, 1);
  put(bytes, 28, 77);  // sizes beyond the third do not count
  put(bytes, 56, 2);   // mirror
  put(bytes, 60, 1);
  put(bytes, 68, 0x3e800000);  // y from 0.25
  put(bytes, 76, 0x3f800000);  // x to 1
  put(bytes, 80, 0x3f400000);  // y to 0.75
  put(bytes, 84, 0x3f000000);  // z to 0.5
  for (int i = 0; i < 6; ++i)
    put(bytes, 128 + 4 * static_cast<std::size_t>(i), i == 4 ? 0x40000000 : 0);  // 2.0 at (1, 1, 0)
  const auto grid = parse(bytes);
  REQUIRE(grid);
  CHECK(grid->path == "g.lxn");
  CHECK(grid->size == glm::uvec3(3, 2, 1));
  CHECK(grid->channel_type == 1);
  CHECK(grid->address_mode == AddressMode::mirror);
  CHECK(grid->box_lo == glm::dvec3(-1.0, -0.5, -1.0));  // 2 b - 1
  CHECK(grid->box_hi == glm::dvec3(1.0, 0.5, 0.0));
  CHECK(grid->values == std::vector<float>{0, 0, 0, 0, 2, 0});
}

TEST_CASE("what is written is read back the same") {
  Grid grid;
  grid.path = "g.lxn";
  grid.size = {2, 3, 4};
  grid.box_lo = {-0.75, -1.0, 2.0 * double{0.05f} - 1.0};
  grid.box_hi = {0.5, 0.25, 1.0};
  grid.address_mode = AddressMode::wrap;
  for (int i = 0; i < 24; ++i) grid.values.push_back(0.1f * static_cast<float>(i) - 1.0f);
  grid.values[3] = std::numeric_limits<float>::denorm_min();
  grid.values[4] = -0.0f;
  const std::string bytes = write_lxn(grid);
  CHECK(bytes.size() == 128 + 24 * 4);
  const auto back = parse(bytes);
  REQUIRE(back);
  CHECK(back->size == grid.size);
  CHECK(back->box_lo == grid.box_lo);
  CHECK(back->box_hi == grid.box_hi);
  CHECK(back->address_mode == grid.address_mode);
  CHECK(back->channel_type == 8);
  CHECK(std::memcmp(back->values.data(), grid.values.data(), 24 * 4) == 0);
  CHECK(write_lxn(*back) == bytes);
}

TEST_CASE("without a box the grid fills the cube") {
  const auto grid = parse(tests::lxn_with(60, 0));
  REQUIRE(grid);
  CHECK(grid->box_lo == glm::dvec3(-1.0));
  CHECK(grid->box_hi == glm::dvec3(1.0));
}

TEST_CASE("any channel type is read without complaint") {
  for (const std::int32_t type : {0, 1, 8, -5}) {
    std::string messages;
    const auto grid = parse(tests::lxn_with(4, type), &messages);
    REQUIRE(grid);
    CHECK(grid->channel_type == type);
    CHECK(messages.empty());
  }
}

TEST_CASE("headers that lie are refused before anything is allocated; both numbers are named") {
  constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
  CHECK(refusal("").find("E0501") != std::string::npos);
  CHECK(refusal("LXN").find("the magic is 4c 58 4e,") != std::string::npos);
  CHECK(refusal(tests::lxn().substr(0, 127)).find("128 bytes, but the file only 127") != std::string::npos);
  CHECK(refusal(tests::lxn_with(8, 2)).find("dimension is 2, it must be 3") != std::string::npos);
  CHECK(refusal(tests::lxn_with(12, 4)).find("channels is 4, it must be 1") != std::string::npos);
  CHECK(refusal(tests::lxn_with(16, 0)).find("0 x 2 x 2") != std::string::npos);
  CHECK(refusal(tests::lxn_with(24, -1)).find("2 x 2 x -1") != std::string::npos);
  CHECK(refusal(tests::lxn_with(16, 3)).find("3 x 2 x 2 needs 48 bytes after the header, but the file has 32") !=
        std::string::npos);
  CHECK(refusal(tests::lxn() + "x").find("needs 32 bytes after the header, but the file has 33") != std::string::npos);
  CHECK(refusal(tests::lxn() + "1234").find("but the file has 36") != std::string::npos);
  CHECK(refusal(tests::lxn_with(60, 2)).find("flag is 2, it must be 0 or 1") != std::string::npos);
  std::string huge = tests::lxn();
  for (const std::size_t at : {16u, 20u, 24u}) put(huge, at, most);  // the product overflows 64 bits
  CHECK(refusal(huge).find("2147483647 x 2147483647 x 2147483647") != std::string::npos);
  std::string wrapped = tests::lxn();  // 2^31 * 2^31 * 4 = 2^64, which is 0 in 64 bits
  put(wrapped, 16, 1 << 30), put(wrapped, 20, 1 << 30), put(wrapped, 24, 16);
  CHECK(refusal(wrapped).find("E0502") != std::string::npos);
}

TEST_CASE("boxes that are empty, reversed or not finite and values that are not finite are refused") {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(refusal(tests::lxn_with(64, 1.0f)).find("empty or reversed along x: it goes from 1 to 1") != std::string::npos);
  CHECK(refusal(tests::lxn_with(72, 2.0f)).find("along z: it goes from 2 to 1") != std::string::npos);
  CHECK(refusal(tests::lxn_with(80, infinity)).find("not finite along y") != std::string::npos);
  CHECK(refusal(tests::lxn_with(64, nan)).find("not finite along x") != std::string::npos);
  // Corners stand at 2 b - 1: next to -1, float32 steps by 2^-24, and twice 3e38 is beyond it.
  const auto box_x = [](float lo, float hi) {
    return tests::lxn_with(64, lo).substr(0, 76) + tests::lxn_with(76, hi).substr(76);
  };
  CHECK(refusal(box_x(1e-30f, 2e-30f)).find("thinner than float32 can tell along x") != std::string::npos);
  CHECK(parse(box_x(0.0f, 0x1p-25f)).has_value());
  CHECK(refusal(box_x(0.0f, 3e38f)).find("beyond the range of float32 along x") != std::string::npos);
  CHECK(refusal(tests::lxn_with(128 + 4 * 6, -infinity)).find("value 6 (x 0, y 1, z 1) is -inf") != std::string::npos);
  CHECK(refusal(tests::lxn_with(128, nan)).find("value 0 (x 0, y 0, z 0) is nan") != std::string::npos);
}
