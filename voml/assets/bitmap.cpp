// 3D bitmaps: n slices of n x n pixels, stacked in one picture. Thesis section 4.3.3.
#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "base/limits.h"
#include "base/text.h"
#include "voml/assets/grid.h"
#include "voml/assets/image_file.h"
#include "voml/assets/picture_bytes.h"

namespace dmvv::voml {
namespace {

/// One channel becomes r = g = b, two are grey and alpha, three are opaque. The first row becomes the lowest.
std::vector<glm::u8vec4> to_texels(const Image8& image) {
  using Channel = glm::u8vec4::value_type;
  std::vector<glm::u8vec4> texels(image.width * image.height);
  const std::uint8_t* from = image.samples.data();
  for (std::uint64_t row = image.height; row-- > 0;) {
    for (std::uint64_t x = 0; x < image.width; ++x, from += image.channels) {
      const bool grey = image.channels <= 2;
      const Channel alpha = image.channels % 2 == 0 ? from[image.channels - 1] : Channel{255};
      texels[row * image.width + x] = {from[0], from[grey ? 0 : 1], from[grey ? 0 : 2], alpha};
    }
  }
  return texels;
}

/// No format packs more pixels into a byte: the best are deflate with 1032 bytes a byte, of pictures with a bit a
/// pixel.
constexpr std::uint64_t most_pixels_per_byte = 1032 * 8;

std::optional<Bitmap> parse(std::string_view given, const std::string& path, Span named_at, Diagnostics& diagnostics) {
  const auto refuse = [&](Code code, std::string_view why) {
    diagnostics.report(code, named_at, fmt::format("bitmap {}: {}", in_quotes(path), why));
    return std::nullopt;
  };
  const auto undecodable = [&](const Error& error) {
    return refuse(Code::bitmap_unreadable, fmt::format("it cannot be decoded: {}", error.message));
  };
  std::string storage;
  const auto decodable = decodable_bytes(given, storage);
  if (!decodable) return undecodable(decodable.error());
  const std::string_view bytes = *decodable;
  const auto info = inspect_image(bytes, path);
  if (!info) return undecodable(info.error());
  if (info->depth > 1 || info->height != info->width * info->width) {
    return refuse(Code::bitmap_size,
                  fmt::format("it has {} x {} pixels, a bitmap of width {} needs the height {} (n x n^2)", info->width,
                              info->height, info->width, info->width * info->width));
  }
  if (info->width > max_bitmap_edge) {
    return refuse(Code::bitmap_size, fmt::format("it has n = {}, at most {} is allowed", info->width, max_bitmap_edge));
  }
  if (info->width * info->height > bytes.size() * most_pixels_per_byte) {
    return refuse(Code::bitmap_unreadable,
                  fmt::format("it cannot be decoded: its {} bytes are too few for {} x {} pixels", bytes.size(),
                              info->width, info->height));
  }
  constexpr std::uint64_t most_texels = std::uint64_t{max_bitmap_edge} * max_bitmap_edge * max_bitmap_edge;
  const auto image = decode_image(bytes, path, 4 * most_texels);
  if (!image) return undecodable(image.error());
  return Bitmap{.path = path, .n = static_cast<std::uint32_t>(info->width), .texels = to_texels(*image)};
}

}  // namespace

std::optional<Bitmap> parse_bitmap(std::string_view bytes, const std::string& path, Span named_at,
                                   Diagnostics& diagnostics) {
  try {
    return parse(bytes, path, named_at, diagnostics);
  } catch (const std::exception& e) {
    diagnostics.report(Code::bitmap_unreadable, named_at,
                       fmt::format("bitmap {}: it cannot be decoded: {}", in_quotes(path), e.what()));
    return std::nullopt;
  }
}

}  // namespace dmvv::voml
