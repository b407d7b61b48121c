// Pictures in files: PNG by libpng, all other formats by OpenImageIO. That brings some 250 shared libraries with it, a
// quarter of a second to load, so it stands in a module of its own that is loaded when the first such picture is met.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace dmvv {

enum class SampleType : std::uint8_t { u8, u16, u32, f16, f32 };

/// What the header of a picture says; nothing of it is to be believed before the samples are read.
struct ImageInfo {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint64_t depth = 1;            ///< more than 1: a volume in one file
  std::vector<std::string> channels;  ///< their names
  std::string sample_type;            ///< "uint8", "half", ...
  std::string format;                 ///< "png", "tiff", ...
};

/// Samples of 8 bits, the first row the top one; alpha is straight (colours are not multiplied by it).
struct Image8 {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint32_t channels = 0;  ///< at most 4: more are left out
  std::vector<std::uint8_t> samples;
};

/// What is to be written. The samples: the first row the top one, channels interleaved.
struct ImageToWrite {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::vector<std::string> channels;  ///< names; {"R", "G", "B", "A"}: the last is alpha
  SampleType stored = SampleType::u8;
  SampleType given = SampleType::u8;  ///< of `samples`; converted if `stored` is another; in PNG they are the same
  bool straight_alpha = true;         ///< else colours are multiplied by it already
  std::string compression;            ///< the format's name of it; empty: its default
  const void* samples = nullptr;
};

/// Reads the header of a picture in memory. The content decides on the format; only where it is unknown does the ending
/// of `name`. Errors: input, why it is no picture; environment, the module cannot be loaded.
Result<ImageInfo> inspect_image(std::string_view bytes, const std::string& name);

/// Decodes a picture of at most `max_samples` samples (width * height * channels).
/// Errors: those of inspect_image; input: it ends too early, is damaged, is larger, has several slices.
Result<Image8> decode_image(std::string_view bytes, const std::string& name, std::uint64_t max_samples);

/// Writes to `path`, whose ending is the format. Not atomic: give it a temporary name. The same picture gives the same
/// bytes. Errors: environment, with the reason.
Result<void> write_image(const std::string& path, const ImageToWrite& image);

}  // namespace dmvv
