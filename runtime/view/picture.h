// A picture, and how it is written to a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "voml/assets/mesh.h"

namespace dmvv::runtime {

struct Picture {
  glm::uvec2 size_px{0};
  std::vector<float> rgba;             ///< Colors::floats: straight alpha, rows from the top, 0..1, sRGB as shown
  std::vector<std::uint8_t> rgba8;     ///< Colors::bytes: the same times 255, rounded to the nearest
  std::vector<std::uint32_t> regions;  ///< if asked for; at sample (0, 0) of each pixel when samples > 1
  std::vector<float>
      depth;  ///< if asked for: distance along the view direction, root units (0 on a slice); infinity where empty
  std::vector<glm::vec3> positions;  ///< if asked for: the point evaluated at sample (0, 0), root coordinates; NaN
                                     ///< where there is no surface
  std::vector<glm::vec3> normals;    ///< if asked for: unit, root frame, towards the viewer, at sample (0, 0); 0 where
                                     ///< there is no surface
  std::vector<std::uint8_t> doubt;  ///< if asked for, of pictures by rays: 1 where something thin may have been missed,
                                    ///< at sample (0, 0)
  std::uint64_t doubtful_rays = 0;
  bool eye_within = false;  ///< of pictures by rays: the eye stands in an opaque region
  voml::EdgeFaults edges;   ///< of the support mesh when cut: caps of a mesh that is not closed may leak
};

/// Is any pixel not wholly transparent?
bool shows_something(const Picture& picture);

/// A channel as PNG stores it: the nearest of 0..255; NaN is 0.
inline std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(value > 0.0f ? (value < 1.0f ? value : 1.0f) * 255.0f + 0.5f : 0.0f);
}

/// Writes a picture: .png (8 bit, straight alpha), and if it has floats .tif/.tiff (16 bit, straight), .exr (float,
/// premultiplied as the format wants). Two writes of the same picture give the same bytes. By way of a temporary name.
/// Errors: input fault for an unknown ending or a folder that does not exist.
Result<void> write_picture(const std::string& path, const Picture& picture);
/// Region numbers: .exr (one uint channel "region"), .png / .tif (16 bit grey; refused if a number exceeds 65,535).
Result<void> write_regions(const std::string& path, const Picture& picture);
/// Depth: .exr, one float channel "Z".
Result<void> write_depth(const std::string& path, const Picture& picture);
/// Normals: .exr (float channels X, Y, Z), .png / .tif (8 bit, 0.5 + 0.5 n; 0 where there is none).
Result<void> write_normals(const std::string& path, const Picture& picture);
/// Where something thin may have been missed: .png / .tif (8 bit grey, 255 there), .exr (one uint channel "doubt", 1
/// there).
Result<void> write_doubt(const std::string& path, const Picture& picture);

}  // namespace dmvv::runtime
