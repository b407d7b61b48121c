#include <doctest/doctest.h>

#include "tests/unit/voml/test_files.h"

using namespace dmvv;
using namespace dmvv::voml;

namespace {

std::optional<Bitmap> parse(const std::string& bytes, const std::string& path, std::string* messages = nullptr) {
  Diagnostics diagnostics;
  auto bitmap = parse_bitmap(bytes, path, Span{}, diagnostics);
  if (messages != nullptr) *messages = diagnostics.render();
  CHECK(bitmap.has_value() == !diagnostics.has_errors());
  return bitmap;
}

/// 2 x 4 pixels; a pixel's red is its column, its green its row counted from the bottom, times 50.
std::vector<std::uint8_t> columns_and_rows(int channels) {
  std::vector<std::uint8_t> pixels;
  for (int row_from_top = 0; row_from_top < 4; ++row_from_top) {
    for (int column = 0; column < 2; ++column) {
      const int values[4] = {column * 50, (3 - row_from_top) * 50, 7, 128};
      for (int c = 0; c < channels; ++c) pixels.push_back(static_cast<std::uint8_t>(values[c]));
    }
  }
  return pixels;
}

}  // namespace

TEST_CASE("texel (x, y, z) is column x, row y + z n counted from the bottom") {
  for (const char* format : {"png", "tif", "bmp"}) {
    CAPTURE(format);
    const auto bitmap = parse(tests::picture(2, 4, 3, columns_and_rows(3), format), std::string("b.") + format);
    REQUIRE(bitmap);
    REQUIRE(bitmap->n == 2);
    REQUIRE(bitmap->texels.size() == 8);
    for (unsigned z = 0; z < 2; ++z) {
      for (unsigned y = 0; y < 2; ++y) {
        for (unsigned x = 0; x < 2; ++x) {
          CHECK(bitmap->texels[x + 2 * y + 4 * z] == glm::u8vec4(50 * x, 50 * (y + 2 * z), 7, 255));
        }
      }
    }
  }
}

TEST_CASE("colours are kept as given: alpha is not multiplied in, grey is spread") {
  const auto rgba = parse(tests::picture(2, 4, 4, columns_and_rows(4)), "b.png");
  REQUIRE(rgba);
  CHECK(rgba->texels[7] == glm::u8vec4(50, 150, 7, 128));
  const auto grey = parse(tests::picture(1, 1, 1, {99}), "b.png");
  REQUIRE(grey);
  CHECK(grey->texels[0] == glm::u8vec4(99, 99, 99, 255));
  const auto grey_alpha = parse(tests::picture(1, 1, 2, {99, 40}), "b.png");
  REQUIRE(grey_alpha);
  CHECK(grey_alpha->texels[0] == glm::u8vec4(99, 99, 99, 40));
}

TEST_CASE("the content tells the format, not the name") {
  const auto bitmap = parse(tests::picture(2, 4, 3, columns_and_rows(3), "png"), "picture.jpg");
  REQUIRE(bitmap);
  CHECK(bitmap->texels[7] == glm::u8vec4(50, 150, 7, 255));
}

TEST_CASE("segments of a JPEG file that say nothing of its pixels do not count") {
  const std::string whole = tests::picture(2, 4, 3, columns_and_rows(3), "jpg");
  const auto plain = parse(whole, "b.jpg");
  REQUIRE(plain);
  // APP13, "Photoshop 3.0" without its zero, and a comment, behind SOI.
  std::string with_segments = whole;
  with_segments.insert(
      2, "\xff\xed" + std::string("\0\x0f", 2) + "Photoshop 3.0\xff\xfe" + std::string("\0\x04", 2) + "no");
  const auto bitmap = parse(with_segments, "b.jpg");
  REQUIRE(bitmap);
  CHECK(bitmap->texels == plain->texels);
  std::string messages;
  CHECK_FALSE(parse(whole.substr(0, 40), "b.jpg", &messages));
  CHECK(messages.find("the JPEG file ends too early") != std::string::npos);
}

TEST_CASE("wrong sizes are refused naming both numbers, oversized ones before they are decoded") {
  std::string messages;
  CHECK_FALSE(parse(tests::picture(4, 4), "b.png", &messages));
  CHECK(messages.find("4 x 4 pixels") != std::string::npos);
  CHECK(messages.find("height 16") != std::string::npos);
  CHECK_FALSE(parse(tests::picture(4, 2), "b.png"));

  // A BMP header that promises 1025 x 1025^2 pixels and holds none: 4 GB if anybody believed it.
  std::string bomb("BM\0\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x01\x04\0\0\x01\x08\x10\0\x01\0\x18\0", 30);
  bomb.resize(54);
  CHECK_FALSE(parse(bomb, "b.bmp", &messages));
  CHECK(messages.find("error[E0511]: bitmap 'b.bmp': it has n = 1025, at most 1024 is allowed") == 0);
  // 1024 x 1024^2 are allowed, but never in 54 bytes.
  bomb.replace(18, 8, std::string("\0\x04\0\0\0\0\x10\0", 8));
  CHECK_FALSE(parse(bomb, "b.bmp", &messages));
  CHECK(messages.find("its 54 bytes are too few for 1024 x 1048576 pixels") != std::string::npos);
}

TEST_CASE("broken and foreign files are refused with a reason") {
  const std::string whole = tests::picture(2, 4);
  for (std::size_t length = 0; length < whole.size(); ++length) CHECK_FALSE(parse(whole.substr(0, length), "b.png"));
  std::string messages;
  std::string damaged = whole;
  damaged[damaged.find("IDAT") + 6] ^= 1;
  CHECK_FALSE(parse(damaged, "b.png", &messages));
  CHECK_FALSE(parse("just text", "b.txt", &messages));
  CHECK(messages.find("error[E0510]: bitmap 'b.txt': it cannot be decoded: ") == 0);
  std::string indexed("BM\0\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\x08\0", 30);
  indexed.resize(58);  // one pixel of 8 bits, and no palette
  CHECK_FALSE(parse(indexed, "b.bmp", &messages));
  CHECK(messages.find("the BMP file's palette is not whole") != std::string::npos);
  indexed.resize(54);
  indexed[11] = 4;  // at 54 + 1024, and there it is
  for (int i = 0; i < 256; ++i) indexed += std::string(3, static_cast<char>(i)) + '\0';
  const auto pixel = parse(indexed + std::string("\x07\0\0\0", 4), "b.bmp");
  REQUIRE(pixel);
  CHECK(pixel->texels[0] == glm::u8vec4(7, 7, 7, 255));
}
