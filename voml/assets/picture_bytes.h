// Inside voml: what of a scene's pictures a decoder may see. OpenImageIO knows many formats and trusts what they say.
#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace dmvv::voml {

/// The bytes of a PNG, JPEG, TIFF or BMP file as they may be decoded; `storage` holds them where they had to be
/// changed. Errors: input, another format, a BMP of a rarer kind or without its whole palette, JPEG segments that are
/// not in order.
Result<std::string_view> decodable_bytes(std::string_view bytes, std::string& storage);

}  // namespace dmvv::voml
