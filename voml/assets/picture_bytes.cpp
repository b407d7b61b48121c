#include "voml/assets/picture_bytes.h"

#include <cstdint>

namespace dmvv::voml {
namespace {

std::uint32_t big_endian_16(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at])) << 8 |
         static_cast<unsigned char>(bytes[at + 1]);
}

/// Leaves out what a JPEG file says beside its pixels (Exif, colour profiles, comments): OpenImageIO 2.4 reads beyond
/// the end of such segments. Kept are JFIF and Adobe (APP0, APP14), which tell the colour space. Empty, and `why` told,
/// if the segments before the first scan are not in order.
std::string plain_jpeg(std::string_view bytes, std::string& why) {
  std::string kept(bytes.substr(0, 2));
  for (std::size_t at = 2; bytes.size() - at >= 4 && bytes[at] == '\xff';) {
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    if (marker == 0xff) {  // a fill byte
      ++at;
      continue;
    }
    if (marker == 0xda) return kept += bytes.substr(at);  // the first scan
    const std::size_t length = big_endian_16(bytes, at + 2);
    if (marker < 0xc0 || (marker >= 0xd0 && marker <= 0xd9) || length < 2 || length > bytes.size() - at - 2) break;
    const bool application = marker >= 0xe0 && marker <= 0xef && marker != 0xe0 && marker != 0xee;
    if (!application && marker != 0xfe) kept += bytes.substr(at, length + 2);
    at += length + 2;
  }
  why = "the JPEG file ends too early, or its segments are damaged";
  return {};
}

std::uint32_t little_endian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// What keeps a BMP file from being read, empty if nothing does. OpenImageIO 2.4 reads beyond its palette, so that must
/// be whole; runs and the rarer depths are left to the other formats.
std::string bmp_fault(std::string_view bytes) {
  constexpr std::size_t file_header = 14, smallest_header = 40;
  if (bytes.size() < file_header + smallest_header) return "the BMP file ends too early";
  const std::uint64_t header = little_endian(bytes, 14, 4), pixels_at = little_endian(bytes, 10, 4);
  const std::uint32_t bits = little_endian(bytes, 28, 2), packing = little_endian(bytes, 30, 4);
  const std::uint32_t colors = little_endian(bytes, 46, 4);
  if ((header != 40 && header != 108 && header != 124) || (bits != 8 && bits != 24 && bits != 32) || packing != 0) {
    return "of BMP files, those of 8, 24 or 32 bits a pixel that are not compressed can be read";
  }
  const std::uint64_t palette = bits == 8 ? 4 * 256 : 0;
  if ((bits == 8 && colors != 0 && colors != 256) || pixels_at < file_header + header + palette ||
      pixels_at > bytes.size()) {
    return "the BMP file's palette is not whole";
  }
  return {};
}

}  // namespace

Result<std::string_view> decodable_bytes(std::string_view bytes, std::string& storage) {
  using namespace std::string_view_literals;
  const auto begins = [&](std::string_view signature) { return bytes.starts_with(signature); };
  std::string why;
  if (begins("\x89PNG\r\n\x1a\n") || begins("II*\0"sv) || begins("MM\0*"sv)) return bytes;
  if (begins("\xff\xd8\xff")) {
    storage = plain_jpeg(bytes, why);
    if (why.empty()) return storage;
  } else if (begins("BM")) {
    why = bmp_fault(bytes);
    if (why.empty()) return bytes;
  } else {
    why = "it is neither PNG, JPEG, TIFF nor BMP";
  }
  return fail(Fault::input, why);
}

}  // namespace dmvv::voml
