// 3D bitmaps: n slices of n x n pixels, stacked in one picture. Thesis section 4.3.3.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>

#include "voml/grid.h"
#include "voml/limits.h"
#include "voml/text.h"

namespace dmvv::voml {
namespace {

struct Signature {
  std::string_view bytes;
  const char* format;  ///< OpenImageIO's name of it
};
constexpr Signature signatures[] = {{"\x89PNG\r\n\x1a\n", "png"},    {"\xff\xd8\xff", "jpeg"},
                                    {{"II*\0", 4}, "tiff"},          {{"MM\0*", 4}, "tiff"},
                                    {"\x76\x2f\x31\x01", "openexr"}, {"BM", "bmp"}};

/// What the content says, as endings lie; else the file's name decides.
std::string format_of(std::string_view bytes, const std::string& path) {
  for (const Signature& signature : signatures) {
    if (bytes.starts_with(signature.bytes)) return signature.format;
  }
  return path;
}

/// Whether a PNG file holds all of its chunks. libpng would print its complaint about a truncated one itself.
bool png_is_whole(std::string_view bytes) {
  for (std::size_t at = 8; bytes.size() - at >= 12;) {
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<unsigned char>(bytes[at + i]);
    if (length > bytes.size() - at - 12) return false;
    if (bytes.substr(at + 4, 4) == "IEND") return true;
    at += length + 12;
  }
  return false;
}

std::unique_ptr<OIIO::ImageInput> open_picture(std::string_view bytes, const std::string& path,
                                               OIIO::Filesystem::IOProxy& memory, std::string& why) {
  const std::string format = format_of(bytes, path);
  if (format == "png" && !png_is_whole(bytes)) {
    why = "the PNG file ends too early";
    return nullptr;
  }
  OIIO::ImageSpec wishes;
  wishes["oiio:UnassociatedAlpha"] = 1;  // colours are shown as given, not multiplied by their alpha
  auto input = OIIO::ImageInput::create(format);
  OIIO::ImageSpec spec;
  if (input && input->set_ioproxy(&memory) && input->open(path, spec, wishes)) return input;
  why = input ? input->geterror() : OIIO::geterror();
  return nullptr;
}

/// Grey becomes r = g = b, alpha moves from the second channel to the fourth.
void spread_grey(std::vector<glm::u8vec4>& texels, bool has_alpha) {
  for (glm::u8vec4& texel : texels) {
    texel = {texel.r, texel.r, texel.r, has_alpha ? texel.g : glm::u8vec4::value_type{255}};
  }
}

/// Decodes into texels whose first row is the lowest of the picture.
bool decode(OIIO::ImageInput& input, Bitmap& bitmap) {
  const std::size_t n = bitmap.n;
  const int channels = std::min(input.spec().nchannels, 4);
  bitmap.texels.assign(n * n * n, glm::u8vec4(255));
  const auto row_bytes = static_cast<OIIO::stride_t>(n * sizeof(glm::u8vec4));
  glm::u8vec4* const top_row = bitmap.texels.data() + (n * n - 1) * n;
  if (!input.read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, top_row, sizeof(glm::u8vec4), -row_bytes))
    return false;
  if (channels <= 2) spread_grey(bitmap.texels, channels == 2);
  return true;
}

std::optional<Bitmap> parse(std::string_view bytes, const std::string& path, Span named_at, Diagnostics& diagnostics) {
  const auto refuse = [&](Code code, std::string_view why) {
    diagnostics.report(code, named_at, fmt::format("bitmap {}: {}", in_quotes(path), why));
    return std::nullopt;
  };
  OIIO::Filesystem::IOMemReader memory(const_cast<char*>(bytes.data()), bytes.size());
  std::string why;
  const auto input = open_picture(bytes, path, memory, why);
  if (!input) return refuse(Code::bitmap_unreadable, fmt::format("it cannot be decoded: {}", trim(why)));

  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width < 1 || spec.depth > 1 || std::int64_t{spec.height} != std::int64_t{spec.width} * spec.width) {
    return refuse(Code::bitmap_size,
                  fmt::format("it has {} x {} pixels, a bitmap of width {} needs the height {} (n x n^2)", spec.width,
                              spec.height, spec.width, std::int64_t{spec.width} * spec.width));
  }
  if (spec.width > static_cast<int>(max_bitmap_edge)) {
    return refuse(Code::bitmap_size, fmt::format("it has n = {}, at most {} is allowed", spec.width, max_bitmap_edge));
  }
  Bitmap bitmap;
  bitmap.path = path;
  bitmap.n = static_cast<std::uint32_t>(spec.width);
  if (!decode(*input, bitmap)) {
    return refuse(Code::bitmap_unreadable, fmt::format("it cannot be decoded: {}", trim(input->geterror())));
  }
  return bitmap;
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
