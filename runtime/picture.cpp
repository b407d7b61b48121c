// Pictures to files.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <filesystem>
#include <functional>
#include <new>

#include "runtime/view.h"

#if defined(_WIN32)
#include <process.h>
#define DMVV_PROCESS_ID _getpid
#else
#include <unistd.h>
#define DMVV_PROCESS_ID getpid
#endif

namespace dmvv::runtime {
namespace {

namespace fs = std::filesystem;

// Measured on rendered pictures of 1280x720: level 2 takes 0.4 of level 6's time for files 20 to 45 % larger.
constexpr int png_compression_level = 2;

std::string lower_ending(const fs::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

/// Why nothing can be written to `path`, if so.
std::optional<Error> path_fault(const std::string& path, std::initializer_list<std::string_view> endings) {
  const std::string ending = lower_ending(path);
  if (std::ranges::find(endings, ending) == endings.end()) {
    return Error{Fault::input,
                 fmt::format("cannot write '{}': the ending '{}' is not supported here", path, ending),
                 {fmt::format("supported: {}", fmt::join(endings, ", "))}};
  }
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    return Error{Fault::input, fmt::format("cannot write '{}': it is a directory", path), {}};
  const fs::path folder = fs::path(path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored)) {
    return Error{
        Fault::input, fmt::format("cannot write '{}': the folder '{}' does not exist", path, folder.string()), {}};
  }
  return std::nullopt;
}

/// A name beside `path` that keeps its ending, by which the format is chosen.
fs::path temporary_name(const fs::path& path) {
  static std::atomic<unsigned> serial = 0;
  const std::string name =
      fmt::format(".{}.tmp-{}-{}{}", path.stem().string(), DMVV_PROCESS_ID(), serial++, path.extension().string());
  return path.parent_path() / name;
}

/// Writes pixels (format `type`) to a temporary name and renames it.
Result<void> write_image(const std::string& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                         const void* pixels) {
  const fs::path temporary = temporary_name(path);
  const auto failed = [&](const std::string& reason) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return fail(Fault::environment, fmt::format("cannot write '{}'", path), {reason});
  };
  try {
    const auto output = OIIO::ImageOutput::create(temporary.string());
    if (!output) return failed(OIIO::geterror());
    if (!output->open(temporary.string(), spec)) return failed(output->geterror());
    if (!output->write_image(type, pixels)) {
      const std::string reason = output->geterror();
      output->close();
      return failed(reason);
    }
    if (!output->close()) return failed(output->geterror());
    std::error_code error;
    fs::rename(temporary, path, error);
    if (error) return failed(error.message());
    return {};
  } catch (const std::exception& error) {
    return failed(error.what());
  }
}

OIIO::ImageSpec make_spec(const Picture& picture, int channels, OIIO::TypeDesc type) {
  OIIO::ImageSpec spec(static_cast<int>(picture.size_px.x), static_cast<int>(picture.size_px.y), channels, type);
  spec.attribute("png:compressionLevel", png_compression_level);
  spec.attribute("DateTime", "1970:01:01 00:00:00");  // the TIFF and EXR writers fill in the present else
  return spec;
}

std::size_t pixel_count(const Picture& picture) { return std::size_t{picture.size_px.x} * picture.size_px.y; }

tl::unexpected<Error> missing(const std::string& path, const char* what) {
  return fail(Fault::environment, fmt::format("cannot write '{}': the picture was rendered without {}", path, what));
}

/// Runs `write` and turns what is thrown (memory) into an error.
Result<void> guarded_write(const std::string& path, const std::function<Result<void>()>& write) {
  try {
    return write();
  } catch (const std::exception& error) {
    return fail(Fault::environment, fmt::format("cannot write '{}'", path), {error.what()});
  }
}

Result<void> write_png(const std::string& path, const Picture& picture) {
  std::vector<std::uint8_t> bytes(picture.rgba.size());
  std::ranges::transform(picture.rgba, bytes.begin(), [](float value) {
    return static_cast<std::uint8_t>(value > 0.0f ? std::min(value, 1.0f) * 255.0f + 0.5f : 0.0f);  // NaN: 0
  });
  OIIO::ImageSpec spec = make_spec(picture, 4, OIIO::TypeUInt8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  return write_image(path, spec, OIIO::TypeUInt8, bytes.data());
}

Result<void> write_tiff(const std::string& path, const Picture& picture) {
  OIIO::ImageSpec spec = make_spec(picture, 4, OIIO::TypeUInt16);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  return write_image(path, spec, OIIO::TypeFloat, picture.rgba.data());
}

Result<void> write_exr(const std::string& path, const Picture& picture) {
  std::vector<float> premultiplied = picture.rgba;
  for (std::size_t i = 0; i < premultiplied.size(); i += 4) {
    for (std::size_t channel = 0; channel < 3; ++channel) premultiplied[i + channel] *= premultiplied[i + 3];
  }
  return write_image(path, make_spec(picture, 4, OIIO::TypeFloat), OIIO::TypeFloat, premultiplied.data());
}

OIIO::ImageSpec single_channel(const Picture& picture, OIIO::TypeDesc type, const char* name) {
  OIIO::ImageSpec spec = make_spec(picture, 1, type);
  spec.channelnames = {name};
  return spec;
}

}  // namespace

Result<void> write_picture(const std::string& path, const Picture& picture) {
  return guarded_write(path, [&]() -> Result<void> {
    if (auto fault = path_fault(path, {".png", ".tif", ".tiff", ".exr"})) return tl::unexpected(std::move(*fault));
    if (picture.rgba.size() != 4 * pixel_count(picture) || picture.rgba.empty()) return missing(path, "pixels");
    const std::string ending = lower_ending(path);
    if (ending == ".png") return write_png(path, picture);
    return ending == ".exr" ? write_exr(path, picture) : write_tiff(path, picture);
  });
}

Result<void> write_regions(const std::string& path, const Picture& picture) {
  return guarded_write(path, [&]() -> Result<void> {
    if (auto fault = path_fault(path, {".exr", ".png", ".tif", ".tiff"})) return tl::unexpected(std::move(*fault));
    if (picture.regions.size() != pixel_count(picture) || picture.regions.empty())
      return missing(path, "region numbers");
    if (lower_ending(path) == ".exr") {
      return write_image(path, single_channel(picture, OIIO::TypeUInt32, "region"), OIIO::TypeUInt32,
                         picture.regions.data());
    }
    const std::uint32_t largest = *std::ranges::max_element(picture.regions);
    if (largest > 65535) {
      return fail(
          Fault::input,
          fmt::format("cannot write '{}': region number {} is beyond 65535, the most of 16 bits", path, largest),
          {"write the region numbers to a file that ends in .exr"});
    }
    const std::vector<std::uint16_t> narrow(picture.regions.begin(), picture.regions.end());
    return write_image(path, single_channel(picture, OIIO::TypeUInt16, "Y"), OIIO::TypeUInt16, narrow.data());
  });
}

Result<void> write_depth(const std::string& path, const Picture& picture) {
  return guarded_write(path, [&]() -> Result<void> {
    if (auto fault = path_fault(path, {".exr"})) return tl::unexpected(std::move(*fault));
    if (picture.depth.size() != pixel_count(picture) || picture.depth.empty()) return missing(path, "depth");
    return write_image(path, single_channel(picture, OIIO::TypeFloat, "Z"), OIIO::TypeFloat, picture.depth.data());
  });
}

}  // namespace dmvv::runtime
