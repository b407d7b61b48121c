// Files written, read back by OpenImageIO itself.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "support.h"

using namespace dmvv;
using namespace dmvv::tests;
using runtime::Picture;

namespace {

Picture sample_picture() {
  Picture picture;
  picture.size_px = {3, 2};
  picture.rgba = {1.0f, 0.5f,  0.25f, 1.0f, 0.8f, 0.6f, 0.4f, 0.5f, 0.0f, 0.0f, 0.0f, 0.0f,
                  2.0f, -1.0f, NAN,   1.0f, 0.2f, 0.2f, 0.2f, 0.2f, 1.0f, 1.0f, 1.0f, 1.0f};
  picture.regions = {1, 2, 0, 65535, 7, 8};
  picture.depth = {1.5f, 2.5f, std::numeric_limits<float>::infinity(), 3.0f, 1e-3f, 4.0f};
  return picture;
}

std::string path(const char* name) { return (scratch() / name).string(); }

/// The file's own values, alpha not applied.
template <class T>
std::vector<T> read(const std::string& file, OIIO::TypeDesc type, OIIO::ImageSpec& spec) {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  const auto input = OIIO::ImageInput::open(file, &config);
  REQUIRE(input);
  spec = input->spec();
  std::vector<T> values(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
  REQUIRE(input->read_image(0, 0, 0, spec.nchannels, type, values.data()));
  return values;
}

std::string bytes_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("PNG: 8 bits, straight alpha, out of range clamped") {
  must(runtime::write_picture(path("a.png"), sample_picture()));
  OIIO::ImageSpec spec;
  const auto values = read<std::uint8_t>(path("a.png"), OIIO::TypeUInt8, spec);
  CHECK(spec.format == OIIO::TypeUInt8);
  CHECK(values == std::vector<std::uint8_t>{255, 128, 64, 255, 204, 153, 102, 128, 0,   0,   0,   0,
                                            255, 0,   0,  255, 51,  51,  51,  51,  255, 255, 255, 255});
}

TEST_CASE("TIFF: 16 bits, straight alpha") {
  Picture picture = sample_picture();
  picture.rgba[14] = 0.0f;
  for (const char* name : {"a.tif", "b.TIFF"}) {
    must(runtime::write_picture(path(name), picture));
    OIIO::ImageSpec spec;
    const auto values = read<std::uint16_t>(path(name), OIIO::TypeUInt16, spec);
    CHECK(spec.format == OIIO::TypeUInt16);
    for (std::size_t i = 0; i < values.size(); ++i) {
      CHECK(std::abs(values[i] - 65535.0 * std::min(std::max(picture.rgba[i], 0.0f), 1.0f)) <= 0.51);
    }
  }
}

TEST_CASE("EXR: float, premultiplied") {
  Picture picture = sample_picture();
  picture.rgba[14] = 0.5f;
  must(runtime::write_picture(path("a.exr"), picture));
  OIIO::ImageSpec spec;
  const auto values = read<float>(path("a.exr"), OIIO::TypeFloat, spec);
  CHECK(spec.format == OIIO::TypeFloat);
  CHECK(spec.channelnames == std::vector<std::string>{"R", "G", "B", "A"});
  for (std::size_t i = 0; i < values.size(); ++i) {
    CHECK(values[i] == (i % 4 == 3 ? picture.rgba[i] : picture.rgba[i] * picture.rgba[i / 4 * 4 + 3]));
  }
}

TEST_CASE("region numbers and depth") {
  Picture picture = sample_picture();
  OIIO::ImageSpec spec;
  for (const char* name : {"r.png", "r.tif"}) {
    must(runtime::write_regions(path(name), picture));
    CHECK(read<std::uint16_t>(path(name), OIIO::TypeUInt16, spec) == std::vector<std::uint16_t>{1, 2, 0, 65535, 7, 8});
    CHECK(spec.format == OIIO::TypeUInt16);
  }
  picture.regions[0] = 4'000'000'000u;
  must(runtime::write_regions(path("r.exr"), picture));
  CHECK(read<std::uint32_t>(path("r.exr"), OIIO::TypeUInt32, spec) == picture.regions);
  CHECK(spec.format == OIIO::TypeUInt32);
  CHECK(spec.channelnames == std::vector<std::string>{"region"});
  const auto refused = runtime::write_regions(path("too_large.png"), picture);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message.find("4000000000 is beyond 65535") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(path("too_large.png")));

  must(runtime::write_depth(path("d.exr"), picture));
  CHECK(read<float>(path("d.exr"), OIIO::TypeFloat, spec) == picture.depth);
  CHECK(spec.channelnames == std::vector<std::string>{"Z"});
}

TEST_CASE("two writes give the same bytes, with no present date, and leave nothing else behind") {
  for (const char* ending : {".png", ".tif", ".exr"}) {
    CAPTURE(ending);
    const auto folder = scratch() / fmt::format("same{}", ending);
    std::filesystem::create_directory(folder);
    const std::string a = (folder / fmt::format("a{}", ending)).string(),
                      b = (folder / fmt::format("b{}", ending)).string();
    must(runtime::write_picture(a, sample_picture()));
    must(runtime::write_picture(b, sample_picture()));
    const std::string bytes = bytes_of(a);
    CHECK_FALSE(bytes.empty());
    CHECK(bytes == bytes_of(b));
    CHECK(bytes.find("OpenImageIO") == std::string::npos);
    const std::string date = OIIO::ImageInput::open(a)->spec().get_string_attribute("DateTime", "none");
    CHECK((date == "none" || date == "1970:01:01 00:00:00"));
    CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 2);
  }
}

TEST_CASE("what cannot be written is said") {
  const auto refusal = [](const Result<void>& result) {
    REQUIRE_FALSE(result);
    CHECK(result.error().fault == Fault::input);
    return text_of(result.error());
  };
  const Picture picture = sample_picture();
  CHECK(refusal(runtime::write_picture(path("a.jpg"), picture)).find("supported: .png, .tif, .tiff, .exr") !=
        std::string::npos);
  CHECK(refusal(runtime::write_picture(path("plain"), picture)).find("supported") != std::string::npos);
  CHECK(refusal(runtime::write_depth(path("d.png"), picture)).find("supported: .exr") != std::string::npos);
  CHECK(refusal(runtime::write_picture(path("no/such/a.png"), picture)).find("does not exist") != std::string::npos);
  std::filesystem::create_directory(path("folder.png"));
  CHECK(refusal(runtime::write_picture(path("folder.png"), picture)).find("is a directory") != std::string::npos);
}
