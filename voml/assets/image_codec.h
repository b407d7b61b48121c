// Between voml/assets/image_file.cpp, which loads the module, and voml/assets/image_codec.cpp, which is the module.
#pragma once

#include "voml/assets/image_file.h"

namespace dmvv {

struct ImageCodec {
  Result<ImageInfo> (*inspect)(std::string_view bytes, const std::string& name);
  Result<Image8> (*decode)(std::string_view bytes, const std::string& name, std::uint64_t max_samples);
  Result<void> (*write)(const std::string& path, const ImageToWrite& image);
};

inline constexpr const char* image_codec_file = "dmvv_image_codec.so";
inline constexpr const char* image_codec_entry = "dmvv_image_codec";  ///< const ImageCodec* (*)()

}  // namespace dmvv
