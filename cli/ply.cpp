#include "cli/ply.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>

namespace dmvv::cli {
namespace {

void append_u32(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift & 0xff));
}

}  // namespace

std::string write_ply(const voml::Mesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.positions.size(), mesh.triangles.size());
  bytes.reserve(bytes.size() + mesh.positions.size() * 12 + mesh.triangles.size() * 13);
  for (const glm::dvec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) append_u32(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(p[axis])));
  }
  for (const glm::uvec3& triangle : mesh.triangles) {
    bytes.push_back(3);
    for (int corner = 0; corner < 3; ++corner) append_u32(bytes, triangle[corner]);
  }
  return bytes;
}

}  // namespace dmvv::cli
