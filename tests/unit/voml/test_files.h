// Files made in memory: what tests of the front end read instead of the disk.
#pragma once

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <string>
#include <vector>

#include "voml/assets/grid.h"

namespace dmvv::tests {

/// A grid of 2^3 values whose zero set is the plane x = 0.
inline voml::Grid plane_grid() {
  voml::Grid grid;
  grid.size = {2, 2, 2};
  grid.values = {-0.5f, 0.5f, -0.5f, 0.5f, -0.5f, 0.5f, -0.5f, 0.5f};
  return grid;
}

inline std::string lxn() { return voml::write_lxn(plane_grid()); }

/// The same with four bytes at `offset` replaced.
template <class T>
std::string lxn_with(std::size_t offset, T value) {
  static_assert(sizeof(T) == 4);
  std::string bytes = lxn();
  const auto* p = reinterpret_cast<const char*>(&value);
  return bytes.replace(offset, 4, p, 4);
}

/// A picture, rows from the top, `channels` bytes a pixel. `format` is a file ending: "png", "tif", ...
inline std::string picture(int width, int height, int channels, const std::vector<std::uint8_t>& pixels,
                           const std::string& format = "png") {
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  auto output = OIIO::ImageOutput::create("a." + format, &memory);
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
  spec["oiio:UnassociatedAlpha"] = 1;
  if (!output || !output->open("a." + format, spec)) return {};
  output->write_image(OIIO::TypeDesc::UINT8, pixels.data());
  output->close();
  return {bytes.begin(), bytes.end()};
}

/// A grey picture of this size.
inline std::string picture(int width, int height) {
  return picture(width, height, 3, std::vector<std::uint8_t>(static_cast<std::size_t>(width * height * 3), 128));
}

}  // namespace dmvv::tests
