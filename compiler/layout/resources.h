// What a scene is on a device: the buffers and textures of descriptor set 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "compiler/grids/storage.h"
#include "compiler/layout/scene_buffers.h"

namespace dmvv::compiler {

/// A buffer of descriptor set 0.
struct Buffer {
  std::string name;
  std::uint32_t binding;
  std::vector<std::byte> bytes;  ///< never empty: one record of zeros where there is none
  std::size_t count = 0;         ///< records
  BufferForm form = BufferForm::records;
};

/// A 3D texture of descriptor set 0 (combined image sampler, linear, clamped to the edge, no mipmaps).
struct Texture {
  std::string name;
  std::uint32_t binding;
  glm::uvec3 extent;
  TexelFormat format;
  bool filtered = true;           ///< false: the shader fetches texels, the device need not filter the format
  std::vector<std::byte> texels;  ///< x fastest; extent.x * extent.y * extent.z * bytes_per_texel
};

}  // namespace dmvv::compiler
