#include "runtime/view/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <new>
#include <optional>

#include "base/text.h"
#include "voml/assets/image_file.h"

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

std::string lower_ending(const fs::path& path) { return lower_case(path.extension().string()); }

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

/// Writes to a temporary name and renames it.
Result<void> write_whole(const std::string& path, const ImageToWrite& image) {
  const fs::path temporary = temporary_name(path);
  std::error_code error;
  if (auto written = write_image(temporary.string(), image); !written) {
    fs::remove(temporary, error);
    return fail(Fault::environment, fmt::format("cannot write '{}'", path), std::move(written.error().reasons));
  }
  fs::rename(temporary, path, error);
  if (!error) return {};
  const std::string why = error.message();
  fs::remove(temporary, error);
  return fail(Fault::environment, fmt::format("cannot write '{}'", path), {why});
}

ImageToWrite to_write(const Picture& picture, std::vector<std::string> channels, SampleType stored, SampleType given,
                      const void* samples) {
  return {.width = picture.size_px.x,
          .height = picture.size_px.y,
          .channels = std::move(channels),
          .stored = stored,
          .given = given,
          .compression = {},
          .samples = samples};
}

const std::vector<std::string> rgba_channels{"R", "G", "B", "A"};

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
  if (!picture.rgba8.empty()) {
    return write_whole(path, to_write(picture, rgba_channels, SampleType::u8, SampleType::u8, picture.rgba8.data()));
  }
  std::vector<std::uint8_t> bytes(picture.rgba.size());
  std::ranges::transform(picture.rgba, bytes.begin(), to_byte);
  return write_whole(path, to_write(picture, rgba_channels, SampleType::u8, SampleType::u8, bytes.data()));
}

Result<void> write_tiff(const std::string& path, const Picture& picture) {
  return write_whole(path, to_write(picture, rgba_channels, SampleType::u16, SampleType::f32, picture.rgba.data()));
}

Result<void> write_exr(const std::string& path, const Picture& picture) {
  std::vector<float> premultiplied = picture.rgba;
  for (std::size_t i = 0; i < premultiplied.size(); i += 4) {
    for (std::size_t channel = 0; channel < 3; ++channel) premultiplied[i + channel] *= premultiplied[i + 3];
  }
  ImageToWrite image = to_write(picture, rgba_channels, SampleType::f32, SampleType::f32, premultiplied.data());
  image.straight_alpha = false;
  return write_whole(path, image);
}

/// One channel, stored as given.
Result<void> write_channel(const std::string& path, const Picture& picture, const char* name, SampleType type,
                           const void* samples) {
  return write_whole(path, to_write(picture, {name}, type, type, samples));
}

}  // namespace

bool shows_something(const Picture& picture) {
  for (std::size_t alpha = 3; alpha < picture.rgba.size(); alpha += 4) {
    if (picture.rgba[alpha] != 0.0f) return true;
  }
  for (std::size_t alpha = 3; alpha < picture.rgba8.size(); alpha += 4) {
    if (picture.rgba8[alpha] != 0) return true;
  }
  return false;
}

Result<void> write_picture(const std::string& path, const Picture& picture) {
  return guarded_write(path, [&]() -> Result<void> {
    if (auto fault = path_fault(path, {".png", ".tif", ".tiff", ".exr"})) return tl::unexpected(std::move(*fault));
    const std::string ending = lower_ending(path);
    const bool has_bytes = ending == ".png" && !picture.rgba8.empty();
    const std::size_t samples = has_bytes ? picture.rgba8.size() : picture.rgba.size();
    if (samples != 4 * pixel_count(picture) || samples == 0) return missing(path, "pixels");
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
      return write_channel(path, picture, "region", SampleType::u32, picture.regions.data());
    }
    const std::uint32_t largest = *std::ranges::max_element(picture.regions);
    if (largest > 65535) {
      return fail(
          Fault::input,
          fmt::format("cannot write '{}': region number {} is beyond 65535, the most of 16 bits", path, largest),
          {"write the region numbers to a file that ends in .exr"});
    }
    const std::vector<std::uint16_t> narrow(picture.regions.begin(), picture.regions.end());
    return write_channel(path, picture, "Y", SampleType::u16, narrow.data());
  });
}

Result<void> write_normals(const std::string& path, const Picture& picture) {
  return guarded_write(path, [&]() -> Result<void> {
    if (auto fault = path_fault(path, {".exr", ".png", ".tif", ".tiff"})) return tl::unexpected(std::move(*fault));
    if (picture.normals.size() != pixel_count(picture) || picture.normals.empty()) return missing(path, "normals");
    if (lower_ending(path) == ".exr") {
      return write_whole(path,
                         to_write(picture, {"X", "Y", "Z"}, SampleType::f32, SampleType::f32, picture.normals.data()));
    }
    std::vector<std::uint8_t> bytes;
    for (const glm::vec3& normal : picture.normals) {
      const bool is_there = normal != glm::vec3(0.0f);
      for (int axis = 0; axis < 3; ++axis) bytes.push_back(is_there ? to_byte(0.5f + 0.5f * normal[axis]) : 0);
    }
    return write_whole(path, to_write(picture, {"R", "G", "B"}, SampleType::u8, SampleType::u8, bytes.data()));
  });
}

Result<void> write_doubt(const std::string& path, const Picture& picture) {
  return guarded_write(path, [&]() -> Result<void> {
    if (auto fault = path_fault(path, {".exr", ".png", ".tif", ".tiff"})) return tl::unexpected(std::move(*fault));
    if (picture.doubt.size() != pixel_count(picture) || picture.doubt.empty()) return missing(path, "doubt");
    if (lower_ending(path) == ".exr") {
      const std::vector<std::uint32_t> wide(picture.doubt.begin(), picture.doubt.end());
      return write_channel(path, picture, "doubt", SampleType::u32, wide.data());
    }
    std::vector<std::uint8_t> grey(picture.doubt);
    for (std::uint8_t& value : grey) value = value != 0 ? 255 : 0;
    return write_channel(path, picture, "Y", SampleType::u8, grey.data());
  });
}

Result<void> write_depth(const std::string& path, const Picture& picture) {
  return guarded_write(path, [&]() -> Result<void> {
    if (auto fault = path_fault(path, {".exr"})) return tl::unexpected(std::move(*fault));
    if (picture.depth.size() != pixel_count(picture) || picture.depth.empty()) return missing(path, "depth");
    return write_channel(path, picture, "Z", SampleType::f32, picture.depth.data());
  });
}

}  // namespace dmvv::runtime
