// Inside voml: PNG, which most pictures are, by libpng alone. What is read and written is what image_file.h says.
#pragma once

#include "voml/assets/image_file.h"

namespace dmvv {

bool is_png(std::string_view bytes);
Result<ImageInfo> inspect_png(std::string_view bytes);
Result<Image8> decode_png(std::string_view bytes, std::uint64_t max_samples);

/// Stored and given must be the same, u8 or u16; 1 to 4 channels.
Result<void> write_png(const std::string& path, const ImageToWrite& image);

}  // namespace dmvv
